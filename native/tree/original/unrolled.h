#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "tree/skeleton/skeleton.h"

namespace snowbough::tree {

/// A place near a limb's axis: where the axis is nearest, which way it runs, and how far off it is.
struct AxisPlace {
  glm::dvec3 axis{0.0};
  /// Unit length.
  glm::dvec3 along{0.0, 0.0, 1.0};
  /// From the axis to the place, across it, and what of the way runs along it (beyond its ends).
  glm::dvec3 across{0.0};
  double beyond = 0.0;
};

/// Where a place falls on the original's triangles.
struct UnrolledPlace {
  int32_t triangle = -1;
  glm::vec2 uv{0.0f};
};

/// The triangles of the original wood, unrolled around their limbs' axes: a place falls on the
/// triangle that is in the same direction from the axis, at the same height along it, and shares
/// its corners' texture coordinates by angle and height. A prism of three sides is so the round
/// limb that it stands for, whose texture runs evenly around it, as on the limb that we have built.
///
/// A walk goes from triangle to triangle over their common edges to the one on which a place falls.
/// Over seams where the coordinates differ by whole numbers, where a tiling texture shows no seam,
/// it goes on and carries the difference with it; at other seams it stops, and takes what is
/// nearest on this side.
class Unrolled {
 public:
  explicit Unrolled(const OriginalWood& wood);

  /// @param from the triangle that the walk begins at: coordinates go on from those there.
  UnrolledPlace walk(const AxisPlace& place, int32_t from) const;

 private:
  /// What lies beyond an edge, from corner k to k + 1.
  struct Across {
    /// -1 at an open edge.
    int32_t triangle = -1;
    /// Added to the coordinates there they go on from those here; only if there is no seam.
    glm::vec2 shift{0.0f};
    bool seam = false;
  };

  void join_edges(int32_t begin, int32_t end);
  Across across(int32_t t, int k, int32_t u, int l) const;

  const OriginalWood& wood_;
  std::vector<std::array<Across, 3>> across_;
};

}  // namespace snowbough::tree
