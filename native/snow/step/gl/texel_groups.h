#pragma once

#include "gpu/program.h"
#include "snow/step/gl/scene_buffers.h"

namespace snowbough::snow {

/// Where a list of groups holds the arguments of a dispatch: an invocation a texel, in blocks of
/// 64, or whole groups, each invocation with every 64th texel. Bytes from the list's beginning.
inline constexpr int64_t kBlocks = 0;
inline constexpr int64_t kWholeGroups = 16;

/// Chooses the work groups of texels that the passes of a step work on: those on which snow lies or
/// of which a triangle faces the fall. On a solid body that is about half; the passes would change
/// nothing on the others.
class TexelGroupsPass {
 public:
  /// Fills the batches' `active_groups`, by the triangles of this step's TriangleSetupPass. `all`
  /// takes every group. GPU thread.
  void run(SceneBuffers& scene, bool all);

  /// Snow may lie anywhere: for maps that were written from outside. GPU thread.
  static void forget(SceneBuffers& scene);

 private:
  gpu::Program groups_{{"texel_groups.comp.glsl"}};
};

}  // namespace snowbough::snow
