#pragma once

#include <pybind11/pybind11.h>

#include "python/bindings.h"
#include "render/renderer.h"

namespace snowbough::python {

/// The class to which the parts below add their functions.
using RendererClass = pybind11::class_<render::Renderer, HeldWithoutGil<render::Renderer>>;

/// Camera, Snowfall, RenderSettings.
void bind_render_options(pybind11::module_& module);
/// Trees: tree_arrays, Renderer.add_tree and their information.
void bind_render_trees(pybind11::module_& module, RendererClass& to);
/// Renderer.add_snow_mesh, set_snow, take_snow and their like.
void bind_render_snow(RendererClass& to);

}  // namespace snowbough::python
