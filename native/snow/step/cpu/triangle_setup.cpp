#include "shaders/lib/triangle_setup.h"

#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <string>

#include "base/parallel_for.h"
#include "snow/step/cpu/kernel.h"
#include "snow/step/cpu/passes.h"

namespace snowbough::snow::cpu {
namespace {

/// Triangles that a thread takes at a time.
constexpr size_t kRun = 1024;

SNOWBOUGH_KERNEL void set_up_run(const glm::vec3* positions, const shared::SceneTriangle* triangles,
                                 const shared::ProjectionFrame& frame, size_t count,
                                 glm::vec4* corners, glm::vec4* surface) {
  for (size_t i = 0; i < count; ++i) {
    const shared::SceneTriangle& triangle = triangles[i];
    const shared::TriangleSetup setup = shared::set_up_triangle(
        positions[triangle.a], positions[triangle.b], positions[triangle.c], frame);
    corners[3 * i] = setup.corner_a;
    corners[3 * i + 1] = setup.corner_b;
    corners[3 * i + 2] = setup.corner_c;
    surface[i] = setup.surface;
  }
}

}  // namespace

void set_up_triangles(std::span<const glm::vec3> positions,
                      std::span<const shared::SceneTriangle> triangles,
                      const shared::ProjectionFrame& frame, std::span<glm::vec4> corners,
                      std::span<glm::vec4> surface) {
  if (corners.size() != 3 * triangles.size() || surface.size() != triangles.size()) {
    throw std::invalid_argument("set_up_triangles: room for " + std::to_string(corners.size()) +
                                " corners and " + std::to_string(surface.size()) +
                                " surfaces, there are " + std::to_string(triangles.size()) +
                                " triangles: give three corners and one surface a triangle");
  }
  const size_t runs = (triangles.size() + kRun - 1) / kRun;
  base::for_each_item(runs, 1, [&](size_t run) {
    const size_t first = run * kRun;
    const size_t count = std::min(kRun, triangles.size() - first);
    set_up_run(positions.data(), triangles.data() + first, frame, count, corners.data() + 3 * first,
               surface.data() + first);
  });
}

}  // namespace snowbough::snow::cpu
