#include "snow/movement/rays/scene_rays.h"

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "snow/texels/open_sheets.h"

namespace snowbough::snow {
namespace {

/// Whether a ray may meet a box nearer than `most`.
bool may_meet(const Bounds& bounds, const glm::dvec3& from, const glm::dvec3& direction,
              double most) {
  double enters = 0.0;
  double leaves = most;
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0.0) {
      if (from[axis] < bounds.low[axis] || from[axis] > bounds.high[axis]) return false;
      continue;
    }
    const double a = (bounds.low[axis] - from[axis]) / direction[axis];
    const double b = (bounds.high[axis] - from[axis]) / direction[axis];
    enters = std::max(enters, std::min(a, b));
    leaves = std::min(leaves, std::max(a, b));
  }
  // The factor covers rounding, as in the trees.
  return enters <= leaves * (1.0 + 1e-12);
}

}  // namespace

void SceneRays::lay_out(const std::vector<const SceneObject*>& objects) {
  objects_ = objects;
  items_.clear();
  for (size_t i = 0; i < objects.size(); ++i) items_.push_back(std::make_unique<Item>());
}

void SceneRays::forget_pose(size_t object) {
  items_[object]->is_current = false;
}

const base::TriangleTree& SceneRays::tree_of(size_t object) const {
  Item& item = *items_[object];
  const std::scoped_lock lock(item.mutex);
  if (item.is_current) return *item.tree;
  const SceneObject& own = *objects_[object];
  if (item.tree == nullptr) {
    const std::vector<int32_t>& corners = own.description.topology.triangles;
    item.triangles.resize(corners.size() / 3);
    for (size_t t = 0; t < item.triangles.size(); ++t) {
      item.triangles[t] = {corners[3 * t], corners[3 * t + 1], corners[3 * t + 2]};
    }
    const std::vector<glm::vec3>& rest = own.description.rest;
    item.is_open = find_open_sheets(corners, rest.empty() ? own.positions : rest);
    item.tree = std::make_unique<base::TriangleTree>(
        own.positions, item.triangles,
        std::vector<int32_t>{0, static_cast<int32_t>(item.triangles.size())});
  } else {
    item.tree->refit(own.positions, item.triangles);
  }
  item.is_current = true;
  return *item.tree;
}

SurfaceHit SceneRays::first_along(const glm::dvec3& from, const glm::dvec3& direction, double least,
                                  double most) const {
  SurfaceHit hit;
  hit.distance = most;
  for (size_t i = 0; i < objects_.size(); ++i) {
    const ObjectDescription& description = objects_[i]->description;
    if (!(description.receive || description.occlude) || objects_[i]->positions.empty() ||
        objects_[i]->hidden) {
      continue;
    }
    if (!may_meet(objects_[i]->bounds, from, direction, hit.distance)) continue;
    const base::TriangleTree::Hit own =
        tree_of(i).first_along(0, from, direction, least, hit.distance);
    if (own.triangle < 0) continue;
    hit.object = static_cast<int32_t>(i);
    hit.triangle = own.triangle;
    hit.distance = own.distance;
  }
  if (hit.object < 0) return {};
  const auto object = static_cast<size_t>(hit.object);
  const auto triangle = static_cast<size_t>(hit.triangle);
  const std::array<int32_t, 3>& corners = items_[object]->triangles[triangle];
  const auto corner = [&](size_t k) {
    return glm::dvec3(objects_[object]->positions[static_cast<size_t>(corners[k])]);
  };
  const glm::dvec3 b = corner(1) - corner(0);
  const glm::dvec3 c = corner(2) - corner(0);
  const glm::dvec3 normal = glm::cross(b, c);
  const double square = glm::dot(normal, normal);
  const glm::dvec3 at = from + hit.distance * direction - corner(0);
  hit.up = square > 0.0 ? normal.z / std::sqrt(square) : 0.0;
  if (square > 0.0) {
    hit.weights = glm::vec2(glm::dot(glm::cross(at, c), normal) / square,
                            glm::dot(glm::cross(b, at), normal) / square);
  }
  hit.is_open = items_[object]->is_open[triangle] != 0;
  return hit;
}

}  // namespace snowbough::snow
