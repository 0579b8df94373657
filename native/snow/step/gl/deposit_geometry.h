#pragma once

#include "gpu/program.h"
#include "snow/scene/projection.h"
#include "snow/step/gl/occlusion.h"
#include "snow/step/gl/scene_buffers.h"

namespace snowbough::snow {

/// Algorithm 1 of D. T. Reynolds, Real-Time Rendering and Simulation of Trees and Snow, 2014, kept
/// for comparison: a point a pixel of the occlusion map, which a geometry shader places on the
/// texel under the pixel's centre, added up by blending. A pixel's whole snow goes to that one
/// texel, so that volumes are kept, and thickness depends on how pixels and texels meet. Sums are
/// floats: their last bits depend on the driver's order. Needs OpenGL 4.1.
class DepositGeometryPass {
 public:
  /// Before a step's first tile: empties the groups' deposit maps, and makes them where they are
  /// not there. GPU thread.
  void begin(SceneBuffers& scene);
  /// Adds the snow of one tile to the groups' `deposit` maps. The scene has owners, and the
  /// batches' `steps` hold areas. GPU thread.
  void run(SceneBuffers& scene, const gpu::Buffer& projection, const Tile& tile,
           const OcclusionTarget& occlusion);

 private:
  gpu::Program program_{
      {"geometry_deposit.vert.glsl", "geometry_deposit.geom.glsl", "geometry_deposit.frag.glsl"}};
  gpu::VertexArray vertices_;
};

}  // namespace snowbough::snow
