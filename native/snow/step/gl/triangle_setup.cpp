#include <algorithm>

#include "snow/step/gl/passes.h"

namespace snowbough::snow {
namespace {

constexpr int64_t kCornerBytes = 48;
constexpr int64_t kSurfaceBytes = 16;
/// Triangles of one dispatch: their corners fit llvmpipe's largest storage block (128 MiB), they
/// are no more than 65,535 groups of 64, and blocks may begin where the next ones' corners do.
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
}

}  // namespace snowbough::snow
