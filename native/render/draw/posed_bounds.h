#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <span>
#include <vector>

namespace snowbough::render {

/// An axis-aligned box; empty until a point is added.
struct Box {
  glm::vec3 low{std::numeric_limits<float>::max()};
  glm::vec3 high{std::numeric_limits<float>::lowest()};

  bool is_empty() const { return low.x > high.x; }
  glm::vec3 centre() const { return 0.5f * (low + high); }
  glm::vec3 size() const { return high - low; }
  void add(const glm::vec3& point);
  void add(const Box& other);
  /// The axis-aligned box around this box's transformed corners.
  Box moved(const glm::mat4& matrix) const;
};

/// Bounds of a skinned object in a pose. Skinned points lie within the transformed boxes of the
/// bones' rest points.
class PosedBounds {
 public:
  explicit PosedBounds(int32_t bones) : rest_(static_cast<size_t>(bones)) {}

  /// Adds a rest point that a bone moves.
  void add(int32_t bone, const glm::vec3& point) { rest_[bone].add(point); }
  /// `matrices`: one per bone, from the rest pose to the current pose.
  Box posed(std::span<const glm::mat4> matrices) const;

 private:
  std::vector<Box> rest_;
};

}  // namespace snowbough::render
