#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <memory>
#include <string>
#include <vector>

#include "gpu/program.h"
#include "gpu/program_variants.h"
#include "gpu/resources.h"
#include "render/draw/draw_kind.h"
#include "render/draw/map_depths.h"
#include "render/draw/patch_lists.h"
#include "render/draw/patch_passes.h"
#include "render/snow/snow_patches.h"

namespace snowbough::render {

/// A receiver on the GPU: uploaded once, but for its pose and its map.
struct SnowBuffers : PatchSource {
  /// `base_color`: linear; w: 1 where the bare surface is drawn, 0 where others draw it.
  SnowBuffers(const SnowPatches& mesh, const glm::vec4& base_color);

  void set_pose(const SnowPatches& mesh);
  /// Height map in metres, R32F, row 0 = v 0, below 0 on the back; linear filtering.
  void set_map(std::shared_ptr<const gpu::Texture> heights);

  std::vector<std::string> defines(DrawKind kind) const override;
  void bind_classify(gpu::Program& program) const override;
  void bind_plain(gpu::Program& program, DrawKind kind) const override;
  void bind_tessellated(gpu::Program& program, DrawKind kind) const override;

  int32_t vertex_count = 0;
  int32_t edge_count = 0;
  int32_t patch_count = 0;
  glm::vec4 color;
  gpu::Buffer vertices;
  gpu::Buffer vertex_corners;
  gpu::Buffer corner_normals;
  gpu::Buffer edges;
  gpu::Buffer edge_bends;
  gpu::Buffer patches;
  gpu::Buffer points;
  gpu::Buffer tile_depths;
  gpu::Buffer patch_depths;
  gpu::Buffer edge_levels;
  /// Never null.
  std::shared_ptr<const gpu::Texture> map;
  /// Whether patch_depths are not those of the map, and points not those of map and pose.
  bool map_is_new = true;
  bool pose_is_new = true;
};

/// The passes of a receiver, in the order of a frame: lay, edge_levels, then for the sun's picture
/// and the camera's those of `patches`. `view` holds a TreeView. Nothing is read back. GPU thread.
///
/// Method: D. T. Reynolds, PhD thesis, University of East Anglia, 2014, section 4.2.2.
class SnowPasses {
 public:
  /// Lays the map's snow on the vertices, where map or pose have changed.
  void lay(SnowBuffers& mesh);
  /// The tessellation level of each edge.
  void edge_levels(SnowBuffers& mesh, const gpu::Buffer& view);

  /// A plain patch is a triangle.
  PatchPasses patches{"snow", 3};

 private:
  void find_depths(SnowBuffers& mesh);

  MapDepths map_depths_;
  gpu::Program depths_{{"snow_depths.comp.glsl"}};
  gpu::Program vertices_{{"snow_vertices.comp.glsl"}};
  gpu::Program edges_{{"snow_edges.comp.glsl"}};
};

}  // namespace snowbough::render
