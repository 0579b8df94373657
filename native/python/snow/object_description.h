#pragma once

#include <optional>
#include <string>

#include "python/numpy_arrays.h"
#include "snow/scene/scene_object.h"

namespace snowbough::python {

/// Converts the arguments of SnowSimulation.add_object and replace_object; see its docstring. Needs
/// the GIL.
/// @throws std::invalid_argument naming the object and the wrong value.
snow::ObjectDescription describe_object(const std::string& name,
                                        const InputArray<int32_t>& triangles,
                                        const InputArray<float>& uv, int32_t resolution,
                                        bool receive, bool occlude, const pybind11::object& rest,
                                        const std::optional<double>& blur_radius,
                                        const pybind11::object& alpha,
                                        const pybind11::object& shading, const std::string& sides);

}  // namespace snowbough::python
