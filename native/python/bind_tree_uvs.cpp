#include <pybind11/stl.h>

#include <utility>

#include "bindings.h"
#include "numpy_arrays.h"
#include "python_progress.h"
#include "tree/leaves/leaf_uvs.h"
#include "tree/skeleton/skeleton.h"

namespace py = pybind11;

namespace snowbough::python {
namespace {

using tree::LeafUvs;
using tree::Skeleton;

py::dict layout_leaf_uvs(const Skeleton& skeleton, int resolution, const py::object& progress) {
  LeafUvs layout = run_cancellable(progress, [&](const base::Progress& asked) {
    return tree::layout_leaf_uvs(skeleton.foliage, resolution, {0, asked});
  });
  const auto corners = static_cast<py::ssize_t>(layout.corner_uv.size());
  return py::dict(py::arg("uv") = to_numpy<float>(std::move(layout.corner_uv), {corners, 2}),
                  py::arg("resolution") = layout.resolution,
                  py::arg("chart_count") = layout.chart_count, py::arg("scale") = layout.scale);
}

}  // namespace

void bind_tree_uvs(py::module_& module) {
  module.def(
      "layout_leaf_uvs", &layout_leaf_uvs, py::arg("skeleton"), py::arg("resolution"),
      py::arg("progress") = py::none(),
      R"(The foliage's `snow` UV map, without overlap, as a dict: uv (C, 2) float32, one coordinate per
corner of skeleton.foliage.corner_vertex; resolution of the layout (if the leaves do not fit the
requested one, the smallest power of two at which they do); chart_count; scale in texels per metre.

progress(share) is called regularly; returning False (not None) cancels with KeyboardInterrupt.)");
}

}  // namespace snowbough::python
