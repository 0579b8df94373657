#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "gpu/resources.h"
#include "render/data/sources.h"
#include "render/draw/arena.h"
#include "render/draw/posed_bounds.h"
#include "render/tree/tree_patches.h"

namespace snowbough::render {

/// The buffers of many trees' bases and leaves, so that one dispatch and one draw handles all of
/// them.
struct TreeStore {
  /// `most_bytes`: greatest size of a buffer; `number`: its number in the order of drawing.
  TreeStore(int64_t most_bytes, int32_t number);
  /// Also requires that the buffer of leaves is at most half full: leaves come after their tree.
  bool has_room(const TreePatches& tree) const;

  const int32_t number;
  Arena vertices;
  Arena sections;
  Arena edges;
  Arena patches;
  Arena vertex_snow;
  Arena bark_uvs;
  /// Elements of three corners.
  Arena leaf_triangles;
};

/// Leaves of one material.
struct LeafPart {
  int32_t first_triangle = 0;
  /// Of each triangle, ascending, see leaf_drop_point.
  std::vector<float> drop_points;
  glm::vec3 color{1.0f};
  gpu::Texture image;
};

/// A tree's base with its bark and leaves on the GPU. Trees that look the same share a model; each
/// has its own pose, instances and snow. GPU thread.
class TreeModel {
 public:
  /// @throws std::invalid_argument if the tree alone is too large for the store.
  TreeModel(std::shared_ptr<TreeStore> store, const TreePatches& tree, const TreeLook& look,
            int32_t number);
  ~TreeModel();
  TreeModel(const TreeModel&) = delete;
  TreeModel& operator=(const TreeModel&) = delete;

  /// @throws std::invalid_argument with the reason, as the functions of SceneObjects.
  void set_leaves(const LeafSource& leaves);
  void set_bark(const BarkSource& bark);

  /// The fields of an instance that are the model's.
  shared::TreeInstance instance() const;

  const std::shared_ptr<TreeStore> store;
  /// Its number in the order of drawing.
  const int32_t number;
  /// First vertex, edge, patch and section in the store.
  glm::ivec4 first{0};
  int32_t vertex_count = 0;
  int32_t edge_count = 0;
  int32_t section_count = 0;
  int32_t first_vertex_snow = 0;
  int32_t vertex_snow_count = 0;
  std::vector<int32_t> quads;
  std::vector<glm::ivec4> patch_edges;
  mutable DropOrder order;
  std::vector<int32_t> used_vertices;
  std::vector<int32_t> used_edges;
  int32_t bone_count = 0;
  int32_t branch_levels = 1;
  bool has_snow_uvs = false;
  float largest_area = 0.0f;
  TreeLook look;
  /// Greatest distance of the surface from the hull of the vertices, including bark (m).
  float bulge = 0.0f;
  /// The images of the bark, one layer per material; none: it has its own colours.
  std::optional<gpu::Texture> bark_images;
  int32_t first_bark_uv = 0;
  std::vector<LeafPart> leaves;
  PosedBounds rest;

  int32_t patch_count() const { return static_cast<int32_t>(quads.size()); }

 private:
  void remove_leaves();
};

}  // namespace snowbough::render
