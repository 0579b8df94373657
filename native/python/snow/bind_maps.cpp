#include "map_topology.h"
#include "python/bindings.h"
#include "python/numpy_arrays.h"
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

}  // namespace

void bind_maps(py::module_& module) {
  module.def(
      "texel_table", &texel_table, py::arg("triangles"), py::arg("uv"), py::arg("resolution"),
      R"(The surface that each texel of a snow map carries: triangles (T, 3), uv (T, 3, 2) -> a
dict of the arrays of native/snow/texels/texel_table.h. Raises ValueError for an invalid layout.)");
}

}  // namespace snowbough::python
