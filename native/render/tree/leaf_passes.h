#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "gpu/program_variants.h"
#include "gpu/resources.h"
#include "render/data/sources.h"
#include "render/draw/draw_kind.h"

namespace snowbough::render {

/// Leaves on the GPU, grouped by material.
struct LeafBuffers {
  /// @throws std::invalid_argument with the reason: arrays of different lengths, indices out of
  /// range, or images whose bytes do not match their size.
  LeafBuffers(const LeafSource& source, int32_t bone_count);

  struct Part {
    int32_t first_vertex = 0;
    int32_t vertex_count = 0;
    glm::vec3 color{1.0f};
    gpu::Texture image;
  };
  std::vector<Part> parts;
  gpu::Buffer vertices;
};

/// Draws leaves of every kind except kCapture. GPU thread.
class LeafPasses {
 public:
  /// `bones`: three matrix rows per bone.
  void draw(LeafBuffers& leaves, const gpu::Buffer& bones, const gpu::Buffer& view,
            const DrawStyle& style);

 private:
  gpu::ProgramVariants leaves_{{"leaves.vert.glsl", "leaves.frag.glsl"}};
};

}  // namespace snowbough::render
