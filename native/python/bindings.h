#pragma once

#include <pybind11/pybind11.h>

#include <memory>

#include "base/process.h"
#include "python/released_gil.h"

namespace snowbough::python {

/// Deletes an object whose destructor waits for the GPU thread, without the GIL. In a forked
/// process the object leaks, since the thread does not exist there.
struct ReleaseGil {
  base::ProcessMark made_in;

  template <typename Owner>
  void operator()(Owner* owner) const {
    if (!made_in.is_here()) return;
    const ReleasedGil release;
    delete owner;
  }
};
/// Owner of such an object, for Python classes.
template <typename Owner>
using HeldWithoutGil = std::unique_ptr<Owner, ReleaseGil>;

/// Calls `work` without the GIL and returns its result; `work` must not use Python objects.
template <typename Work>
auto without_gil(Work&& work) {
  const ReleasedGil release;
  return work();
}

/// read_tree, Skeleton.
void bind_skeleton(pybind11::module_& module);
/// build_tree_mesh, TreeMesh.
void bind_tree(pybind11::module_& module);
/// layout_leaf_uvs.
void bind_tree_uvs(pybind11::module_& module);
/// kept_weights, layout_kept_uvs.
void bind_kept(pybind11::module_& module);
/// Engine.
void bind_engine(pybind11::module_& module);
/// SnowSimulation.
void bind_snow(pybind11::module_& module);
/// simulation_state, set_simulation_state: checkpoints as plain arrays.
void bind_snow_state(pybind11::module_& module);
/// SnowSurface.
void bind_surface(pybind11::module_& module);
/// Renderer, Camera, RenderSettings.
void bind_render(pybind11::module_& module);
/// read_exr, write_exr, encode_png, write_png.
void bind_image(pybind11::module_& module);
/// texel_table.
void bind_maps(pybind11::module_& module);

}  // namespace snowbough::python
