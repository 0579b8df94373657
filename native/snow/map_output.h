#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "gpu/program.h"
#include "gpu/resources.h"
#include "snow/seam_table.h"
#include "snow/smoothing.h"
#include "snow/surface_metric.h"
#include "snow/texel_table.h"

namespace snowbough::snow {

/// What a receiver's map looks like to the outside: smoothed, continued beyond its charts, level at
/// its seams. The stored map stays as it is. Both have resolution^2 values, row 0 = v 0.
struct MapOutput {
  /// Metres.
  std::vector<float> height;
  /// Tangent space (see normals.h); empty unless asked for.
  std::vector<glm::vec3> normal;
};

/// Bytes of the largest storage buffer that output on the GPU would need for this map.
int64_t largest_output_buffer(const TexelTable& table, const SeamTable& seams);

/// WeightedRows on the GPU, with the place that each row's sum goes to.
struct RowBuffers {
  int32_t count = 0;
  gpu::Buffer begin;
  gpu::Buffer source;
  gpu::Buffer weight;
  gpu::Buffer target;
};

/// A receiver's tables and working arrays on the GPU.
struct OutputBuffers {
  /// What one axis needs: see TexelLines. Two arrays take turns as source and target.
  struct Lines {
    int32_t length = 0;
    gpu::Buffer place;
    gpu::Buffer line[2];
    int32_t current = 0;
    RowBuffers ghosts;
  };
  int32_t texel_count = 0;
  int32_t resolution = 0;
  int32_t passes = 0;
  int32_t closing_passes = 0;
  gpu::Buffer texel;
  gpu::Buffer level;
  gpu::Buffer filter_levels;
  Lines u;
  Lines v;
  RowBuffers dilation;
  /// The output heights, resolution^2 floats.
  gpu::Buffer map;
  /// vec4 an owned texel.
  gpu::Buffer normals;
};

/// Uploads a receiver's tables. GPU thread.
OutputBuffers make_output_buffers(const TexelTable& table, const SeamTable& seams,
                                  const SmoothingPlan& plan);

/// Smooths a receiver's map, continues it beyond its charts and takes its normals on the GPU, as
/// CpuOutput does on the processor. Levelling, which comes between, is left to the processor
/// (OutputTables). All functions run on the GPU thread.
class MapOutputPass {
 public:
  /// Leaves the heights of layer `layer` of `height_maps` (R32F array) in `buffers.map`.
  void run(const gpu::Texture& height_maps, int32_t layer, OutputBuffers& buffers);
  /// Leaves the normals of `buffers.map` in `buffers.normals`, one an owned texel.
  void run_normals(OutputBuffers& buffers, const TexelTable& table,
                   const std::vector<SurfaceMetric>& metrics);

 private:
  void fill_ghosts(OutputBuffers::Lines& lines);
  void filter(OutputBuffers& buffers, int32_t axes, bool last);
  void add_rows(const RowBuffers& rows, const gpu::Buffer& source, const gpu::Buffer& target,
                bool nothing_without_terms);

  gpu::Program gather_{{"output_gather.comp.glsl"}, {"FROM_TEXTURE"}};
  gpu::Program refill_{{"output_gather.comp.glsl"}};
  gpu::Program rows_{{"weighted_rows.comp.glsl"}};
  gpu::Program smoothing_{{"smoothing.comp.glsl"}};
  gpu::Program normals_{{"normals.comp.glsl"}};
};

}  // namespace snowbough::snow
