#pragma once

#include <glm/vec3.hpp>
#include <limits>
#include <memory>
#include <vector>

#include "snow/movement/rays/object_rays.h"
#include "snow/scene/scene_object.h"

namespace snowbough::snow {

/// Rays against all surfaces of a scene in the current pose, whether they receive snow or only
/// block it. The result for a pose does not depend on earlier poses. Without the tree of boxes, a
/// bake of 31 moving balls with landing takes 1.21 times as long, of still ones 1.08 times.
class SceneRays {
 public:
  /// `objects` must live until the next call.
  void lay_out(const std::vector<const SceneObject*>& objects);
  /// Call it when an object's positions have changed.
  void forget_pose(size_t object);

  /// The first surface at a distance over `least` and under `most` metres from `from` along the
  /// unit vector `direction`, except one object's. Callable from several threads.
  RayHit first_along(const glm::dvec3& from, const glm::dvec3& direction, double least,
                     double most = std::numeric_limits<double>::infinity(),
                     const SceneObject* except = nullptr) const;

  const std::vector<const SceneObject*>& objects() const { return objects_; }

 private:
  void split(size_t begin, size_t size);
  Bounds box_of(size_t object) const;
  void join(size_t node);

  std::vector<const SceneObject*> objects_;
  std::vector<std::unique_ptr<ObjectRays>> items_;
  /// A full binary tree of boxes around the objects. Node 1 is its root, and 2 n and 2 n + 1 are
  /// the children of node n; leaf k, node leaves_ + k, is the object order_[k]. The order is that
  /// of the places when lay_out was called: objects that go far make rays slower, not wrong.
  size_t leaves_ = 0;
  std::vector<Bounds> boxes_;
  std::vector<size_t> order_;
  std::vector<size_t> leaf_of_;
};

}  // namespace snowbough::snow
