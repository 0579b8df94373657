#pragma once

#include <string>
#include <vector>

#include "gpu/program.h"
#include "gpu/program_variants.h"
#include "snow/fall_grid.h"
#include "snow/occlusion.h"
#include "snow/scene_buffers.h"
#include "snow/walkers.h"

namespace snowbough::snow {

/// The snow of one step.
struct StepSnow {
  /// Metres on level ground.
  float depth = 0.0f;
  /// Whether the FallFrame's noise density is below 1.
  bool has_noise = false;
  /// What the shaders that ask for a pixel's snow are compiled with.
  std::vector<std::string> defines() const {
    return has_noise ? std::vector<std::string>{} : std::vector<std::string>{"WITHOUT_NOISE"};
  }
};

/// The formulation COMPUTE of the deposit: a few compute passes a tile. All sums over pixels and
/// texels are integers, so the result does not depend on the order in which the GPU runs them.
///
/// A texel takes part in the pixel that its sample point projects to, when the pixel shows its map,
/// a part of it faces the fall, and its point lies on what the pixel shows: between the planes of
/// the two triangles, with a quarter of a pixel over the shallower slope to spare. A pixel's snow
/// is divided in proportion to projected area.
class DepositComputePass {
 public:
  /// GPU thread.
  explicit DepositComputePass(int32_t walkers = snow::walkers()) : walkers_(walkers) {}

  /// Adds the snow of one tile to the batches' `units` and `share`; the shares of the step's last
  /// tile are left to the stability pass, which finds them by the batches' `steps`, filled in
  /// here, and weight_sum(). GPU thread.
  void run(SceneBuffers& scene, const gpu::Buffer& fall, const Tile& tile,
           const OcclusionTarget& occlusion, const StepSnow& snow, bool is_last);

  /// Per pixel of the last tile, row by row: the sum of the texels that took part, in kPixelWeight
  /// units.
  const gpu::Buffer& weight_sum() const { return weight_sum_; }
  const gpu::BufferTexture& weight_sum_view() const { return weight_sum_view_; }

 private:
  void weigh(SceneBuffers& scene, const gpu::Buffer& fall, const Tile& tile,
             const OcclusionTarget& occlusion);
  void list_pixels(SceneBuffers& scene, const gpu::Buffer& fall, const Tile& tile,
                   const OcclusionTarget& occlusion, const MapGroup& group, const StepSnow& snow);
  void lay(SceneBuffers& scene, const gpu::Buffer& fall, const Tile& tile,
           const OcclusionTarget& occlusion, float step_depth, TexelBatch& batch, bool counting);
  void spread(SceneBuffers& scene, const gpu::Buffer& fall, float step_depth, TexelBatch& batch);
  void share_out(SceneBuffers& scene, const gpu::Buffer& fall, const Tile& tile,
                 const StepSnow& snow);

  int32_t walkers_;
  gpu::ProgramVariants weigh_{{"deposit_weigh.comp.glsl"}};
  gpu::ProgramVariants pixels_{{"deposit_pixels.comp.glsl"}};
  gpu::Program lay_{{"deposit_lay.comp.glsl"}};
  gpu::Program spread_{{"deposit_spread.comp.glsl"}};
  gpu::ProgramVariants share_{{"deposit_share.comp.glsl"}};
  gpu::Buffer weight_sum_;
  gpu::BufferTexture weight_sum_view_;
  /// Pixels of a tile that deposit_lay works on: arguments of its dispatch and their number, and
  /// them.
  gpu::Buffer pixel_list_size_;
  gpu::Buffer pixel_list_;
  /// What deposit_spread works on: the same, and shared::SpreadSnow.
  gpu::Buffer spread_list_size_;
  gpu::Buffer spread_list_;
};

}  // namespace snowbough::snow
