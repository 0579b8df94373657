#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gpu/program.h"
#include "gpu/program_variants.h"
#include "gpu/resources.h"
#include "render/draw/draw_kind.h"
#include "render/draw/map_depths.h"
#include "render/draw/patch_lists.h"
#include "render/draw/patch_passes.h"
#include "render/sources.h"
#include "render/tree/bark_images.h"
#include "render/tree/tree_patches.h"

namespace snowbough::render {

/// A tree on the GPU: uploaded once, but for its pose.
struct TreeBuffers : PatchSource {
  explicit TreeBuffers(const TreePatches& tree);

  std::vector<std::string> defines(DrawKind kind) const override;
  void bind_classify(gpu::Program& program) const override;
  void bind_plain(gpu::Program& program, DrawKind kind) const override;
  void bind_tessellated(gpu::Program& program, DrawKind kind) const override;

  /// Height map in metres, R32F, row 0 = v 0; null: no snow.
  void set_snow(std::shared_ptr<const gpu::Texture> heights, const SnowDepths& depths);

  int32_t vertex_count = 0;
  int32_t edge_count = 0;
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
  SnowDepths snow_depths;
  gpu::Buffer tile_depths;
  /// Most of them, metres.
  gpu::Buffer deepest_snow{sizeof(float)};
  /// Whether that is not the map's.
  bool snow_is_new = false;
};

/// The passes of a tree, in the order of a frame: pose, edge_levels, then for the sun's picture and
/// the camera's those of `patches`. `view` holds a TreeView. Nothing is read back. GPU thread.
class TreePasses {
 public:
  /// Poses the vertices with the bones' matrices, and lays on them what snow there is.
  void pose(TreeBuffers& tree, const gpu::Buffer& view);
  /// The tessellation level of each edge.
  void edge_levels(TreeBuffers& tree, const gpu::Buffer& view);

  /// A plain patch is two triangles.
  PatchPasses patches{"tree", 6};

 private:
  void find_deepest(TreeBuffers& tree);

  MapDepths map_depths_;
  gpu::ProgramVariants pose_{{"tree_pose.comp.glsl"}};
  gpu::ProgramVariants edges_{{"tree_edges.comp.glsl"}};
};

}  // namespace snowbough::render
