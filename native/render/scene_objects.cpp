#include "render/scene_objects.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <stdexcept>
#include <utility>

#include "render/draw/matrix_rows.h"

namespace snowbough::render {
namespace {

using glm::vec3;
using glm::vec4;

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

SceneTree::SceneTree(const TreePatches& patches, const TreeLook& its_look)
    : buffers(patches),
      look(its_look),
      bone_count(patches.bone_count),
      levels(patches.levels),
      has_snow_places(patches.has_snow_places),
      largest_area(patches.largest_area),
      rest(patches.bone_count),
      camera_view(sizeof(shared::TreeView)),
      sun_view(sizeof(shared::TreeView)) {
  for (const shared::TreePatch& patch : patches.patches) {
    patch_edges.push_back(patch.edges);
  }
  for (const shared::TreeVertex& vertex : patches.vertices) {
    for (int k = 0; k < 4; ++k) {
      if (vertex.weights[k] > 0.0f) rest.add(vertex.bones[k], vec3(vertex.position));
    }
  }
  bounds = rest.at_rest();
}

SceneTree& SceneObjects::tree(const std::string& name) const {
  const auto found = trees_.find(name);
  if (found == trees_.end()) throw std::invalid_argument("there is no tree '" + name + "'");
  return *found->second;
}

void SceneObjects::add_tree(const std::string& name, const TreePatches& patches,
                            const TreeLook& look) {
  ++revision_;
  require_new(name);
  trees_[name] = std::make_unique<SceneTree>(patches, look);
}

void SceneObjects::set_leaves(const std::string& name, const LeafSource& leaves) {
  ++revision_;
  SceneTree& of = tree(name);
  LeafBuffers made(leaves, of.bone_count);
  of.leaves.reset();
  of.leaves.emplace(std::move(made));
  for (size_t i = 0; i < leaves.positions.size(); ++i) {
    of.rest.add(leaves.bone[i / 3], leaves.positions[i]);
    of.bounds.add(leaves.positions[i]);
  }
}

void SceneObjects::set_bark(const std::string& name, const BarkSource& bark) {
  SceneTree& of = tree(name);
  of.buffers.images.emplace(bark, of.patch_edges.size());
}

void SceneObjects::set_pose(const std::string& name, const std::vector<glm::mat4>& matrices) {
  ++revision_;
  SceneTree& of = tree(name);
  if (matrices.size() != static_cast<size_t>(of.bone_count)) {
    throw std::invalid_argument("tree '" + name + "' needs " + std::to_string(of.bone_count) +
                                " bone matrices, not " + std::to_string(matrices.size()));
  }
  const std::vector<vec4> rows = matrix_rows(matrices);
  of.buffers.bones.write(0, static_cast<int64_t>(rows.size() * sizeof(vec4)), rows.data());
  of.bounds = of.rest.posed(matrices);
}

SceneTree& SceneObjects::tree_with_places(const std::string& name) const {
  SceneTree& of = tree(name);
  if (!of.has_snow_places) {
    throw std::invalid_argument("tree '" + name +
                                "' has no snow map coordinates: add it with snow_uv");
  }
  return of;
}

void SceneObjects::set_snow(const std::string& name, const TreeSnow& snow) {
  ++revision_;
  SceneTree& of = tree_with_places(name);
  // Trees without snow use the shaders without snow.
  const bool is_bare = std::all_of(snow.values.begin(), snow.values.end(),
                                   [](float height) { return height == 0.0f; });
  if (is_bare) return of.buffers.set_snow(nullptr, snow.depths);
  auto map = std::make_shared<gpu::Texture>(GL_R32F, snow.width, snow.height, 0, GL_LINEAR);
  map->write(0, GL_RED, GL_FLOAT, snow.values.data());
  of.buffers.set_snow(std::move(map), snow.depths);
}

void SceneObjects::share_snow(const std::string& name, std::shared_ptr<const gpu::Texture> heights,
                              const SnowDepths& depths) {
  ++revision_;
  tree_with_places(name).buffers.set_snow(std::move(heights), depths);
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

void SceneObjects::set_places(const std::string& name, const std::vector<glm::mat4>& matrices) {
  ++revision_;
  mesh(name).set_places(matrices);
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
  for (const auto& [name, of] : trees_) casters.add(of->bounds);
  for (const auto& [name, of] : meshes_) add(of->bounds());
  if (casters.is_empty()) casters = all;
  if (casters.is_empty()) return {vec3(0.0f), 10.0f, 10.0f};
  const float radius = std::max(kRoomToMove * 0.5f * glm::length(casters.size()), 1e-6f);
  return {casters.centre(), radius, radius};
}

}  // namespace snowbough::render
