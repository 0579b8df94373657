#pragma once

#include <array>
#include <atomic>
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
struct RayHit {
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

/// Rays against one object's surface, in poses that its owner sets. The tree is built when the
/// first ray comes, and refitted after a change of pose, which saves 2 % of a bake of 31 moving
/// balls and has no code of its own here. Callable from several threads, except set_pose.
class ObjectRays {
 public:
  /// `object` must outlive this.
  explicit ObjectRays(const SceneObject& object) : object_(&object) {}

  /// `positions`: at least one per vertex; they must live until the next call.
  void set_pose(const std::vector<glm::vec3>& positions) {
    positions_ = &positions;
    is_current_ = false;
  }
  /// As TriangleTree::first_along.
  base::TriangleTree::Hit first_along(const glm::dvec3& from, const glm::dvec3& direction,
                                      double least, double most);
  /// What a ray meets at a triangle of the last pose; `object`: the index to set.
  RayHit hit_at(const base::TriangleTree::Hit& hit, int32_t object, const glm::dvec3& from,
                const glm::dvec3& direction) const;

 private:
  void update();

  const SceneObject* object_;
  const std::vector<glm::vec3>* positions_ = nullptr;
  std::mutex mutex_;
  /// Null until a ray needs it.
  std::unique_ptr<base::TriangleTree> tree_;
  std::atomic<bool> is_current_ = false;
  std::vector<std::array<int32_t, 3>> triangles_;
  std::vector<uint8_t> is_open_;
};

}  // namespace snowbough::snow
