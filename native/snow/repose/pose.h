#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

namespace snowbough::snow {

/// An object's pose as far as it matters to repose: heights, and level distances. Where the object
/// has only moved and turned since its rest pose, that is a direction, the one that is up, as the
/// rest pose has it: while an object turns about the vertical, or is carried along, nothing
/// changes. What comes of a pose does not depend on the poses before.
class ReposePose {
 public:
  /// Takes the first `count` of `positions`, which must live until the next call. `rest`: the same
  /// of the rest pose, or empty. Returns whether the pose is another than the last.
  bool set(const std::vector<glm::vec3>& rest, const std::vector<glm::vec3>& positions,
           int32_t count);

  /// The vertices: up to where they lie and are turned to about the vertical.
  const std::vector<glm::vec3>& positions() const { return is_rigid_ ? turned_ : *positions_; }

 private:
  bool find_up(const std::vector<glm::vec3>& rest, const std::vector<glm::vec3>& positions,
               size_t count, glm::dvec3& up);

  const std::vector<glm::vec3>* positions_ = nullptr;
  bool is_rigid_ = false;
  /// In the rest pose.
  glm::dvec3 up_{0.0};
  std::vector<glm::vec3> turned_;
  /// Vertices of the rest pose that lie far apart.
  std::array<size_t, 3> corners_{};
  bool has_corners_ = false;
};

}  // namespace snowbough::snow
