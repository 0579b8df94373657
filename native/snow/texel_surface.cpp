#include "snow/texel_surface.h"

#include <algorithm>

#include "snow/texel_groups.h"

namespace snowbough::snow {
namespace {

/// Triangles that cost less than a dispatch of their own: gaps up to it are computed too.
constexpr int32_t kJoinGap = 1024;

struct Run {
  int32_t first = 0;
  int32_t end = 0;
};

/// Joins ascending runs whose gaps are at most `gap`.
std::vector<Run> joined(const std::vector<Run>& runs, int32_t gap) {
  std::vector<Run> result;
  for (const Run& run : runs) {
    if (!result.empty() && run.first - result.back().end <= gap) {
      result.back().end = run.end;
    } else if (run.end > run.first) {
      result.push_back(run);
    }
  }
  return result;
}

}  // namespace

void TexelSurfacePass::run_triangles(SceneBuffers& scene, const std::vector<int32_t>& moved) {
  std::vector<Run> runs;
  for (const int32_t object : moved) {
    const auto i = static_cast<size_t>(object);
    const int32_t end =
        i + 1 < scene.first_triangle.size() ? scene.first_triangle[i + 1] : scene.triangle_count;
    runs.push_back({scene.first_triangle[i], end});
  }
  triangles_.use();
  triangles_.bind("Positions", scene.positions);
  triangles_.bind("Triangles", scene.triangles);
  triangles_.bind("TriangleSurface", scene.triangle_surface);
  for (const Run& run : joined(runs, kJoinGap)) {
    // A dispatch takes at least 65,535 groups of 64.
    for (int32_t first = run.first; first < run.end; first += 65535 * 64) {
      const int32_t count = std::min(run.end - first, 65535 * 64);
      triangles_.set("first", static_cast<uint32_t>(first));
      triangles_.set("count", static_cast<uint32_t>(count));
      triangles_.dispatch(gpu::group_count(count, 64));
    }
  }
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT);
}

void TexelSurfacePass::run_texels(SceneBuffers& scene) {
  for (TexelBatch& batch : scene.batches) {
    texels_.use();
    texels_.bind_texture("groups", batch.views.old_groups);
    texels_.bind_texture("positions", scene.views.positions);
    texels_.bind_texture("triangles", scene.views.triangles);
    texels_.bind_texture("triangle_surface", scene.views.triangle_surface);
    texels_.bind_texture("texels", batch.views.texels);
    texels_.bind_texture("fragment_begin", batch.views.fragment_begin);
    texels_.bind_texture("fragments", batch.views.fragments);
    texels_.bind("TexelSurface", batch.surface);
    texels_.bind("TexelUp", batch.up);
    texels_.dispatch_indirect(batch.old_groups, kBlocks);
  }
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT);
}

}  // namespace snowbough::snow
