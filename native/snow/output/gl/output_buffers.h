#pragma once

#include <array>
#include <cstdint>

#include "gpu/program.h"
#include "gpu/resources.h"
#include "snow/seams/seam_table.h"
#include "snow/texels/texel_table.h"

namespace snowbough::snow {

/// Work-group size of the output passes.
inline constexpr int32_t kOutputGroup = 64;

/// WeightedRows on the GPU, with the target place of each row's sum.
struct RowBuffers {
  int32_t count = 0;
  gpu::Buffer begin;
  gpu::Buffer source;
  gpu::Buffer weight;
  gpu::Buffer target;
};

/// A receiver's tables and working arrays on the GPU.
struct OutputBuffers {
  /// Data of one axis: see TexelLines. The two arrays alternate as source and target.
  struct Lines {
    int32_t length = 0;
    gpu::Buffer place;
    std::array<gpu::Buffer, 2> line;
    int32_t current = 0;
    RowBuffers ghosts;
  };
  int32_t texel_count = 0;
  int32_t resolution = 0;
  gpu::Buffer texel;
  Lines u;
  Lines v;
  RowBuffers dilation;
  /// The output heights, resolution^2 floats.
  gpu::Buffer map;
};

/// Uploads a receiver's tables. GPU thread.
OutputBuffers make_output_buffers(const TexelTable& table, const SeamTable& seams);

/// Binds both axes' places and current line arrays: PlaceU, PlaceV, LineU, LineV.
void bind_lines(gpu::Program& program, const OutputBuffers& buffers);

}  // namespace snowbough::snow
