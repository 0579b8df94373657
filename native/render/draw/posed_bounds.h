#pragma once

#include <array>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <span>
#include <vector>

namespace snowbough::render {

/// A box along the axes; empty until something is put in.
struct Box {
  glm::vec3 low{std::numeric_limits<float>::max()};
  glm::vec3 high{std::numeric_limits<float>::lowest()};

  bool is_empty() const { return low.x > high.x; }
  glm::vec3 centre() const { return 0.5f * (low + high); }
  glm::vec3 size() const { return high - low; }
  void add(const glm::vec3& point);
  void add(const Box& other);
  /// The box around this one's corners, moved.
  Box moved(const glm::mat4& matrix) const;
};

/// Where a thing that hangs on bones may be in a pose: skinned points lie within the boxes around
/// what each bone carries, moved with the bone.
class PosedBounds {
 public:
  explicit PosedBounds(int32_t bones) : rest_(static_cast<size_t>(bones)) {}

  /// A point of the rest pose that hangs on a bone.
  void add(int32_t bone, const glm::vec3& point) { rest_[bone].add(point); }
  Box at_rest() const;
  /// `matrices`: one a bone, from the rest pose to the pose.
  Box posed(std::span<const glm::mat4> matrices) const;

 private:
  std::vector<Box> rest_;
};

}  // namespace snowbough::render
