#pragma once

#include <cstdint>
#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <glm/vector_relational.hpp>
#include <vector>

#include "base/simd.h"
#include "shaders/lib/facing.h"
#include "shaders/lib/kernel.h"
#include "shaders/lib/snow_shared.h"

// Support for including a part of a shader as the members of a C++ class, so that a pass's
// arithmetic is written once for both engines. One such class per source file, since the parts are
// included once. Uses glm's names: for .cpp files only.

/// Marks an inner loop; everything that it calls is inlined.
#define SNOWBOUGH_KERNEL SNOWBOUGH_WIDE_FLAT

namespace snowbough::shared {

/// Elements of views with one component.
struct Word {
  uint x;
};
struct Number {
  float x;
};

}  // namespace snowbough::shared

namespace snowbough::snow::kernel {

using namespace glm;     // NOLINT(google-build-using-namespace): the shaders' names
using namespace shared;  // NOLINT(google-build-using-namespace)

// Component by component: glm's vectors are unions, which the compiler copies through memory.
inline Word texelFetch(const Word* view, int index) {
  return {view[index].x};
}
inline Number texelFetch(const Number* view, int index) {
  return {view[index].x};
}
inline uvec2 texelFetch(const uvec2* view, int index) {
  return {view[index].x, view[index].y};
}
inline uvec4 texelFetch(const uvec4* view, int index) {
  return {view[index].x, view[index].y, view[index].z, view[index].w};
}
inline vec3 texelFetch(const vec3* view, int index) {
  return {view[index].x, view[index].y, view[index].z};
}
inline vec4 texelFetch(const vec4* view, int index) {
  return {view[index].x, view[index].y, view[index].z, view[index].w};
}

/// Arrays as views of a kernel.
inline const Word* words(const std::vector<uint32_t>& values) {
  static_assert(sizeof(Word) == sizeof(uint32_t));
  return reinterpret_cast<const Word*>(values.data());
}
inline const Number* numbers(const std::vector<float>& values) {
  static_assert(sizeof(Number) == sizeof(float));
  return reinterpret_cast<const Number*>(values.data());
}
template <typename Row, typename Element>
const Row* rows(const std::vector<Element>& values) {
  static_assert(sizeof(Element) % sizeof(Row) == 0);
  return reinterpret_cast<const Row*>(values.data());
}
template <typename Row, typename Element>
Row* rows(std::vector<Element>& values) {
  static_assert(sizeof(Element) % sizeof(Row) == 0);
  return reinterpret_cast<Row*>(values.data());
}

}  // namespace snowbough::snow::kernel
