#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <memory>
#include <mutex>
#include <vector>

#include "base/triangle_tree.h"
#include "snow/scene/scene_object.h"

namespace snowbough::snow {

/// The first surface on a ray.
struct SurfaceHit {
  /// Index of the object, sorted by name; -1: the ray hits nothing.
  int32_t object = -1;
  int32_t triangle = -1;
  double distance = std::numeric_limits<double>::infinity();
  /// Upward part of the triangle's normal.
  double up = 0.0;
  /// Weights of the triangle's second and third corner.
  glm::vec2 weights{0.0f};
  /// Whether it belongs to a surface without an inside (find_open_sheets).
  bool is_open = false;

  /// Whether the ray leaves a body here. `down`: it runs downwards, else upwards.
  bool is_inside(bool down) const {
    return object >= 0 && !is_open && (down ? up < 0.0 : up > 0.0);
  }
};

/// Rays against all surfaces of a scene in the current pose, whether they receive snow or only
/// block it. One tree per object, built when a ray first comes near it, refitted after the object
/// has moved. The result for a pose does not depend on earlier poses.
class SceneRays {
 public:
  /// `objects` must live until the next call.
  void lay_out(const std::vector<const SceneObject*>& objects);
  /// Call it when an object's positions have changed.
  void forget_pose(size_t object);

  /// The first surface at a distance over `least` and under `most` metres from `from` along the
  /// unit vector `direction`. Callable from several threads.
  SurfaceHit first_along(const glm::dvec3& from, const glm::dvec3& direction, double least,
                         double most = std::numeric_limits<double>::infinity()) const;

  const std::vector<const SceneObject*>& objects() const { return objects_; }

 private:
  struct Item {
    std::mutex mutex;
    /// Null until a ray needs it.
    std::unique_ptr<base::TriangleTree> tree;
    bool is_current = false;
    std::vector<std::array<int32_t, 3>> triangles;
    std::vector<uint8_t> is_open;
  };
  const base::TriangleTree& tree_of(size_t object) const;

  std::vector<const SceneObject*> objects_;
  mutable std::vector<std::unique_ptr<Item>> items_;
};

}  // namespace snowbough::snow
