#pragma once

#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>
#include <vector>

namespace snowbough::snow {

/// The motion of an object's vertices between two steps: if it is rigid, a turn about the mean of
/// the vertices with its straight way, so that a rolling wheel stays round; otherwise each vertex
/// moves straight.
class PresserMotion {
 public:
  /// Both poses must live until the last call. `from` may be empty, or have another number of
  /// vertices: the object stays at `to`.
  PresserMotion(const std::vector<glm::vec3>& from, const std::vector<glm::vec3>& to);

  /// The longest way of a vertex in metres, straight.
  double travel() const { return travel_; }
  /// The pose at a share of the way, 0 to 1.
  void pose(double share, std::vector<glm::vec3>& points) const;

 private:
  bool find_turn();

  const std::vector<glm::vec3>* from_;
  const std::vector<glm::vec3>* to_;
  double travel_ = 0.0;
  bool is_rigid_ = false;
  glm::dquat turn_{1.0, 0.0, 0.0, 0.0};
  glm::dvec3 middle_{0.0};
  glm::dvec3 middle_after_{0.0};
};

}  // namespace snowbough::snow
