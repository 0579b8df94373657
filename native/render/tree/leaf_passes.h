#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "gpu/program_variants.h"
#include "gpu/resources.h"
#include "render/data/sources.h"
#include "render/draw/draw_kind.h"
#include "render/draw/patch_lists.h"

namespace snowbough::render {

/// Leaves on the GPU, grouped by material.
struct LeafBuffers {
  /// @throws std::invalid_argument with the reason: arrays of different lengths, indices out of
  /// range, or images whose bytes do not match their size.
  LeafBuffers(const LeafSource& source, int32_t bone_count);

  /// The triangles of one material.
  struct Part {
    int32_t first_vertex = 0;
    glm::vec3 color{1.0f};
    gpu::Texture image;
    /// The triangles drawn in the camera's picture and in the shadow map.
    PatchList camera;
    PatchList sun;
  };
  std::vector<Part> parts;
  gpu::Buffer vertices;
};

/// Draws leaves of every kind except kCapture. Of leaves that are too small for the picture it
/// draws a part, larger (shaders/lib/thin_limbs.h). GPU thread.
class LeafPasses {
 public:
  /// One of a part's lists: &LeafBuffers::Part::camera or sun.
  using List = PatchList LeafBuffers::Part::*;
  /// Lists the triangles to draw. `bones`: three matrix rows per bone.
  void classify(LeafBuffers& leaves, List list, const gpu::Buffer& bones, const gpu::Buffer& view);
  void draw(LeafBuffers& leaves, List list, const gpu::Buffer& bones, const gpu::Buffer& view,
            const DrawStyle& style);

 private:
  PatchListPasses lists_;
  gpu::Program classify_{{"leaf_classify.comp.glsl"}};
  gpu::ProgramVariants leaves_{{"leaves.vert.glsl", "leaves.frag.glsl"}};
};

}  // namespace snowbough::render
