#include <pybind11/stl.h>

#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <utility>

#include "bindings.h"
#include "numpy_arrays.h"
#include "python_progress.h"
#include "tree/leaves/leaf_uvs.h"
#include "tree/skeleton/skeleton.h"
#include "tree/uv/chart_measure.h"

namespace py = pybind11;

namespace snowbough::python {
namespace {

using tree::LeafUvs;
using tree::Skeleton;
using tree::UvLayoutMeasure;
using tree::UvSurface;

LeafUvs compute_leaf_uvs(const Skeleton& skeleton, int resolution, const py::object& progress) {
  return run_cancellable(progress, [&](const base::Progress& asked) {
    return tree::layout_leaf_uvs(skeleton.foliage, resolution, {0, asked});
  });
}

py::array_t<float> uv_array(LeafUvs& layout) {
  const auto corners = static_cast<py::ssize_t>(layout.corner_uv.size());
  return to_numpy<float>(std::move(layout.corner_uv), {corners, 2});
}

py::array_t<float> leaf_uvs(const Skeleton& skeleton, int resolution) {
  LeafUvs layout = compute_leaf_uvs(skeleton, resolution, py::none());
  if (!layout.fits(resolution)) {
    const std::string message =
        "the foliage's " + std::to_string(layout.chart_count) + " leaf charts need a snow map of " +
        std::to_string(layout.resolution) + " texels, not " + std::to_string(resolution);
    if (PyErr_WarnEx(PyExc_UserWarning, message.c_str(), 1) < 0) throw py::error_already_set();
  }
  return uv_array(layout);
}

py::dict layout_leaf_uvs(const Skeleton& skeleton, int resolution, const py::object& progress) {
  LeafUvs layout = compute_leaf_uvs(skeleton, resolution, progress);
  return py::dict(py::arg("uv") = uv_array(layout), py::arg("resolution") = layout.resolution,
                  py::arg("chart_count") = layout.chart_count, py::arg("scale") = layout.scale);
}

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

}  // namespace

void bind_tree_uvs(py::module_& module) {
  module.def("leaf_uvs", &leaf_uvs, py::arg("skeleton"), py::arg("resolution"),
             R"((C, 2) float32: the foliage's `snow` UV map, one coordinate per corner of
skeleton.foliage.corner_vertex, without overlap.

If the leaves do not fit a map of `resolution` squared texels, the layout is made for the smallest
power of two at which they do, and a UserWarning names it.)");
  module.def(
      "layout_leaf_uvs", &layout_leaf_uvs, py::arg("skeleton"), py::arg("resolution"),
      py::arg("progress") = py::none(),
      R"(As leaf_uvs, as a dict: uv (C, 2); resolution of the layout (larger than requested if the
leaves do not fit); chart_count; scale in texels per metre. Raises no warning.

progress(share) is called regularly; returning False (not None) cancels with KeyboardInterrupt.)");
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
