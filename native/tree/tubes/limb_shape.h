#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "tree/surface/frames.h"
#include "tree/surface/surface.h"
#include "tree/tubes/limb_curve.h"

namespace snowbough::tree {

/// A limb as a round tube along a smooth curve, row by row of its strip: `v` is the fraction of the
/// distance, along the branch's own centreline, from ring `row` to ring `row + 1`. Where the base
/// moved or narrowed the strip's rings relative to the straight segments, the tube is offset and
/// scaled in the same way.
class LimbShape {
 public:
  /// @param path  the branch's own, from limb_paths; before, after, thin_stray: see LimbCurve.
  LimbShape(const LimbPath& path, const LimbSurface& limb, const std::vector<glm::dvec3>& vertices,
            const glm::dvec3& before, const glm::dvec3& after, double thin_stray);

  glm::dvec3 centre(size_t row, double v) const;
  /// Radius of the circle with the limb's area there.
  double radius(size_t row, double v) const;
  /// Directions of corners 0 and 1 of the square ring for a limb along `tangent`: the frames of the
  /// rings before and after, rotated as little as possible.
  Frame frame(size_t row, double v, const glm::dvec3& tangent) const;
  /// Maximum angle in radians between the sides of the limb's hole and those of its first own ring,
  /// around the limb; 0 without a hole.
  double hole_twist() const { return hole_twist_; }
  /// Fractions of a row, ascending, at which the centreline has joints between its two rings.
  std::vector<double> joints(size_t row) const;
  size_t row_count() const { return rings_.size() - 1; }

 private:
  struct RingShape {
    double length = 0.0;
    glm::dvec3 offset{0.0};
    double corner_offset = 0.0;
    double corner = 0.0;
    Frame frame;
  };

  double length_at(size_t row, double v) const;

  LimbCurve curve_;
  std::vector<RingShape> rings_;
  double hole_twist_ = 0.0;
};

/// The shapes of all limbs. A child that continues its parent joins it smoothly.
std::vector<LimbShape> limb_shapes(const Surface& surface, const std::vector<LimbPath>& paths,
                                   const std::vector<int32_t>& parents, double thin_stray);

/// The hole from which a limb grows: its corners on one side of a row of the parent, as fractions
/// of the side and of the row.
struct HolePlace {
  int32_t parent = -1;
  int32_t row = 0, side = 0;
  bool inset = false;
  std::array<glm::dvec2, 4> corners = {glm::dvec2(0, 0), glm::dvec2(1, 0), glm::dvec2(1, 1),
                                       glm::dvec2(0, 1)};
};

/// The place of a child's hole. Corners are placed by angle, not by length: the middle third of a
/// flat side is narrower on a round one.
HolePlace hole_place(const Surface& surface, const Junction& junction);

}  // namespace snowbough::tree
