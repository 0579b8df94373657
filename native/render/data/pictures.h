#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "gpu/program.h"
#include "gpu/timer.h"

namespace snowbough::render {

/// Pixels of a picture: height x width x 4 (sRGB, alpha 1 where something was drawn), row 0 at the
/// bottom.
struct Picture {
  int32_t width = 0;
  int32_t height = 0;
  std::vector<uint8_t> rgba;
};

/// Linear light, height x width x 4, row 0 at the bottom. Alpha is the covered fraction of a pixel;
/// uncovered pixels hold the background's light.
struct LightPicture {
  int32_t width = 0;
  int32_t height = 0;
  std::vector<float> rgba;
};

/// Values of OpenGL's depth buffer: height x width, row 0 at the bottom. 0 is the camera's near
/// plane; 1 is the far plane and the background.
struct DepthPicture {
  int32_t width = 0;
  int32_t height = 0;
  std::vector<float> depth;
};

/// Statistics of the last picture.
struct FrameStatistics {
  /// Patches of all trees by class.
  int64_t dropped = 0;
  int64_t plain = 0;
  int64_t tessellated = 0;
  /// Triangles drawn for the camera's picture, without the shadow map's.
  int64_t triangles = 0;
  /// Calls to OpenGL. A draw of many instances or of many indirect commands is one call.
  gpu::CallCounts calls;
  /// Size of all buffers of the process on GPUs, without textures.
  int64_t buffer_bytes = 0;
  /// GPU times of the passes, in the order of a frame.
  std::vector<gpu::PassTime> passes;
  /// Time from the call to the picture, including the read back.
  double wall_seconds = 0.0;
};

/// Tessellation of a tree in the last picture, in its first place, per quad of its source. Edges of
/// patches that are certainly dropped have level 1.
struct TreeLevels {
  /// shared::kDropped, kPlain or kTessellated.
  std::vector<uint32_t> classes;
  /// Level of the edge from each corner to the next.
  std::vector<std::array<float, 4>> edges;
};

}  // namespace snowbough::render
