#include <algorithm>

#include "snow/step/gl/passes.h"

namespace snowbough::snow {
namespace {

constexpr int64_t kCornerBytes = 48;
constexpr int64_t kSurfaceBytes = 16;
/// Triangles per dispatch: their corners fit llvmpipe's largest storage block (128 MiB), they need
/// at most 65,535 groups of 64, and the offsets of the following blocks are aligned.
constexpr int32_t kDispatch = 1 << 21;

}  // namespace

void TriangleSetupPass::run(SceneBuffers& scene, const gpu::Buffer& projection) {
  program_.use();
  program_.bind("Projection", projection);
  program_.bind_texture("positions", scene.views.positions);
  program_.bind_texture("triangles", scene.views.triangles);
  for (int32_t first = 0; first < scene.triangle_count; first += kDispatch) {
    const int32_t count = std::min(scene.triangle_count - first, kDispatch);
    program_.bind("TriangleCorners", scene.triangle_corners, first * kCornerBytes,
                  count * kCornerBytes);
    program_.bind("TriangleSurface", scene.triangle_surface, first * kSurfaceBytes,
                  count * kSurfaceBytes);
    program_.set("first", static_cast<uint32_t>(first));
    program_.set("count", static_cast<uint32_t>(count));
    program_.dispatch(gpu::group_count(count, 64));
  }
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
  if (scene.smooth_point_count > 0) find_smooth_points(scene, projection);
}

void TriangleSetupPass::find_smooth_points(SceneBuffers& scene, const gpu::Buffer& projection) {
  const auto run = [&](gpu::Program& program, const gpu::Buffer& points) {
    program.bind("Projection", projection);
    program.bind_texture("point_begin", scene.views.point_begin);
    program.bind_texture("point_corners", scene.views.point_corners);
    program.bind("Points", points);
    program.set("count", static_cast<int32_t>(scene.smooth_point_count));
    program.dispatch_items(scene.smooth_point_count, 64);
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
  };
  if (!scene.normals_are_current) {
    gpu::Program& normals = points_.with({"NORMALS"});
    normals.use();
    normals.bind_texture("positions", scene.views.positions);
    normals.bind_texture("triangles", scene.views.triangles);
    run(normals, scene.point_normals);
    scene.normals_are_current = true;
  }
  gpu::Program& gains = points_.with({});
  gains.use();
  gains.bind_texture("triangle_points", scene.views.triangle_points);
  gains.bind_texture("triangle_surface", scene.views.triangle_surface);
  gains.bind_texture("point_normals", scene.views.point_normals);
  run(gains, scene.smooth_points);
}

}  // namespace snowbough::snow
