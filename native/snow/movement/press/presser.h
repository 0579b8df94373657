#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "base/triangle_tree.h"
#include "snow/movement/press/motion.h"
#include "snow/movement/press/outline.h"
#include "snow/scene/scene_object.h"

namespace snowbough::snow {

/// How far above a texel an object is.
struct Clearance {
  /// Metres along the ray; 0 inside the object, infinite if it is not above.
  double metres = std::numeric_limits<double>::infinity();
  /// The direction in which the object moves where it touches, or 0.
  glm::dvec3 moves{0.0};
};

/// An object that presses snow, between two steps.
class Presser {
 public:
  explicit Presser(const SceneObject& object);

  /// Begins a step, in which the object moves from `last` to its positions; both must stay until
  /// the step ends.
  void begin(const std::vector<glm::vec3>& last);
  /// The longest straight way in metres of a vertex that may pass a box on it.
  double travel(const Bounds& box) const;
  /// How thick the object is along its motion, where it moves ahead in a box: at the thinnest of
  /// some of its faces, in metres; 0 where a sheet has no inside, infinite if there are none.
  double thinnest(const Bounds& box);
  /// A box around the object in the whole step, and at the last call of `move_to`.
  const Bounds& swept() const { return swept_; }
  const Bounds& bounds() const { return bounds_; }

  /// Moves it to part `number` of `count` of its way.
  void move_to(int number, int count);

  /// Whether any of the object may be in a box; false only if none is.
  bool may_reach(const Bounds& box) const { return outline_.may_reach(box); }
  /// From a point along the unit vector `direction`, if it is less than `most` metres. Callable
  /// from several threads.
  Clearance clearance(const glm::dvec3& from, const glm::dvec3& direction, double most) const;

 private:
  void update_tree();

  const SceneObject* object_;
  std::vector<std::array<int32_t, 3>> triangles_;
  /// Per triangle: whether it belongs to a surface without an inside.
  std::vector<uint8_t> is_open_;
  std::optional<PresserMotion> motion_;
  const std::vector<glm::vec3>* last_ = nullptr;
  std::unique_ptr<base::TriangleTree> tree_;
  Outline outline_;
  /// The pose, and the one before in the same step.
  std::vector<glm::vec3> pose_, before_;
  Bounds swept_, bounds_;
};

}  // namespace snowbough::snow
