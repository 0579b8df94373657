// The Python module snowbough_testing: native functions that only tests and benchmarks need.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cstdint>
#include <cstring>
#include <glm/vec3.hpp>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "gpu/shader_source.h"
#include "python/numpy_arrays.h"
#include "python/released_gil.h"
#include "python/snow/map_topology.h"
#include "snow/output/cpu_filter.h"
#include "snow/seams/seam_table.h"
#include "snow/texels/texel_table.h"
#include "support/chart_measure.h"
#include "tree/crossings/whole.h"
#include "tree/mesh/mesh_check.h"

namespace py = pybind11;

namespace snowbough::python {
namespace {

using tree::UvLayoutMeasure;
using tree::UvSurface;

py::dict measure_uv_layout(const InputArray<float>& uv, const InputArray<float>& vertices,
                           const InputArray<int32_t>& faces, int resolution) {
  if (faces.ndim() != 2 || (faces.shape(1) != 3 && faces.shape(1) != 4)) {
    throw std::invalid_argument("faces must have shape (F, 3) or (F, 4)");
  }
  if (uv.ndim() != 3 || uv.shape(0) != faces.shape(0) || uv.shape(1) != faces.shape(1) ||
      uv.shape(2) != 2) {
    throw std::invalid_argument("uv must have shape (F, 3, 2) or (F, 4, 2), as faces");
  }
  require_finite(uv, "uv");
  UvSurface surface;
  surface.sides = static_cast<int>(faces.shape(1));
  surface.vertices = rows_from_numpy<glm::vec3, float, 3>(vertices, "vertices");
  surface.corner_vertex.assign(faces.data(), faces.data() + faces.size());
  surface.corner_uv.resize(surface.corner_vertex.size());
  if (!surface.corner_uv.empty()) {
    std::memcpy(surface.corner_uv.data(), uv.data(), surface.corner_uv.size() * sizeof(glm::vec2));
  }
  UvLayoutMeasure measure;
  {
    const ReleasedGil release;
    measure = tree::measure_uv_layout(surface, resolution);
  }
  py::dict result;
  result["chart_count"] = measure.chart_count;
  result["fill"] = measure.fill;
  result["overlap_texels"] = measure.overlap_texels;
  result["narrow_gutter_texels"] = measure.narrow_gutter_texels;
  result["narrow_wide_gutter_texels"] = measure.narrow_wide_gutter_texels;
  result["outside_faces"] = measure.outside_faces;
  result["min_face_area"] = measure.min_face_area;
  result["min_chart_extent"] = measure.min_chart_extent;
  result["min_chart_mean_width"] = measure.min_chart_mean_width;
  result["density_p5"] = measure.density_p5;
  result["density_p50"] = measure.density_p50;
  result["density_p95"] = measure.density_p95;
  return result;
}

py::tuple output_map(const InputArray<int32_t>& triangles, const InputArray<float>& uv,
                     const InputArray<float>& positions, const InputArray<float>& height,
                     float blur_radius) {
  const auto resolution = static_cast<int32_t>(height.shape(0));
  snow::MapTopology topology = map_topology(triangles, uv, resolution);
  const auto points = rows_from_numpy<glm::vec3, float, 3>(positions, "positions");
  topology.vertex_count = static_cast<int32_t>(points.size());
  const snow::TexelTable table = snow::build_texel_table(topology);
  const snow::SeamTable seams = snow::build_seam_table(topology, table, points);
  // Clears texels outside the surface.
  std::vector<float> owned(static_cast<size_t>(height.size()), 0.0f);
  for (const int32_t texel : table.texel) owned[texel] = height.data()[texel];
  snow::MapOutput output =
      snow::CpuFilter(table, seams, {blur_radius})
          .run(std::move(owned),
               {.metrics = snow::surface_metrics(topology, points), .maps = {.normal = true}});
  std::vector<float> normal(3 * output.normal.size());
  std::memcpy(normal.data(), output.normal.data(), normal.size() * sizeof(float));
  return py::make_tuple(to_numpy<float>(std::move(output.height), {resolution, resolution}),
                        to_numpy<float>(std::move(normal), {resolution, resolution, 3}));
}

}  // namespace

PYBIND11_MODULE(snowbough_testing, module) {
  module.def("output_map", &output_map, py::arg("triangles"), py::arg("uv"), py::arg("positions"),
             py::arg("height"), py::arg("blur_radius") = 0.0f,
             "(height, normal): the output of a stored map (resolution, resolution) in metres.");
  module.def(
      "shader_source", &gpu::shader_source, py::arg("name"),
      py::arg("defines") = std::vector<std::string>{},
      "A shader's source for the GL compiler, with its #version, defines and includes inserted.");
  module.def(
      "crossing_quads",
      [](const InputArray<float>& vertices, const InputArray<int32_t>& quads) {
        const auto points = rows_from_numpy<glm::vec3, float, 3>(vertices, "vertices");
        const std::vector<glm::dvec3> places(points.begin(), points.end());
        const auto faces = rows_from_numpy<tree::Quad, int32_t, 4>(quads, "quads");
        tree::require_corners(faces, points.size());
        std::vector<int32_t> pairs;
        {
          ReleasedGil release;
          std::vector<int32_t> all(faces.size());
          std::iota(all.begin(), all.end(), 0);
          for (const auto& [f, g] : tree::crossing_quads(places, faces, all)) {
            pairs.push_back(f);
            pairs.push_back(g);
          }
        }
        const auto count = static_cast<py::ssize_t>(pairs.size() / 2);
        return to_numpy<int32_t>(std::move(pairs), {count, 2});
      },
      py::arg("vertices"), py::arg("quads"),
      "(K, 2) the pairs of intersecting quads. Exact; for measurements, not fast.");
  module.def(
      "measure_uv_layout", &measure_uv_layout, py::arg("uv"), py::arg("vertices"), py::arg("faces"),
      py::arg("resolution"),
      R"(Quality of a unique UV layout on a map of `resolution` squared texels, by exact clipping
of every face against every texel.

uv (F, N, 2), vertices (V, 3) in metres, faces (F, N), N = 3 or 4. Returns a dict: chart_count,
fill (covered fraction of the map), overlap_texels (touched by two charts or covered twice),
narrow_gutter_texels (another chart in the next texel), narrow_wide_gutter_texels (of charts wider
than four texels: another within two), outside_faces, min_face_area (texels, signed),
min_chart_extent, min_chart_mean_width (texels), density_p5, density_p50, density_p95 (texels per
m2, weighted by area).)");
}

}  // namespace snowbough::python
