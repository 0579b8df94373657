#include "render/scene_objects.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <stdexcept>
#include <tuple>

namespace snowbough::render {
namespace {

using glm::vec3;

/// Margin of the sphere around the shadow casters, as a factor on its radius.
constexpr float kRoomToMove = 1.25f;

/// True if a box is flat like ground. Ground would enlarge the shadow map's area, but its own
/// shadows do not justify that.
bool is_flat(const Box& box) {
  constexpr float kFlat = 0.02f;
  const vec3 size = box.size();
  return size.z < kFlat * std::max(size.x, size.y);
}

}  // namespace

SceneObjects::SceneObjects(int64_t most_bytes)
    : most_bytes_(most_bytes), tree_data_(std::make_unique<TreeShared>(most_bytes)) {}

SceneTree& SceneObjects::tree(const std::string& name) const {
  const auto found = trees_.find(name);
  if (found == trees_.end()) throw std::invalid_argument("there is no tree '" + name + "'");
  return *found->second;
}

void SceneObjects::add_tree(const std::string& name, const TreePatches& patches,
                            const TreeLook& look) {
  ++revision_;
  require_new(name);
  std::shared_ptr<TreeStore> store;
  for (const std::weak_ptr<TreeStore>& known : stores_) {
    const std::shared_ptr<TreeStore> open = known.lock();
    if (store == nullptr && open != nullptr && open->has_room(patches)) store = open;
  }
  if (store == nullptr) {
    store = std::make_shared<TreeStore>(most_bytes_, next_number_++);
    std::erase_if(stores_, [](const auto& known) { return known.expired(); });
    stores_.push_back(store);
  }
  trees_[name] = std::make_unique<SceneTree>(
      *tree_data_, std::make_shared<TreeModel>(store, patches, look, next_number_++));
}

void SceneObjects::share_tree(const std::string& name, const std::string& of) {
  ++revision_;
  require_new(name);
  trees_[name] = std::make_unique<SceneTree>(*tree_data_, tree(of).model());
}

void SceneObjects::set_leaves(const std::string& name, const LeafSource& leaves) {
  ++revision_;
  const std::shared_ptr<TreeModel>& model = tree(name).model();
  model->set_leaves(leaves);
  for (const auto& [other, of] : trees_) {
    if (of->model() == model) of->find_bounds();
  }
}

void SceneObjects::set_bark(const std::string& name, const BarkSource& bark) {
  tree(name).model()->set_bark(bark);
}

void SceneObjects::set_pose(const std::string& name, const std::vector<glm::mat4>& matrices) {
  ++revision_;
  SceneTree& of = tree(name);
  const int32_t bones = of.model()->bone_count;
  if (matrices.size() != static_cast<size_t>(bones)) {
    throw std::invalid_argument("tree '" + name + "' needs " + std::to_string(bones) +
                                " bone matrices, not " + std::to_string(matrices.size()));
  }
  of.set_pose(matrices);
}

SceneTree& SceneObjects::tree_with_snow_uvs(const std::string& name) const {
  SceneTree& of = tree(name);
  if (!of.model()->has_snow_uvs) {
    throw std::invalid_argument("tree '" + name +
                                "' has no snow map coordinates: add it with snow_uv");
  }
  return of;
}

std::vector<const SceneTree*> SceneObjects::drawn_trees() const {
  std::vector<const SceneTree*> trees;
  for (const auto& [name, of] : trees_) trees.push_back(of.get());
  const auto key = [](const SceneTree* of) {
    const TreeModel& model = *of->model();
    return std::tuple(model.store->number, model.bark_images.has_value(), model.number);
  };
  std::stable_sort(trees.begin(), trees.end(),
                   [&](const SceneTree* a, const SceneTree* b) { return key(a) < key(b); });
  return trees;
}

void SceneObjects::set_snow(const std::string& name, const TreeSnow& snow) {
  ++revision_;
  SceneTree& of = tree_with_snow_uvs(name);
  // Trees without snow use the shaders without snow.
  const bool is_bare = std::all_of(snow.values.begin(), snow.values.end(),
                                   [](float height) { return height == 0.0f; });
  if (is_bare) return of.remove_snow();
  of.set_snow(snow.width, snow.height, snow.values.data(), snow.look);
}

void SceneObjects::share_snow(const std::string& name, const gpu::Texture& heights,
                              const SnowLook& look) {
  ++revision_;
  tree_with_snow_uvs(name).set_snow(heights, look);
}

MeshBuffers& SceneObjects::mesh(const std::string& name) const {
  const auto found = meshes_.find(name);
  if (found == meshes_.end()) throw std::invalid_argument("there is no mesh '" + name + "'");
  return *found->second;
}

void SceneObjects::require_new(const std::string& name) const {
  if (trees_.count(name) + meshes_.count(name) != 0) {
    throw std::invalid_argument("'" + name + "' already exists: remove it first");
  }
}

void SceneObjects::add_mesh(const std::string& name, const MeshSource& source) {
  ++revision_;
  require_new(name);
  meshes_[name] = std::make_unique<MeshBuffers>(source);
}

void SceneObjects::set_instances(const std::string& name, const std::vector<glm::mat4>& matrices) {
  ++revision_;
  const auto found = trees_.find(name);
  if (found != trees_.end()) return found->second->set_instances(matrices);
  mesh(name).set_instances(matrices);
}

void SceneObjects::set_mesh_snow(const std::string& name, const MeshSnow& snow) {
  mesh(name).set_snow(snow);
}

void SceneObjects::remove(const std::string& name) {
  ++revision_;
  if (trees_.erase(name) + meshes_.erase(name) == 0) {
    throw std::invalid_argument("there is no tree or mesh named '" + name + "'");
  }
}

Bounds SceneObjects::bounds() const {
  Box casters, all;
  const auto add = [&](const Box& box) {
    if (box.is_empty()) return;
    all.add(box);
    if (!is_flat(box)) casters.add(box);
  };
  for (const auto& [name, of] : trees_) casters.add(of->bounds());
  for (const auto& [name, of] : meshes_) add(of->bounds());
  if (casters.is_empty()) casters = all;
  if (casters.is_empty()) return {vec3(0.0f), 10.0f, 10.0f};
  const float radius = std::max(kRoomToMove * 0.5f * glm::length(casters.size()), 1e-6f);
  return {casters.centre(), radius, radius};
}

}  // namespace snowbough::render
