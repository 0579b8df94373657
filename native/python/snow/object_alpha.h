#pragma once

#include <pybind11/pybind11.h>

#include <string>

#include "snow/scene/alpha_mask.h"

namespace snowbough::python {

/// Converts the `alpha` dict of add_object, for a mesh of `triangles` triangles. Needs the GIL.
/// @throws std::invalid_argument naming the object and the wrong value.
snow::ObjectAlpha alpha_from_python(const pybind11::object& given, const std::string& name,
                                    pybind11::ssize_t triangles);

}  // namespace snowbough::python
