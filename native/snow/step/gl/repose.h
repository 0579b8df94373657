#pragma once

#include <cstdint>
#include <vector>

#include "gpu/gl_context.h"
#include "gpu/program.h"
#include "gpu/program_variants.h"
#include "snow/repose/repose.h"
#include "snow/step/gl/repose_buffers.h"
#include "snow/step/gl/scene_buffers.h"

namespace snowbough::snow::gl {

/// Repose on all receivers of a scene, as shaders: the method of snow/repose/repose.h in rounds
/// over the whole map, by blocks of 16 x 16 texels. Maps stay on the GPU.
///
/// A sweep is one dispatch over the listed blocks. A work group computes its block with a border in
/// shared memory, reads the data of the sweep before and writes the data of its own, so that
/// neither the order of the work groups nor the layout of the blocks matters. A block in which
/// something has changed lists all blocks that this affects for the next sweep. A step records a
/// fixed number of sweeps; those with an empty list cost next to nothing.
class ReposePass {
 public:
  /// `objects` must live until the pass is destroyed. GPU thread.
  ReposePass(const std::vector<const SceneObject*>& objects, const SceneBuffers& scene,
             const gpu::GpuInfo& info);

  /// Call it when an object's positions have changed. `object`: its number in `objects`.
  void forget_pose(size_t object) { has_moved_[object] = 1; }

  /// Moves snow that is steeper than the settings allow on the scene's maps, and counts snow that
  /// falls off as slid. `dt`: duration of the step in seconds; a longer step may run more sweeps.
  /// The point normals must be those of the positions. GPU thread.
  void run(SceneBuffers& scene, const ReposeSettings& settings, float dt);

 private:
  /// Sweeps of bounds, and of rounds in a step of usual duration.
  static constexpr int32_t kBoundSweeps = 48;
  static constexpr int32_t kRoundSweeps = 128;
  /// Places of the lists in `lists`: two for sweeps, that of the first sweep of rounds, and that of
  /// all blocks of the step.
  enum List { kFirstRounds = 2, kTouched = 3 };
  struct SweepLists {
    int32_t own = 0;
    int32_t next = 0;
  };

  bool update_pose(const SceneBuffers& scene, ReposeBuffers& set);
  void find_surface(const SceneBuffers& scene, const ReposeBuffers& set);
  void find_curvatures(const SceneBuffers& scene);
  void set_cells(const SceneBuffers& scene, const ReposeBuffers& set);
  void set_links(const SceneBuffers& scene, const ReposeBuffers& set);
  void choose(const ReposeBuffers& set);
  void lower_bounds(const ReposeBuffers& set);
  void run_rounds(const ReposeBuffers& set);
  void write(SceneBuffers& scene, const ReposeBuffers& set, float dt);
  void clear_lists(ReposeBuffers& set) const;
  void bind_touched(gpu::Program& program, const ReposeBuffers& set) const;
  void bind_lists(gpu::Program& program, const ReposeBuffers& set) const;
  void bind_window(gpu::Program& program, const ReposeBuffers& set) const;
  static void bind_links(gpu::Program& program, const ReposeBuffers& set);
  void begin_sweep(gpu::Program& program, const ReposeBuffers& set, int32_t number,
                   SweepLists lists) const;
  int32_t first_rounds_head() const { return kBoundSweeps + 1; }
  int32_t touched_head() const { return kBoundSweeps + round_sweeps_ + 2; }

  std::vector<const SceneObject*> objects_;
  /// By object.
  std::vector<uint8_t> has_moved_;
  std::vector<ReposeBuffers> sets_;
  ReposeLimits limits_;
  /// Numbers of this step, and of its first sweep among all.
  uint32_t step_ = 0;
  uint32_t first_sweep_ = 1;
  int32_t round_sweeps_ = 0;
  int32_t local_size_;
  gpu::Buffer curvatures_;
  gpu::BufferTexture curvature_view_;

  gpu::Program curvature_{{"repose_curvature.comp.glsl"}};
  gpu::ProgramVariants surface_{{"repose_surface.comp.glsl"}};
  gpu::Program cells_{{"repose_cells.comp.glsl"}};
  gpu::Program links_{{"repose_links.comp.glsl"}};
  gpu::Program ends_{{"repose_ends.comp.glsl"}};
  gpu::Program choose_{{"repose_choose.comp.glsl"}};
  gpu::Program bounds_;
  gpu::Program cut_{{"repose_cut.comp.glsl"}};
  gpu::Program rounds_;
  gpu::Program write_;
  gpu::Program reset_{{"repose_reset.comp.glsl"}};
  gpu::Program sums_{{"repose_sums.comp.glsl"}};
  gpu::Program groups_{{"repose_groups.comp.glsl"}};
};

}  // namespace snowbough::snow::gl
