#pragma once

#include "gpu/program.h"
#include "snow/fall_grid.h"
#include "snow/occlusion.h"
#include "snow/scene_buffers.h"

namespace snowbough::snow {

/// The formulation COMPUTE of the deposit: a few compute passes a tile. All sums over pixels and
/// texels are integers, so the result does not depend on the order in which the GPU runs them.
///
/// A texel takes part in the pixel that its sample point projects to, when the pixel shows its map,
/// a part of it faces the fall, and its point lies on what the pixel shows: between the planes of
/// the two triangles, with a quarter of a pixel over the shallower slope to spare. A pixel's snow
/// is divided in proportion to projected area.
class DepositComputePass {
 public:
  /// Adds the snow of one tile to the batches' `units` and `share`; the shares of the step's last
  /// tile are left to the stability pass, which finds them by the batches' `targets` and
  /// pixel_share(). `step_depth` in metres; GPU thread.
  void run(SceneBuffers& scene, const gpu::Buffer& fall, const Tile& tile,
           const OcclusionTarget& occlusion, float step_depth, bool is_last);

  /// Per pixel of the last tile: the sum of the texels that took part, in kPixelWeight units.
  const gpu::Texture& weight_sum() const { return weight_sum_; }
  /// Per pixel of the last tile that shows a receiver: snow in m3 for a pixel's area of texels.
  const gpu::Texture& pixel_share() const { return pixel_share_; }

 private:
  void weigh(SceneBuffers& scene, const gpu::Buffer& fall, const Tile& tile,
             const OcclusionTarget& occlusion);
  void list_pixels(SceneBuffers& scene, const gpu::Buffer& fall, const Tile& tile,
                   const OcclusionTarget& occlusion, const MapGroup& group);
  void lay(SceneBuffers& scene, const gpu::Buffer& fall, const Tile& tile,
           const OcclusionTarget& occlusion, float step_depth, TexelBatch& batch, bool counting);
  void share_out(SceneBuffers& scene);

  gpu::Program weigh_{{"deposit_weigh.comp.glsl"}};
  gpu::Program pixels_{{"deposit_pixels.comp.glsl"}};
  gpu::Program lay_{{"deposit_lay.comp.glsl"}};
  gpu::Program share_{{"deposit_share.comp.glsl"}};
  gpu::Texture weight_sum_;
  gpu::Texture pixel_share_;
  /// Pixels of a tile that deposit_lay works on: arguments of its dispatch and their number, and
  /// them.
  gpu::Buffer list_size_;
  gpu::Buffer pixel_list_;
};

}  // namespace snowbough::snow
