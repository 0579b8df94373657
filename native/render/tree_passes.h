#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>
#include <memory>
#include <span>
#include <vector>

#include "gpu/program.h"
#include "gpu/program_variants.h"
#include "gpu/resources.h"
#include "render/draw_kind.h"
#include "render/patch_lists.h"
#include "render/tree_patches.h"

namespace snowbough::render {

/// Rows of matrices in the order in which shaders read them: three a bone.
std::vector<glm::vec4> bone_rows(std::span<const glm::mat4> matrices);

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
  /// Sorts patches into dropped, plain and tessellated and writes their lists and draws.
  /// `max_level`: the highest level that an edge of the view can have.
  void classify(TreeBuffers& tree, PatchList& list, const gpu::Buffer& view, float max_level);

  using Kind = DrawKind;
  /// Vertices of a plain patch: two triangles.
  static constexpr int32_t kPlainVertices = 6;
  /// Draws a list's two parts into the bound framebuffer (kCapture: into the buffer bound to
  /// transform feedback).
  void draw_plain(TreeBuffers& tree, PatchList& list, const gpu::Buffer& view,
                  const DrawStyle& style);
  void draw_tessellated(TreeBuffers& tree, PatchList& list, const gpu::Buffer& view,
                        const DrawStyle& style);

 private:
  gpu::ProgramVariants pose_{{"tree_pose.comp.glsl"}};
  gpu::Program edges_{{"tree_edges.comp.glsl"}};
  gpu::Program classify_{{"tree_classify.comp.glsl"}};
  PatchListPasses lists_;
  gpu::ProgramVariants plain_{{"tree_plain.vert.glsl", "tree_plain.frag.glsl"}};
  gpu::ProgramVariants plain_capture_{{"tree_plain.vert.glsl"}};
  gpu::ProgramVariants tree_{
      {"tree.vert.glsl", "tree.tesc.glsl", "tree.tese.glsl", "tree.frag.glsl"}};
  gpu::ProgramVariants tree_capture_{{"tree.vert.glsl", "tree.tesc.glsl", "tree.tese.glsl"}};
};

}  // namespace snowbough::render
