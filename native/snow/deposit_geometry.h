#pragma once

#include <cstdint>
#include <vector>

#include "gpu/program.h"
#include "snow/fall_grid.h"
#include "snow/occlusion.h"
#include "snow/scene_buffers.h"
#include "snow/walkers.h"

namespace snowbough::snow {

/// The formulation GEOMETRY of the deposit, with shaders of OpenGL 4.1: points instead of compute
/// invocations, a geometry shader that places them on the layered map, additive blending instead of
/// atomics. The same shares as DepositComputePass; sums are floats, so their last bits depend on
/// the driver's order. Source: Algorithm 1 of D. T. Reynolds, Real-Time Rendering and Simulation of
/// Trees and Snow, 2014.
class DepositGeometryPass {
 public:
  /// Before a step's first tile: empties the groups' deposit maps, and makes them where they are
  /// not there. GPU thread.
  void begin(SceneBuffers& scene);
  /// Adds the snow of one tile to the groups' `deposit` maps and counts pixels. GPU thread.
  void run(SceneBuffers& scene, const gpu::Buffer& fall, const Tile& tile,
           const OcclusionTarget& occlusion);

 private:
  void weigh(SceneBuffers& scene, const gpu::Buffer& fall, const Tile& tile,
             const OcclusionTarget& occlusion);
  void drop_on_pixels(SceneBuffers& scene, const gpu::Buffer& fall, const Tile& tile,
                      const OcclusionTarget& occlusion);
  void share_out(SceneBuffers& scene, const gpu::Buffer& fall, const Tile& tile,
                 const OcclusionTarget& occlusion);
  void count(SceneBuffers& scene, const gpu::Buffer& fall, const Tile& tile,
             const OcclusionTarget& occlusion);

  gpu::Program weigh_{{"geometry_weigh.vert.glsl", "geometry_weigh.frag.glsl"}};
  gpu::Program pixels_{
      {"geometry_pixels.vert.glsl", "geometry_pixels.geom.glsl", "geometry_deposit.frag.glsl"}};
  gpu::Program share_{
      {"geometry_share.vert.glsl", "geometry_deposit.geom.glsl", "geometry_deposit.frag.glsl"}};
  gpu::Program count_{{"pixel_counts.comp.glsl"}, {walkers_define(walkers())}};
  gpu::VertexArray vertices_;
  gpu::Texture weight_map_;
  gpu::Framebuffer weight_target_;
};

}  // namespace snowbough::snow
