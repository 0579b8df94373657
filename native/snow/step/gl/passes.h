#pragma once

#include <cstdint>

#include "gpu/program.h"
#include "gpu/program_variants.h"
#include "gpu/resources.h"
#include "snow/scene/projection.h"
#include "snow/step/engine.h"
#include "snow/step/gl/driver.h"
#include "snow/step/gl/occlusion.h"
#include "snow/step/gl/scene_buffers.h"

// The passes of a step as shaders, in their order; what the sky sees is drawn by the OcclusionPass
// of step/gl/occlusion.h. Each has a source and a shader of its name.
namespace snowbough::snow {

/// Evaluates every triangle on the current vertices as the fall of this step meets it: corners in
/// pixels of the grid and depth, slopes, area; then what lies at smooth points. First pass of a
/// step; all others build on it instead of on vertices.
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

/// Where a list of groups holds the arguments of a dispatch: an invocation a texel, in blocks of
/// 64, or whole groups, each invocation with every 64th texel. Bytes from the list's beginning.
inline constexpr int64_t kBlocks = 0;
inline constexpr int64_t kWholeGroups = 16;

/// Chooses the work groups of texels that the passes of a step work on: those on which snow lies or
/// of which a triangle faces the fall. On a solid body that is about half; the passes would change
/// nothing on the others.
class TexelGroupsPass {
 public:
  /// Fills the batches' `active_groups`, by the triangles of this step's TriangleSetupPass. `all`
  /// takes every group. GPU thread.
  void run(SceneBuffers& scene, bool all);

  /// Snow may lie anywhere: for maps that were written from outside. GPU thread.
  static void forget(SceneBuffers& scene);

 private:
  gpu::Program groups_{{"texel_groups.comp.glsl"}};
};

/// Evaluates texels on the current triangles: covered area and upward parts. Only for steps without
/// DepositPass, which does so on its way.
class TexelSurfacePass {
 public:
  /// Fills in `area`, `up` and `back_up` of the batches' `steps`, in their `active_groups`. GPU
  /// thread.
  void run(SceneBuffers& scene);

 private:
  gpu::ProgramVariants programs_{{"texel_surface.comp.glsl"}};
};

/// Counts the pixels in which the sky sees back faces of every receiver that gather nothing: many
/// of them hint at flipped normals.
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
  /// is the step's first tile, and fills in their `area`, `up` and `back_up`. `occlusion` shows the
  /// tile. GPU thread.
  void run(SceneBuffers& scene, const gpu::Buffer& projection, const Tile& tile,
           const OcclusionTarget& occlusion, bool has_noise, bool is_first);

 private:
  gpu::ProgramVariants programs_{{"deposit.comp.glsl"}};
};

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

/// Adds the step's deposit (`gain` of the batches' `steps`) to the height maps and lets slide what
/// the slope cannot hold, in closed form over `dt` seconds; leaves the volumes in the batches'
/// `partials`, one an invocation: `local_size` a work group of texels.
class StabilityPass {
 public:
  /// `local_size`: at most shared::kMaxLocalSize. GPU thread.
  explicit StabilityPass(int32_t local_size = snow::local_size()) : local_size_(local_size) {}

  /// `full_gain`: thickness in metres that a texel which gains shared::kGainUnits is given.
  /// `on_deposit_maps`: the deposit lies on the groups' `deposit` maps instead. GPU thread.
  void run(SceneBuffers& scene, const StabilitySettings& settings, float full_gain, float dt,
           bool on_deposit_maps = false);

 private:
  int32_t local_size_;
  gpu::ProgramVariants programs_{{"stability.comp.glsl"}};
};

/// Keeps every receiver's balance on the GPU, so that no step has to wait for a read.
class StatisticsPass {
 public:
  /// `local_size`: the stability pass's. GPU thread.
  explicit StatisticsPass(int32_t local_size = snow::local_size())
      : sums_({"statistics.comp.glsl"}, {local_size_define(local_size)}) {}

  /// Sets the step's sums to zero; before the deposit. GPU thread.
  void open(SceneBuffers& scene);
  /// Adds up the stability pass's work groups and brings the totals up to date. `pixel_area` in m2.
  /// GPU thread.
  void close(SceneBuffers& scene, float pixel_area);

 private:
  gpu::Program sums_;
  gpu::Program open_{{"statistics_step.comp.glsl"}, {"OPENING"}};
  gpu::Program close_{{"statistics_step.comp.glsl"}};
};

}  // namespace snowbough::snow
