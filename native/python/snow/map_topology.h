#pragma once

#include <string>

#include "python/numpy_arrays.h"
#include "snow/texels/texel_table.h"

namespace snowbough::python {

/// A map's layout from triangles (T, 3), vertex indices, and uv (T, 3, 2). The vertex count is the
/// highest index + 1. Errors begin with `who`. @throws std::invalid_argument for other shapes.
snow::MapTopology map_topology(const InputArray<int32_t>& triangles, const InputArray<float>& uv,
                               int32_t resolution, const std::string& who = "");

}  // namespace snowbough::python
