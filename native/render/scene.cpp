#include "render/scene.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <stdexcept>

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

MeshBuffers& Scene::mesh(const std::string& name) const {
  const auto found = meshes_.find(name);
  if (found == meshes_.end()) throw std::invalid_argument("there is no mesh '" + name + "'");
  return *found->second;
}

void Scene::require_new(const std::string& name) const {
  if (trees_.count(name) + meshes_.count(name) != 0) {
    throw std::invalid_argument("'" + name + "' already exists: remove it first");
  }
}

void Scene::add_mesh(const std::string& name, const MeshSource& source) {
  ++revision_;
  require_new(name);
  meshes_[name] = std::make_unique<MeshBuffers>(source);
}

void Scene::set_places(const std::string& name, const std::vector<glm::mat4>& matrices) {
  ++revision_;
  mesh(name).set_places(matrices);
}

void Scene::set_mesh_snow(const std::string& name, const MeshSnow& snow) {
  mesh(name).set_snow(snow);
}

void Scene::remove(const std::string& name) {
  ++revision_;
  if (trees_.erase(name) + meshes_.erase(name) == 0) {
    throw std::invalid_argument("there is no tree or mesh named '" + name + "'");
  }
}

Bounds Scene::bounds() const {
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
