#pragma once

#include <memory>
#include <vector>

#include "gpu/program.h"
#include "gpu/resources.h"
#include "snow/scene/projection.h"
#include "snow/scene/triangle_range.h"
#include "snow/step/gl/scene_buffers.h"

namespace snowbough::snow {

/// The surfaces that the sky sees in the pixels of one tile: drawn to a texture, then copied row by
/// row into a buffer, which llvmpipe reads several times faster. Grows to the largest tile
/// requested.
struct OcclusionTarget {
  gpu::Texture visible_texture;
  gpu::Texture depth_texture;
  gpu::Framebuffer framebuffer;
  /// Per pixel of the tile with its margin: a shared::SeenPixel.
  gpu::Buffer visible;
  struct Views {
    gpu::BufferTexture visible;
  } views;

  /// GPU thread.
  void require_size(glm::ivec2 size);
  /// Fills the buffer from the lower left `size` pixels of the texture. GPU thread.
  void copy_pixels(glm::ivec2 size);
};

/// Renders the scene along the fall onto one tile of the grid, with its margin.
class OcclusionPass {
 public:
  /// `projection` holds the ProjectionFrame; the triangles are from its TriangleSetupPass. Clears
  /// and fills `target` for the tile. Back faces are drawn and marked; pixels that an alpha mask
  /// cuts away are open from both sides. Ranges are drawn in order, which decides between
  /// coincident surfaces. GPU thread.
  void run(const SceneBuffers& scene, const gpu::Buffer& projection, const Tile& tile,
           const std::vector<TriangleRange>& ranges, OcclusionTarget& target);

 private:
  void use(gpu::Program& program, const SceneBuffers& scene, const gpu::Buffer& projection,
           const Tile& tile);

  gpu::Program program_{{"occlusion.vert.glsl", "occlusion.frag.glsl"}};
  /// Created when the first object with alpha is drawn.
  std::unique_ptr<gpu::Program> alpha_program_;
  gpu::VertexArray vertices_;
};

}  // namespace snowbough::snow
