#pragma once

#include "gpu/program_variants.h"
#include "snow/scene/projection.h"
#include "snow/step/gl/occlusion.h"
#include "snow/step/gl/scene_buffers.h"

namespace snowbough::snow {

/// The deposit of a tile, gathered by the texels. A texel gains
///
///   depth / max(|d.z|, 0.01) * sum over its fragments of (area * |n . d| * seen) / its area
///
/// where `seen` is the part of the pixels around the fragment that show nothing in front of the
/// plane through it (shaders/lib/visibility.h, shaders/lib/texel_gain.h). Nothing is shared out and
/// nothing summed per pixel: an evenly lit surface is covered evenly, and what is thinner than a
/// pixel gets its own share. Differs on purpose from the scatter of Algorithm 1 in D. T. Reynolds,
/// Real-Time Rendering and Simulation of Trees and Snow, 2014, which is DepositGeometryPass.
class DepositPass {
 public:
  /// Adds what the texels gain in the tile to `gain` of the batches' `steps`, or sets it where this
  /// is the step's first tile, and fills in their `area` and `up`. `occlusion` shows the tile.
  /// GPU thread.
  void run(SceneBuffers& scene, const gpu::Buffer& projection, const Tile& tile,
           const OcclusionTarget& occlusion, bool has_noise, bool is_first);

 private:
  gpu::ProgramVariants programs_{{"deposit.comp.glsl"}};
};

}  // namespace snowbough::snow
