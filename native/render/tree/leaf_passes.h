#pragma once

#include "gpu/program.h"
#include "gpu/program_variants.h"
#include "gpu/resources.h"
#include "render/draw/draw_kind.h"
#include "render/draw/patch_lists.h"
#include "render/tree/forest.h"

namespace snowbough::render {

/// Draws the leaves of a chain of every kind except kCapture. Of leaves that are too small for the
/// picture it draws a part, larger (shaders/lib/thin_limbs.h). GPU thread.
class LeafPasses {
 public:
  /// Lists the triangles to draw.
  void classify(TreeChain& chain, PatchList& list, const gpu::Buffer& view);
  /// One draw per material.
  void draw(const TreeChain& chain, const PatchList& list, const gpu::Buffer& view,
            const DrawStyle& style);

 private:
  PatchListPasses lists_;
  gpu::Program classify_{{"leaf_classify.comp.glsl"}};
  gpu::ProgramVariants leaves_{{"leaves.vert.glsl", "leaves.frag.glsl"}};
};

}  // namespace snowbough::render
