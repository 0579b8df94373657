#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "tree/skeleton/skeleton.h"

namespace snowbough::tree {

/// A place near a limb's axis: the nearest point of the axis, the axis direction, and the offset.
struct AxisPlace {
  glm::dvec3 axis{0.0};
  /// Unit length.
  glm::dvec3 along{0.0, 0.0, 1.0};
  /// Offset from the axis to the place, perpendicular to it, and the part along it (beyond its
  /// ends).
  glm::dvec3 across{0.0};
  double beyond = 0.0;
};

/// The position of a place on the original's triangles.
struct UnrolledPlace {
  int32_t triangle = -1;
  glm::vec2 uv{0.0f};
};

/// The triangles of the original wood, unrolled around their limbs' axes: a place maps to the
/// triangle in the same direction from the axis and at the same height along it, and interpolates
/// its corners' texture coordinates by angle and height. A three-sided prism then acts as the round
/// limb that it represents, whose texture runs evenly around it, as on the rebuilt limb.
///
/// A walk goes from triangle to triangle over common edges to the one that contains the place. It
/// crosses seams where the coordinates differ by integers (a tiling texture shows no seam there)
/// and carries the difference along; at other seams it stops and uses the nearest triangle on this
/// side.
class Unrolled {
 public:
  explicit Unrolled(const OriginalWood& wood);

  /// @param from start triangle; the coordinates continue from there.
  UnrolledPlace walk(const AxisPlace& place, int32_t from) const;

 private:
  /// The neighbour across an edge, from corner k to k + 1.
  struct Across {
    /// -1 at an open edge.
    int32_t triangle = -1;
    /// Added to the neighbour's coordinates to continue this triangle's; only valid without a seam.
    glm::vec2 shift{0.0f};
    bool seam = false;
  };

  void join_edges(int32_t begin, int32_t end);
  Across across(int32_t t, int k, int32_t u, int l) const;

  const OriginalWood& wood_;
  std::vector<std::array<Across, 3>> across_;
};

}  // namespace snowbough::tree
