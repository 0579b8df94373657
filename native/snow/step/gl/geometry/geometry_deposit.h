#pragma once

#include <vector>

#include "gpu/program.h"
#include "gpu/resources.h"
#include "snow/scene/projection.h"
#include "snow/step/gl/occlusion.h"
#include "snow/step/gl/scene_buffers.h"

namespace snowbough::snow {

/// Algorithm 1 of D. T. Reynolds, Real-Time Rendering and Simulation of Trees and
/// Snow, 2014, kept for comparison. One point per pixel of the occlusion map, placed by a geometry
/// shader on the texel under the pixel's centre and added by blending. All snow of a pixel goes to
/// that texel, so volumes are kept but thickness depends on how pixels and texels coincide. Sums
/// are floats: their last bits depend on the driver's order. Needs OpenGL 4.1. Nothing else knows
/// these maps. GPU thread.
class GeometryDeposit {
 public:
  /// `objects`: those of the scene, in its order.
  GeometryDeposit(const std::vector<const SceneObject*>& objects, const SceneBuffers& scene);

  /// Before a step's first tile: clears the deposit.
  void begin();
  /// Adds one tile's snow. The batches' `steps` must hold areas.
  void run(const SceneBuffers& scene, const gpu::Buffer& projection, const Tile& tile,
           const OcclusionTarget& occlusion);
  /// Writes the deposit to `gain` of the batches' `steps`, as a StabilityPass reads it `in_metres`.
  void write_gains(SceneBuffers& scene);

  /// Bytes of these maps for objects that are not yet in a scene.
  static int64_t memory(const std::vector<const SceneObject*>& objects);

 private:
  /// Of a map group. `owners`: per texel its owner, 1 + index in the group, 0 = none; `charts`: the
  /// owner's chart within its object; `deposit`: a step's deposit in metres, negative on backs.
  struct Maps {
    Maps(int32_t resolution, int32_t layers);
    gpu::Texture owners;
    gpu::Texture charts;
    gpu::Texture deposit;
    gpu::Framebuffer target;
  };
  std::vector<Maps> maps_;
  /// Per map triangle: the owner (see above) of the texel that holds most of it, and its chart.
  gpu::Buffer main_texels_;
  gpu::BufferTexture main_texels_view_;
  gpu::Program points_{
      {"geometry_deposit.vert.glsl", "geometry_deposit.geom.glsl", "geometry_deposit.frag.glsl"}};
  gpu::Program gains_{{"geometry_gain.comp.glsl"}};
  gpu::VertexArray vertices_;
};

}  // namespace snowbough::snow
