#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "gpu/program.h"
#include "gpu/program_variants.h"
#include "gpu/resources.h"
#include "render/draw/draw_kind.h"
#include "render/draw/patch_lists.h"
#include "render/draw/patch_passes.h"
#include "render/tree/bark_images.h"
#include "render/tree/tree_patches.h"

namespace snowbough::render {

/// A tree on the GPU: uploaded once, but for its pose.
struct TreeBuffers {
  explicit TreeBuffers(const TreePatches& tree);

  int32_t vertex_count = 0;
  int32_t edge_count = 0;
  int32_t patch_count = 0;
  gpu::Buffer vertices;
  gpu::Buffer sections;
  gpu::Buffer edges;
  gpu::Buffer patches;
  gpu::Buffer vertex_snow;
  /// Three rows a bone.
  gpu::Buffer bones;
  gpu::Buffer posed;
  gpu::Buffer edge_levels;
  /// What its bark shows in place of its own colours, if anything.
  std::optional<BarkImages> images;
  /// Heights of its snow: R32F; null: it carries none.
  std::shared_ptr<const gpu::Texture> snow;
  /// Most of them, metres.
  float deepest_snow = 0.0f;
  PatchList camera;
  PatchList sun;
};

/// The passes of a tree, in the order of a frame: pose, edge_levels, then for the sun's picture and
/// the camera's classify and draw. `view` holds a TreeView. Nothing is read back. GPU thread.
class TreePasses {
 public:
  /// Poses the vertices with the bones' matrices.
  void pose(TreeBuffers& tree, const gpu::Buffer& view);
  /// The tessellation level of each edge.
  void edge_levels(TreeBuffers& tree, const gpu::Buffer& view);
  /// As PatchPasses'.
  void classify(TreeBuffers& tree, PatchList& list, const gpu::Buffer& view, float max_level);

  /// Vertices of a plain patch: two triangles.
  static constexpr int32_t kPlainVertices = 6;
  void draw_plain(TreeBuffers& tree, PatchList& list, const gpu::Buffer& view,
                  const DrawStyle& style);
  void draw_tessellated(TreeBuffers& tree, PatchList& list, const gpu::Buffer& view,
                        const DrawStyle& style);

 private:
  gpu::ProgramVariants pose_{{"tree_pose.comp.glsl"}};
  gpu::Program edges_{{"tree_edges.comp.glsl"}};
  PatchPasses patches_{"tree", kPlainVertices};
};

}  // namespace snowbough::render
