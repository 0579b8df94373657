#pragma once

#include "gpu/program.h"
#include "snow/scene/projection.h"
#include "snow/step/gl/occlusion.h"
#include "snow/step/gl/scene_buffers.h"
#include "snow/step/gl/work_group_size.h"

namespace snowbough::snow {

/// Counts the pixels in which the sky sees back faces of every receiver, which gather nothing: many
/// of them hint at flipped normals.
class BackPixelsPass {
 public:
  /// `local_size`: at most shared::kMaxLocalSize. GPU thread.
  explicit BackPixelsPass(int32_t local_size = snow::local_size())
      : program_({"back_pixels.comp.glsl"}, {local_size_define(local_size)}) {}

  /// Adds a tile's own pixels to the scene's `back_pixels`. GPU thread.
  void run(SceneBuffers& scene, const Tile& tile, const OcclusionTarget& occlusion);

 private:
  gpu::Program program_;
};

}  // namespace snowbough::snow
