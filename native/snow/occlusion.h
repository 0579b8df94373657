#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "gpu/program.h"
#include "gpu/resources.h"
#include "snow/fall_grid.h"
#include "snow/scene_buffers.h"

namespace snowbough::snow {

/// What the sky sees in the pixels of one tile. Grows to the largest tile asked for.
struct OcclusionTarget {
  /// R32UI: 1 + triangle with kBackFace, 0 = nothing.
  gpu::Texture visible;
  /// Depth along the fall: 0 and 1 are the ends of FallFrame::range.
  gpu::Texture depth;
  gpu::Framebuffer framebuffer;

  /// GPU thread.
  void require_size(glm::ivec2 size);
};

/// A run of triangles to draw.
struct TriangleRange {
  int32_t first = 0;
  int32_t count = 0;
  /// Whether they may have holes, and then what leads from their index to that of their alpha.
  bool has_alpha = false;
  int32_t alpha_offset = 0;
};

/// Renders the scene along the fall onto one tile of the grid.
class OcclusionPass {
 public:
  /// `fall` holds the FallFrame, the triangles are those of its TriangleFallPass. Clears and fills
  /// the lower left `tile.pixels.size()` pixels of `target`. Back faces are drawn and marked; what
  /// an alpha mask cuts away is not there, whichever way it faces. Ranges are drawn in their order,
  /// which decides where two surfaces coincide. GPU thread.
  void run(const SceneBuffers& scene, const gpu::Buffer& fall, const Tile& tile,
           const std::vector<TriangleRange>& ranges, OcclusionTarget& target);

 private:
  void use(gpu::Program& program, const SceneBuffers& scene, const gpu::Buffer& fall,
           const Tile& tile);

  gpu::Program program_{{"occlusion.vert.glsl", "occlusion.frag.glsl"}};
  /// Made when the first object with alpha is drawn.
  std::unique_ptr<gpu::Program> alpha_program_;
  gpu::VertexArray vertices_;
};

}  // namespace snowbough::snow
