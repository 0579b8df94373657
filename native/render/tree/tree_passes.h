#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gpu/program.h"
#include "gpu/program_variants.h"
#include "gpu/resources.h"
#include "render/data/sources.h"
#include "render/draw/draw_kind.h"
#include "render/draw/map_depths.h"
#include "render/draw/patch_lists.h"
#include "render/draw/patch_passes.h"
#include "render/tree/bark_images.h"
#include "render/tree/tree_patches.h"

namespace snowbough::render {

/// A tree on the GPU. Only its pose and its snow change after the upload.
struct TreeBuffers : PatchSource {
  explicit TreeBuffers(const TreePatches& tree);

  std::vector<std::string> defines(DrawKind kind) const override;
  void bind_classify(gpu::Program& program) const override;
  void bind_plain(gpu::Program& program, DrawKind kind) const override;
  void bind_tessellated(gpu::Program& program, DrawKind kind) const override;

  /// Height map in metres, R32F, row 0 at v = 0; null removes the snow.
  void set_snow(std::shared_ptr<const gpu::Texture> heights, const SnowDepths& depths);

  int32_t vertex_count = 0;
  int32_t edge_count = 0;
  gpu::Buffer vertices;
  gpu::Buffer sections;
  gpu::Buffer edges;
  gpu::Buffer patches;
  gpu::Buffer vertex_snow;
  /// Three matrix rows per bone.
  gpu::Buffer bones;
  gpu::Buffer posed;
  gpu::Buffer edge_levels;
  /// Images that replace the bark's own colours, if any.
  std::optional<BarkImages> images;
  /// Height map of the snow, R32F; null without snow.
  std::shared_ptr<const gpu::Texture> snow;
  SnowDepths snow_depths;
  /// Deepest snow of each tile of the map, see MapDepths.
  gpu::Buffer tile_depths{sizeof(float)};
  /// Of the patches in the lists, the same for every view from one eye.
  gpu::Buffer growths;
  /// True if the map has changed since these depths were computed.
  bool snow_is_new = false;
};

/// The passes of a tree in the order of a frame: pose, edge_levels, then those of `patches` for the
/// shadow map and for the camera's picture. `view` holds a TreeView. They read nothing back. GPU
/// thread.
class TreePasses {
 public:
  /// Poses the vertices with the bones' matrices, and adds bark and snow.
  void pose(TreeBuffers& tree, const gpu::Buffer& view);
  /// Computes the tessellation level of each edge.
  void edge_levels(TreeBuffers& tree, const gpu::Buffer& view);

  /// A plain patch is two triangles.
  PatchPasses patches{"tree", 6};

 private:
  void find_depths(TreeBuffers& tree);

  MapDepths map_depths_;
  gpu::ProgramVariants pose_{{"tree_pose.comp.glsl"}};
  gpu::ProgramVariants edges_{{"tree_edges.comp.glsl"}};
};

}  // namespace snowbough::render
