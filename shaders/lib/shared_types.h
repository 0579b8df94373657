#pragma once

// Makes a header compile as C++ and GLSL: the vector types get the same names in both. Structs in
// std430 storage blocks match C++ if they have only scalars, vec2 and vec4 members that fill whole
// 16-byte rows (never a bare vec3); their sizes are asserted beside them.
#ifdef SNOWBOUGH_GLSL
#define SNOWBOUGH_SHARED_SIZE(type, bytes)
/// A struct that fills whole rows of 16 bytes, however many members it has.
#define SNOWBOUGH_SHARED_ROWS
#else
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
namespace snowbough::shared {
using uint = uint32_t;
using glm::ivec2;
using glm::ivec4;
using glm::uvec2;
using glm::uvec4;
using glm::vec2;
using glm::vec4;
}  // namespace snowbough::shared
#define SNOWBOUGH_SHARED_SIZE(type, bytes) static_assert(sizeof(type) == (bytes));
#define SNOWBOUGH_SHARED_ROWS alignas(16)
#endif
