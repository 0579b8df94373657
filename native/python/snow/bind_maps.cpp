#include "map_topology.h"
#include "output_maps.h"
#include "python/bindings.h"
#include "python/numpy_arrays.h"
#include "snow/output/cpu_filter.h"
#include "snow/seams/seam_table.h"
#include "snow/texels/texel_table.h"

namespace py = pybind11;

namespace snowbough::python {
namespace {

py::dict texel_table(const InputArray<int32_t>& triangles, const InputArray<float>& uv,
                     int32_t resolution) {
  const snow::MapTopology topology = map_topology(triangles, uv, resolution);
  snow::TexelTable table;
  {
    ReleasedGil unlocked;
    table = snow::build_texel_table(topology);
  }
  const auto texels = static_cast<py::ssize_t>(table.texel.size());
  const auto fragments = static_cast<py::ssize_t>(table.fragment_triangle.size());
  py::dict result;
  result["texel"] = to_numpy<int32_t>(std::move(table.texel), {texels});
  result["triangle"] = to_numpy<int32_t>(std::move(table.triangle), {texels});
  result["barycentric"] = to_numpy<float>(std::move(table.barycentric), {texels, 2});
  result["chart"] = to_numpy<int32_t>(std::move(table.chart), {texels});
  result["coverage"] = to_numpy<float>(std::move(table.coverage), {texels});
  result["fragment_begin"] = to_numpy<int32_t>(std::move(table.fragment_begin), {texels + 1});
  result["fragment_triangle"] = to_numpy<int32_t>(std::move(table.fragment_triangle), {fragments});
  result["fragment_share"] = to_numpy<float>(std::move(table.fragment_share), {fragments});
  result["fragment_barycentric"] =
      to_numpy<float>(std::move(table.fragment_barycentric), {fragments, 2});
  result["chart_count"] = table.chart_count;
  result["degenerate_triangles"] = table.degenerate_triangles;
  result["unmapped_charts"] = table.unmapped_charts;
  result["overlap"] = table.overlap;
  return result;
}

py::dict output_map(const InputArray<int32_t>& triangles, const InputArray<float>& uv,
                    const InputArray<float>& positions, const InputArray<float>& height,
                    float blur_radius) {
  if (height.ndim() != 2 || height.shape(0) != height.shape(1)) {
    throw std::invalid_argument("height must have shape (resolution, resolution)");
  }
  require_finite(height, "height");
  if (!std::isfinite(blur_radius) || blur_radius < 0.0f) {
    throw std::invalid_argument("blur_radius must be 0 metres or more");
  }
  const auto resolution = static_cast<int32_t>(height.shape(0));
  snow::MapTopology topology = map_topology(triangles, uv, resolution);
  const auto points = rows_from_numpy<glm::vec3, float, 3>(positions, "positions");
  topology.vertex_count = static_cast<int32_t>(points.size());
  std::vector<float> stored(height.data(), height.data() + height.size());
  const snow::MapRequest maps = map_request();
  snow::MapOutput output;
  {
    ReleasedGil unlocked;
    const snow::TexelTable table = snow::build_texel_table(topology);
    const snow::SeamTable seams = snow::build_seam_table(topology, table, points);
    // Clears texels outside the surface.
    std::vector<float> owned(stored.size(), 0.0f);
    for (const int32_t texel : table.texel) owned[texel] = stored[texel];
    output = snow::CpuFilter(table, seams, {blur_radius})
                 .run(std::move(owned),
                      {.metrics = snow::surface_metrics(topology, points), .maps = maps});
  }
  py::dict result;
  result["height"] = to_numpy<float>(std::move(output.height), {resolution, resolution});
  put_maps(result, output, resolution);
  return result;
}

}  // namespace

void bind_maps(py::module_& module) {
  module.def(
      "texel_table", &texel_table, py::arg("triangles"), py::arg("uv"), py::arg("resolution"),
      R"(The surface that each texel of a snow map carries: triangles (T, 3), uv (T, 3, 2) -> a
dict of the arrays of native/snow/texels/texel_table.h. Raises ValueError for an invalid layout.)");
  module.def(
      "output_map", &output_map, py::arg("triangles"), py::arg("uv"), py::arg("positions"),
      py::arg("height"), py::arg("blur_radius") = 0.0f,
      R"(The output of a stored map (resolution, resolution) in metres: smoothed over the surface
and across seams with a standard deviation of blur_radius metres, extended by four texels, level at
the seams -> as SnowSimulation.output.)");
}

}  // namespace snowbough::python
