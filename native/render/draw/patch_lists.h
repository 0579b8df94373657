#pragma once

#include <cstddef>
#include <cstdint>

#include "gpu/program.h"
#include "gpu/resources.h"

namespace snowbough::render {

/// What is drawn of an object's patches in one picture, found on the GPU and read by its draws
/// there.
struct PatchList {
  /// For `patches` patches.
  explicit PatchList(size_t patches);

  int32_t patch_count = 0;
  gpu::Buffer classes;
  gpu::Buffer group_counts;
  gpu::Buffer plain;
  gpu::Buffer tessellated;
  /// A TreeDrawCommand of the plain patches, then `draws` of the tessellated ones.
  gpu::Buffer commands;
  int32_t draws = 1;
};

/// Patches of a list by class, read back.
struct PatchCounts {
  int64_t dropped = 0;
  int64_t plain = 0;
  int64_t tessellated = 0;
};

/// Sorts patches and lists them in their order. GPU thread.
class PatchListPasses {
 public:
  /// Runs a classifying program, which includes glsl/count_classes.glsl and has all of its other
  /// inputs, and writes the lists and the draws. `plain_vertices`: of a plain patch; `max_level`:
  /// the highest that an edge of the view can have.
  void run(gpu::Program& classify, PatchList& list, int32_t plain_vertices, float max_level);

 private:
  gpu::Program offsets_{{"patch_offsets.comp.glsl"}};
  gpu::Program lists_{{"patch_lists.comp.glsl"}};
};

PatchCounts count_patches(const PatchList& list, int32_t plain_vertices);

}  // namespace snowbough::render
