#pragma once

#include <cstdint>
#include <vector>

#include "gpu/program.h"
#include "gpu/resources.h"
#include "render/draw/cached_buffer.h"
#include "render/draw/work_list.h"

namespace snowbough::render {

/// The patches of all instances that may be drawn in one picture, in batches that are drawn
/// together. The GPU writes which are drawn, and the draws read it on the GPU.
class PatchList {
 public:
  void clear();
  /// Adds successive patches of an instance to the current batch.
  void add(int32_t instance, int32_t first_item, int32_t count);
  void end_batch();

  const std::vector<shared::WorkRange>& ranges() const { return work_.ranges(); }
  bool is_empty() const { return work_.is_empty(); }
  int32_t batch_count() const { return static_cast<int32_t>(batches_.size()); }
  int32_t command_count() const { return batches_.back().first_draw + batches_.back().draws; }

  /// Draw the batches from `begin` to before `end` by one call.
  void draw_plain(gpu::Program& program, int32_t begin, int32_t end) const;
  void draw_tessellated(gpu::Program& program, int32_t begin, int32_t end) const;

  /// Per slot, see WorkList: the item's class.
  const gpu::Buffer& classes() const { return classes_; }
  /// Instance and item of each plain patch that is drawn, and of each tessellated one.
  const gpu::Buffer& plain() const { return plain_; }
  const gpu::Buffer& tessellated() const { return tessellated_; }
  /// A TreeDrawCommand per batch for its plain patches, then those for the tessellated ones.
  const gpu::Buffer& commands() const { return commands_; }

 private:
  friend class PatchListPasses;

  WorkList work_;
  std::vector<shared::DrawBatch> batches_;
  std::vector<int32_t> batch_patches_;
  int32_t begun_ = 0;
  CachedBuffer<shared::DrawBatch> batch_buffer_;
  gpu::Buffer classes_{0};
  gpu::Buffer group_counts_{0};
  gpu::Buffer plain_{0};
  gpu::Buffer tessellated_{0};
  gpu::Buffer commands_{0};
};

/// Numbers of drawn patches by class, read back from a list.
struct PatchCounts {
  int64_t plain = 0;
  int64_t tessellated = 0;
};

/// Classifies patches and lists them in order, in three dispatches for all instances. GPU thread.
class PatchListPasses {
 public:
  /// Runs a classification program and writes the lists and the draw commands. The program includes
  /// glsl/count_classes.glsl; the caller has bound its other inputs. `plain_vertices`: vertices per
  /// plain patch; `max_level`: highest tessellation level of an edge in this view, 0: there are
  /// only plain patches.
  void run(gpu::Program& classify, PatchList& list, int32_t plain_vertices, float max_level);

 private:
  gpu::Program offsets_{{"patch_offsets.comp.glsl"}};
  gpu::Program lists_{{"patch_lists.comp.glsl"}};
};

PatchCounts count_patches(const PatchList& list, int32_t plain_vertices);

}  // namespace snowbough::render
