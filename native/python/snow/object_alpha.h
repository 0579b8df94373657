#pragma once

#include <pybind11/pybind11.h>

#include <string>

#include "snow/scene/alpha_mask.h"

namespace snowbough::python {

/// The dict that add_object takes as `alpha`, for a mesh of `triangles` triangles. The GIL is held.
/// @throws std::invalid_argument naming the object and what does not fit.
snow::ObjectAlpha alpha_from_python(const pybind11::object& given, const std::string& name,
                                    pybind11::ssize_t triangles);

}  // namespace snowbough::python
