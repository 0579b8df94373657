#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "render/draw/mesh_passes.h"
#include "render/draw/posed_bounds.h"
#include "render/renderer.h"
#include "render/tree/leaf_passes.h"
#include "render/tree/tree_passes.h"

namespace snowbough::render {

/// A tree with all its data on the GPU.
struct SceneTree {
  SceneTree(const TreePatches& patches, const TreeLook& its_look);

  TreeBuffers buffers;
  std::optional<LeafBuffers> leaves;
  TreeLook look;
  int32_t bone_count = 0;
  int32_t levels = 1;
  bool has_snow_places = false;
  float largest_area = 0.0f;
  PosedBounds rest;
  Box bounds;
  /// Edges of each quad.
  std::vector<glm::ivec4> patch_edges;
  /// Each holds one TreeView.
  gpu::Buffer camera_view;
  gpu::Buffer sun_view;
};

/// The trees and meshes of a renderer. All functions run on the GPU thread and have the same
/// meaning as Renderer's.
class SceneObjects {
 public:
  void add_tree(const std::string& name, const TreePatches& patches, const TreeLook& look);
  void set_leaves(const std::string& tree, const LeafSource& leaves);
  void set_bark(const std::string& tree, const BarkSource& bark);
  void set_pose(const std::string& tree, const std::vector<glm::mat4>& matrices);
  void set_snow(const std::string& tree, const TreeSnow& snow);
  void share_snow(const std::string& tree, std::shared_ptr<const gpu::Texture> heights,
                  const SnowDepths& depths);
  void add_mesh(const std::string& name, const MeshSource& source);
  void set_places(const std::string& mesh, const std::vector<glm::mat4>& matrices);
  void set_mesh_snow(const std::string& mesh, const MeshSnow& snow);
  void remove(const std::string& name);

  const std::map<std::string, std::unique_ptr<SceneTree>>& trees() const { return trees_; }
  const std::map<std::string, std::unique_ptr<MeshBuffers>>& meshes() const { return meshes_; }
  /// @throws std::invalid_argument if there is no tree of that name.
  SceneTree& tree(const std::string& name) const;
  Bounds bounds() const;
  /// Counts changes to shadow casters.
  uint64_t revision() const { return revision_; }

 private:
  SceneTree& tree_with_places(const std::string& name) const;
  MeshBuffers& mesh(const std::string& name) const;
  void require_new(const std::string& name) const;

  std::map<std::string, std::unique_ptr<SceneTree>> trees_;
  std::map<std::string, std::unique_ptr<MeshBuffers>> meshes_;
  uint64_t revision_ = 0;
};

}  // namespace snowbough::render
