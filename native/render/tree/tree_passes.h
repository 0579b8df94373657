#pragma once

#include "gpu/program.h"
#include "gpu/program_variants.h"
#include "gpu/resources.h"
#include "render/draw/draw_kind.h"
#include "render/draw/patch_lists.h"
#include "render/tree/forest.h"

namespace snowbough::render {

/// The passes of a chain of trees in the order of a frame: pose, edge_levels, then classify and the
/// draws for the shadow map and for the camera's picture. `view` holds a TreeView. They read
/// nothing back. GPU thread.
class TreePasses {
 public:
  /// Poses the vertices with the bones' matrices, and adds bark and snow.
  void pose(TreeChain& chain, const gpu::Buffer& view);
  /// Computes the tessellation level of each edge.
  void edge_levels(TreeChain& chain, const gpu::Buffer& view);
  /// Sorts patches into dropped, plain and tessellated ones, and writes the list with its draw
  /// commands. `max_level`: highest tessellation level of an edge in this view.
  void classify(TreeChain& chain, PatchList& list, const gpu::Buffer& view, float max_level);
  /// Draw the plain and the tessellated patches of a list into the bound framebuffer: one draw for
  /// all trees without bark images, and one per set of images. With kCapture they write to the
  /// buffer bound to transform feedback.
  void draw_plain(const TreeChain& chain, const PatchList& list, const gpu::Buffer& view,
                  const DrawStyle& style);
  void draw_tessellated(const TreeChain& chain, const PatchList& list, const gpu::Buffer& view,
                        const DrawStyle& style);

  static PatchCounts count(const PatchList& list);

 private:
  PatchListPasses lists_;
  gpu::ProgramVariants pose_{{"tree_pose.comp.glsl"}};
  gpu::ProgramVariants edges_{{"tree_edges.comp.glsl"}};
  gpu::Program classify_{{"tree_classify.comp.glsl"}};
  gpu::ProgramVariants plain_{{"tree_plain.vert.glsl", "tree_plain.frag.glsl"}};
  gpu::ProgramVariants plain_capture_{{"tree_plain.vert.glsl"}};
  gpu::ProgramVariants tessellated_{
      {"tree.vert.glsl", "tree.tesc.glsl", "tree.tese.glsl", "tree.frag.glsl"}};
  gpu::ProgramVariants tessellated_capture_{{"tree.vert.glsl", "tree.tesc.glsl", "tree.tese.glsl"}};
};

}  // namespace snowbough::render
