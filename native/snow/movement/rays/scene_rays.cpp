#include "snow/movement/rays/scene_rays.h"

#include <algorithm>

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
  for (const SceneObject* object : objects) {
    items_.push_back(std::make_unique<ObjectRays>(*object));
    items_.back()->set_pose(object->positions);
  }
}

SurfaceHit SceneRays::first_along(const glm::dvec3& from, const glm::dvec3& direction, double least,
                                  double most, const SceneObject* except) const {
  base::TriangleTree::Hit hit;
  hit.distance = most;
  size_t object = 0;
  for (size_t i = 0; i < objects_.size(); ++i) {
    const ObjectDescription& description = objects_[i]->description;
    if (!(description.receive || description.occlude) || objects_[i]->positions.empty() ||
        objects_[i]->hidden || objects_[i] == except) {
      continue;
    }
    if (!may_meet(objects_[i]->bounds, from, direction, hit.distance)) continue;
    const base::TriangleTree::Hit own =
        items_[i]->first_along(from, direction, least, hit.distance);
    if (own.triangle < 0) continue;
    hit = own;
    object = i;
  }
  if (hit.triangle < 0) return {};
  return items_[object]->surface_at(hit, static_cast<int32_t>(object), from, direction);
}

}  // namespace snowbough::snow
