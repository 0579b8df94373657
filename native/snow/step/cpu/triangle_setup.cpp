#include "shaders/lib/triangle_setup.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "base/parallel_for.h"
#include "snow/step/cpu/kernel.h"
#include "snow/step/cpu/passes.h"

namespace snowbough::snow {
namespace kernel {
namespace {

struct Smooth {
#include "shaders/lib/smooth_points.h"
};

SNOWBOUGH_KERNEL void find_normals(Smooth smooth, size_t begin, size_t end, glm::vec4* normals) {
  for (size_t i = begin; i < end; ++i) normals[i] = smooth.smooth_normal(static_cast<int>(i));
}

SNOWBOUGH_KERNEL void find_points(Smooth smooth, size_t begin, size_t end, glm::vec4* points) {
  for (size_t i = begin; i < end; ++i) points[i] = smooth.smooth_point(static_cast<int>(i));
}

}  // namespace
}  // namespace kernel

namespace cpu {
namespace {

/// Triangles per thread at a time.
constexpr size_t kRun = 1024;

/// Calls `work` with runs of `count` items, on all cores.
template <typename Work>
void for_each_run(size_t count, const Work& work) {
  base::for_each_item((count + kRun - 1) / kRun, 1,
                      [&](size_t run) { work(run * kRun, std::min((run + 1) * kRun, count)); });
}

SNOWBOUGH_KERNEL void set_up_run(const glm::vec3* positions, const shared::SceneTriangle* triangles,
                                 const shared::ProjectionFrame& frame, size_t count,
                                 glm::vec4* corners, glm::vec4* surface) {
  for (size_t i = 0; i < count; ++i) {
    const shared::SceneTriangle& triangle = triangles[i];
    const shared::TriangleSetup setup =
        shared::set_up_triangle(positions[triangle.a], positions[triangle.b], positions[triangle.c],
                                (triangle.object & shared::kTwoSided) != 0, frame);
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
                                " triangles: give three corners and one surface per triangle");
  }
  for_each_run(triangles.size(), [&](size_t first, size_t end) {
    set_up_run(positions.data(), triangles.data() + first, frame, end - first,
               corners.data() + 3 * first, surface.data() + first);
  });
}

void set_up_smooth_points(Scene& scene) {
  const SmoothPoints& points = scene.layout.smooth_points;
  kernel::Smooth smooth{};
  smooth.projection = scene.frame;
  smooth.positions = scene.positions.data();
  smooth.triangles = kernel::rows<glm::uvec4>(scene.layout.triangles);
  smooth.triangle_points = points.of_triangle.data();
  smooth.point_begin = kernel::words(points.begin);
  smooth.point_corners = kernel::words(points.corners);
  smooth.triangle_surface = scene.surface.data();
  smooth.point_normals = scene.point_normals.data();
  if (!scene.normals_are_current) {
    for_each_run(points.count(), [&](size_t begin, size_t end) {
      kernel::find_normals(smooth, begin, end, scene.point_normals.data());
    });
    scene.normals_are_current = true;
  }
  for_each_run(points.count(), [&](size_t begin, size_t end) {
    kernel::find_points(smooth, begin, end, scene.smooth_points.data());
  });
}

}  // namespace cpu
}  // namespace snowbough::snow
