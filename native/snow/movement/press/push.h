#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <utility>
#include <vector>

#include "snow/movement/repose/links.h"
#include "snow/movement/repose/repose.h"
#include "snow/scene/scene_object.h"

namespace snowbough::snow {

/// A receiver while objects press its snow. Texels are indices in its table.
struct PressedMap {
  /// Of the object.
  size_t number = 0;
  const SceneObject* object = nullptr;
  const ReposeLinks* links = nullptr;
  const BareTexels* bare = nullptr;
  /// World positions of the texels in metres.
  const std::vector<glm::vec3>* points = nullptr;
  std::vector<float>* height = nullptr;
  /// By texel: its number among those under the object, ascending, in this part; -1: it is free.
  const std::vector<int32_t>* numbers = nullptr;

  int32_t number_of(int32_t texel) const { return (*numbers)[static_cast<size_t>(texel)]; }
  bool is_covered(int32_t texel) const { return number_of(texel) >= 0; }
  int32_t place(int32_t texel) const { return object->table->texel[static_cast<size_t>(texel)]; }
  float& height_at(int32_t texel) const { return (*height)[static_cast<size_t>(place(texel))]; }
  double area(int32_t texel) const {
    return static_cast<double>(bare->area[static_cast<size_t>(texel)]);
  }
  glm::dvec3 point(int32_t texel) const {
    return glm::dvec3((*points)[static_cast<size_t>(texel)]);
  }
  /// The side on which snow lies, or comes to lie: -1 on the back.
  double side(int32_t texel) const {
    return side(height_at(texel), bare->up[static_cast<size_t>(texel)]);
  }
  static double side(float height, float up) {
    return height < 0.0f || (height == 0.0f && up < 0.0f) ? -1.0 : 1.0;
  }
  /// Whether snow can lie on a texel.
  bool is_ground(int32_t texel) const;
  /// Adds units of kPushUnit.
  void add(int32_t texel, int64_t units) const;
};

/// Volume in m3 of the unit in which snow is pushed: 2^-44.
inline constexpr double kPushUnit = 1.0 / 17592186044416.0;

/// Snow that an object pushes away from a texel, in units.
struct PushedSnow {
  int32_t texel = 0;
  int64_t units = 0;
  /// Horizontal part of the unit vector of the object's motion there.
  glm::dvec3 way{0.0};
};

/// Moves pushed snow. Each texel's snow goes to the nearest texel that the object does not cover,
/// along the links of the surface, with a shorter way along the object's motion than against it: a
/// foot pushes to all sides, a blade ahead. Then it spreads over `radius` metres; or, if `slope` is
/// over 0, it piles up (pile_ahead). Never under the object.
/// Returns the texels that received any. `covered`: the texels under the object, ascending, with
/// those of `pushed`, ascending, among them. `kept`: units for which there is no other place.
std::vector<int32_t> spread_pushed(const PressedMap& map, const std::vector<int32_t>& covered,
                                   const std::vector<PushedSnow>& pushed, double radius,
                                   double slope, int64_t& kept);

}  // namespace snowbough::snow
