#pragma once

#include <cstddef>
#include <cstdint>

#include "gpu/program.h"
#include "gpu/resources.h"

namespace snowbough::render {

/// The patches of an object that are drawn in one picture. The GPU writes the list, and the draws
/// read it on the GPU.
struct PatchList {
  /// Allocates the list for `patches` patches.
  explicit PatchList(size_t patches);

  int32_t patch_count = 0;
  gpu::Buffer classes;
  gpu::Buffer group_counts;
  gpu::Buffer plain;
  gpu::Buffer tessellated;
  /// One TreeDrawCommand for the plain patches, then `draws` commands for the tessellated ones.
  gpu::Buffer commands;
  int32_t draws = 1;
};

/// Numbers of patches by class, read back from a list.
struct PatchCounts {
  int64_t dropped = 0;
  int64_t plain = 0;
  int64_t tessellated = 0;
};

/// Classifies patches and lists them in order. GPU thread.
class PatchListPasses {
 public:
  /// Runs a classification program and writes the lists and the draw commands. The program includes
  /// glsl/count_classes.glsl; the caller has bound its other inputs. `plain_vertices`: vertices per
  /// plain patch; `max_level`: highest tessellation level of an edge in this view.
  void run(gpu::Program& classify, PatchList& list, int32_t plain_vertices, float max_level);

 private:
  gpu::Program offsets_{{"patch_offsets.comp.glsl"}};
  gpu::Program lists_{{"patch_lists.comp.glsl"}};
};

PatchCounts count_patches(const PatchList& list, int32_t plain_vertices);

}  // namespace snowbough::render
