#pragma once

#include <cstdint>

#include "gpu/program.h"
#include "gpu/program_variants.h"
#include "gpu/resources.h"
#include "snow/scene/projection.h"
#include "snow/step/engine/engine.h"
#include "snow/step/gl/driver.h"
#include "snow/step/gl/occlusion.h"
#include "snow/step/gl/scene_buffers.h"

// The passes of a step as shaders, in their order. The OcclusionPass in step/gl/occlusion.h draws
// the surfaces that the sky sees. Each pass has a source and a shader of its name.
namespace snowbough::snow {

/// Evaluates every triangle on the current vertices as seen along this step's fall: corners in grid
/// pixels with depth, slopes, area; then the smooth points. It runs first; all other passes read
/// its result instead of the vertices.
class TriangleSetupPass {
 public:
  /// Fills the scene's `triangle_corners` and `triangle_surface` (shaders/lib/triangle_setup.h) and
  /// its `smooth_points`. `projection` holds the ProjectionFrame. GPU thread.
  void run(SceneBuffers& scene, const gpu::Buffer& projection);

 private:
  void find_smooth_points(SceneBuffers& scene, const gpu::Buffer& projection);

  gpu::Program program_{{"triangle_setup.comp.glsl"}};
  gpu::ProgramVariants points_{{"smooth_points.comp.glsl"}};
};

/// Byte offsets of the dispatch arguments in a list of groups: one invocation per texel, in blocks
/// of 64, or one work group per group, in which each invocation takes every 64th texel.
inline constexpr int64_t kBlocks = 0;
inline constexpr int64_t kWholeGroups = 16;

/// Selects the groups of texels that the passes of a step process: groups that hold snow or have a
/// triangle that faces the fall. On a solid body that is about half; the passes would change
/// nothing in the others.
class TexelGroupsPass {
 public:
  /// Fills the batches' `active_groups` from the triangles of this step's TriangleSetupPass. `all`
  /// selects every group. GPU thread.
  void run(SceneBuffers& scene, bool all);

  /// Marks all groups as holding snow: for maps that were written from outside. GPU thread.
  static void forget(SceneBuffers& scene);

 private:
  gpu::Program groups_{{"texel_groups.comp.glsl"}};
};

/// Evaluates covered area and upward parts of the texels on the current triangles. Only for steps
/// without DepositPass, which does the same.
class TexelSurfacePass {
 public:
  /// Fills in `area`, `up` and `back_up` of the batches' `steps`, in their `active_groups`. GPU
  /// thread.
  void run(SceneBuffers& scene);

 private:
  gpu::ProgramVariants programs_{{"texel_surface.comp.glsl"}};
};

/// Counts, per receiver, the pixels in which the sky sees back faces of surfaces that gather
/// nothing: a high count suggests flipped normals.
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

/// Gathers the deposit of a tile at the texels. A texel gains
///
///   depth / max(|d.z|, 0.01) * sum over its fragments of (area * |n . d| * seen) / its area
///
/// where `seen` is the part of the pixels around the fragment that show nothing in front of the
/// fragment's plane (shaders/lib/visibility.h, shaders/lib/texel_gain.h). No pixel distributes snow
/// and no sum is kept per pixel: an evenly lit surface is covered evenly, and geometry thinner than
/// a pixel gets its own share. Differs on purpose from the scatter of Algorithm 1 in D. T.
/// Reynolds, Real-Time Rendering and Simulation of Trees and Snow, 2014, which is
/// DepositGeometryPass.
class DepositPass {
 public:
  /// Adds the texels' gain in the tile to `gain` of the batches' `steps`, or sets it in the step's
  /// first tile, and fills their `area`, `up` and `back_up`. `occlusion` shows the tile. GPU
  /// thread.
  void run(SceneBuffers& scene, const gpu::Buffer& projection, const Tile& tile,
           const OcclusionTarget& occlusion, bool has_noise, bool is_first);

 private:
  gpu::ProgramVariants programs_{{"deposit.comp.glsl"}};
};

/// Algorithm 1 of D. T. Reynolds, Real-Time Rendering and Simulation of Trees and Snow, 2014, kept
/// for comparison: one point per pixel of the occlusion map, placed by a geometry shader on the
/// texel under the pixel's centre and added by blending. All snow of a pixel goes to that texel, so
/// volumes are kept but thickness depends on how pixels and texels coincide. Sums are floats: their
/// last bits depend on the driver's order. Needs OpenGL 4.1.
class DepositGeometryPass {
 public:
  /// Before a step's first tile: clears the groups' deposit maps, and creates missing ones. GPU
  /// thread.
  void begin(SceneBuffers& scene);
  /// Adds one tile's snow to the groups' `deposit` maps. The scene must have owners, and the
  /// batches' `steps` must hold areas. GPU thread.
  void run(SceneBuffers& scene, const gpu::Buffer& projection, const Tile& tile,
           const OcclusionTarget& occlusion);

 private:
  gpu::Program program_{
      {"geometry_deposit.vert.glsl", "geometry_deposit.geom.glsl", "geometry_deposit.frag.glsl"}};
  gpu::VertexArray vertices_;
};

/// Adds the step's deposit (`gain` of the batches' `steps`) to the height maps and lets snow beyond
/// the slope's capacity slide, in closed form over `dt` seconds. Writes the volumes to the batches'
/// `partials`, one per invocation: `local_size` per work group of texels.
class StabilityPass {
 public:
  /// `local_size`: at most shared::kMaxLocalSize. GPU thread.
  explicit StabilityPass(int32_t local_size = snow::local_size()) : local_size_(local_size) {}

  /// `full_gain`: thickness in metres of a texel that gains shared::kGainUnits. `on_deposit_maps`:
  /// read the deposit from the groups' `deposit` maps instead. GPU thread.
  void run(SceneBuffers& scene, const StabilitySettings& settings, float full_gain, float dt,
           bool on_deposit_maps = false);

 private:
  int32_t local_size_;
  gpu::ProgramVariants programs_{{"stability.comp.glsl"}};
};

/// Keeps every receiver's balance on the GPU, so that no step waits for a read.
class StatisticsPass {
 public:
  /// `local_size`: the stability pass's. GPU thread.
  explicit StatisticsPass(int32_t local_size = snow::local_size())
      : sums_({"statistics.comp.glsl"}, {local_size_define(local_size)}) {}

  /// Sets the step's sums to zero; before the deposit. GPU thread.
  void open(SceneBuffers& scene);
  /// Adds up the stability pass's work groups and updates the totals. `pixel_area` in m2. GPU
  /// thread.
  void close(SceneBuffers& scene, float pixel_area);

 private:
  gpu::Program sums_;
  gpu::Program open_{{"statistics_step.comp.glsl"}, {"OPENING"}};
  gpu::Program close_{{"statistics_step.comp.glsl"}};
};

}  // namespace snowbough::snow
