#pragma once

// Makes functions compile as C++ and GLSL: GLSL's functions under the same names, and `inline`. Such a function has
// plain inputs (KERNEL_CONST_REF for structs), writes float literals with f, and builds short vectors from long ones by
// constructors instead of swizzles.
#include "kernel.h"
#include "shared_types.h"

#ifdef SNOWBOUGH_GLSL
#define SNOWBOUGH_SHARED_FUNCTION
#else
#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vector_relational.hpp>
#define SNOWBOUGH_SHARED_FUNCTION inline
namespace snowbough::shared {
using glm::abs;
using glm::acos;
using glm::clamp;
using glm::cross;
using glm::dot;
using glm::floor;
using glm::length;
using glm::max;
using glm::min;
using glm::pow;
using glm::sqrt;
using glm::tan;
using glm::vec3;
}  // namespace snowbough::shared
#endif
