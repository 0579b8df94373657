#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "render/data/sources.h"
#include "render/data/view.h"
#include "render/draw/mesh_passes.h"
#include "render/tree/scene_tree.h"
#include "render/tree/tree_patches.h"

namespace snowbough::render {

/// The trees and meshes of a renderer. All functions run on the GPU thread and have the same
/// meaning as Renderer's.
class SceneObjects {
 public:
  /// `most_bytes`: greatest size of a buffer of trees.
  explicit SceneObjects(int64_t most_bytes = largest_block());

  void add_tree(const std::string& name, const TreePatches& patches, const TreeLook& look);
  void share_tree(const std::string& name, const std::string& tree);
  void set_leaves(const std::string& tree, const LeafSource& leaves);
  void set_bark(const std::string& tree, const BarkSource& bark);
  void set_pose(const std::string& tree, const std::vector<glm::mat4>& matrices);
  void set_snow(const std::string& tree, const TreeSnow& snow);
  void share_snow(const std::string& tree, const gpu::Texture& heights, const SnowLook& look);
  void add_mesh(const std::string& name, const MeshSource& source);
  void set_instances(const std::string& name, const std::vector<glm::mat4>& matrices);
  void set_mesh_snow(const std::string& mesh, const MeshSnow& snow);
  void remove(const std::string& name);

  const std::map<std::string, std::unique_ptr<SceneTree>>& trees() const { return trees_; }
  const std::map<std::string, std::unique_ptr<MeshBuffers>>& meshes() const { return meshes_; }
  /// @throws std::invalid_argument if there is no tree of that name.
  SceneTree& tree(const std::string& name) const;
  /// All trees, in the order of drawing.
  std::vector<const SceneTree*> drawn_trees() const;
  TreeShared& tree_data() const { return *tree_data_; }
  int64_t most_bytes() const { return most_bytes_; }
  Bounds bounds() const;
  /// Counts changes to shadow casters.
  uint64_t revision() const { return revision_; }

 private:
  SceneTree& tree_with_snow_uvs(const std::string& name) const;
  MeshBuffers& mesh(const std::string& name) const;
  void require_new(const std::string& name) const;

  int64_t most_bytes_;
  int32_t next_number_ = 0;
  /// Destroyed after the trees.
  std::unique_ptr<TreeShared> tree_data_;
  std::vector<std::weak_ptr<TreeStore>> stores_;
  std::map<std::string, std::unique_ptr<SceneTree>> trees_;
  std::map<std::string, std::unique_ptr<MeshBuffers>> meshes_;
  uint64_t revision_ = 0;
};

}  // namespace snowbough::render
