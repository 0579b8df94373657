#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

#include "gpu/program.h"
#include "gpu/program_variants.h"
#include "gpu/resources.h"
#include "render/tree_patches.h"

namespace snowbough::render {

/// Rows of matrices in the order in which shaders read them: three a bone.
std::vector<glm::vec4> bone_rows(std::span<const glm::mat4> matrices);

/// What is drawn of a tree in one picture, found on the GPU and read by its draws there.
struct TreeDrawList {
  /// For `patches` patches.
  explicit TreeDrawList(size_t patches);

  gpu::Buffer classes;
  gpu::Buffer group_counts;
  gpu::Buffer plain;
  gpu::Buffer tessellated;
  /// A TreeDrawCommand of the plain patches, then `draws` of the tessellated ones.
  gpu::Buffer commands;
  int32_t draws = 1;
};

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
  /// Three rows a bone.
  gpu::Buffer bones;
  gpu::Buffer posed;
  gpu::Buffer edge_levels;
  TreeDrawList camera;
  TreeDrawList sun;
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
  void classify(TreeBuffers& tree, TreeDrawList& list, const gpu::Buffer& view, float max_level);

  /// What a draw makes.
  enum class Kind : uint8_t { kShaded, kWire, kDepth, kCapture };
  /// Draws a list's two parts into the bound framebuffer (kCapture: into the buffer bound to
  /// transform feedback). `shadow_map` is for kShaded, `wire_color` for kWire.
  void draw_plain(TreeBuffers& tree, TreeDrawList& list, const gpu::Buffer& view, Kind kind,
                  const gpu::Texture& shadow_map, const glm::vec4& wire_color);
  void draw_tessellated(TreeBuffers& tree, TreeDrawList& list, const gpu::Buffer& view, Kind kind,
                        const gpu::Texture& shadow_map, const glm::vec4& wire_color);

 private:
  gpu::Program pose_{{"tree_pose.comp.glsl"}};
  gpu::Program edges_{{"tree_edges.comp.glsl"}};
  gpu::Program classify_{{"tree_classify.comp.glsl"}};
  gpu::Program offsets_{{"tree_offsets.comp.glsl"}};
  gpu::Program lists_{{"tree_lists.comp.glsl"}};
  gpu::ProgramVariants plain_{{"tree_plain.vert.glsl", "tree_plain.frag.glsl"}};
  gpu::ProgramVariants plain_capture_{{"tree_plain.vert.glsl"}};
  gpu::ProgramVariants tree_{
      {"tree.vert.glsl", "tree.tesc.glsl", "tree.tese.glsl", "tree.frag.glsl"}};
  gpu::ProgramVariants tree_capture_{{"tree.vert.glsl", "tree.tesc.glsl", "tree.tese.glsl"}};
};

/// Defines of a kind of draw, for programs of other objects, too.
std::vector<std::string> defines_of(TreePasses::Kind kind);

}  // namespace snowbough::render
