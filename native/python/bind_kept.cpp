#include <optional>
#include <utility>
#include <vector>

#include "bindings.h"
#include "bound_mesh.h"
#include "numpy_arrays.h"
#include "python_progress.h"
#include "released_gil.h"
#include "tree/kept/kept_uvs.h"
#include "tree/kept/kept_weights.h"
#include "tree/mesh/bones_reduce.h"

namespace py = pybind11;

namespace snowbough::python {
namespace {

using tree::KeptUvs;
using tree::Skeleton;
using tree::VertexWeights;

py::tuple kept_weights(const Skeleton& skeleton, const BoundMesh& mesh, const BoundMesh* reduced,
                       int max_influences) {
  if (max_influences < 1 || max_influences > 4) {
    throw std::invalid_argument("max_influences must be from 1 to 4");
  }
  VertexWeights found = without_gil([&] {
    VertexWeights weights = tree::kept_weights(skeleton, mesh.mesh.bones, max_influences);
    if (reduced != nullptr && !reduced->bone_map.empty()) {
      tree::remap_weights(reduced->bone_map, weights.indices, weights.weights);
    }
    return weights;
  });
  const auto count = static_cast<py::ssize_t>(found.indices.size());
  return py::make_tuple(to_numpy<int32_t>(std::move(found.indices), {count, 4}),
                        to_numpy<float>(std::move(found.weights), {count, 4}));
}

py::dict layout_kept_uvs(const Skeleton& skeleton, int resolution, const py::object& progress) {
  KeptUvs layout = run_cancellable(progress, [&](const base::Progress& asked) {
    return tree::layout_kept_uvs(skeleton, resolution, {0, asked});
  });
  const auto corners = static_cast<py::ssize_t>(layout.snow.size());
  return py::dict(py::arg("snow") = to_numpy<float>(std::move(layout.snow), {corners, 2}),
                  py::arg("bark") = to_numpy<float>(std::move(layout.bark), {corners, 2}),
                  py::arg("resolution") = layout.resolution,
                  py::arg("chart_count") = layout.chart_count);
}

}  // namespace

void bind_kept(py::module_& module) {
  module.def(
      "kept_weights", &kept_weights, py::arg("skeleton"), py::arg("mesh"),
      py::arg("reduced") = py::none(), py::arg("max_influences") = 4,
      R"((bones (V, 4) int32, weights (V, 4) float32) of skeleton.kept. mesh: built from the skeleton,
with all bones; reduced: from reduce_bones of it, for indices of its bones.)");
  module.def(
      "layout_kept_uvs", &layout_kept_uvs, py::arg("skeleton"), py::arg("resolution"),
      py::arg("progress") = py::none(),
      R"(UV maps of skeleton.kept as a dict: snow and bark (C, 2) float32, one coordinate per corner of
skeleton.kept.corner_vertex (snow without overlap, bark once around each limb); resolution of the
layout (if it does not fit the requested one, the smallest power of two at which it does);
chart_count.

progress(share) is called regularly; returning False (not None) cancels with KeyboardInterrupt.)");
}

}  // namespace snowbough::python
