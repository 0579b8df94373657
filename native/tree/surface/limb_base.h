#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <optional>

#include "tree/surface/knuckles.h"
#include "tree/surface/limb_hull.h"
#include "tree/surface/limb_path.h"
#include "tree/surface/surface.h"

namespace snowbough::tree {

/// The opening in the parent's side from which a child grows.
struct Hole {
  std::array<int32_t, 4> vertices{};
  std::array<glm::dvec3, 4> corners{};
  glm::dvec3 centre{0.0};
  /// Unit, out of the parent.
  glm::dvec3 normal{0.0, 0.0, 1.0};
  /// Corner radius of a square of the hole's area.
  double corner = 0.0;
  /// The parent's corner radius there.
  double parent_corner = 0.0;
  /// Where the child leaves as a second stem.
  std::optional<Crotch> crotch;
};

struct Exit {
  ChildRequest request;
  /// The child is thicker than its parent at its exit.
  bool clamped = false;
};

/// Where a child passes through its parent's surface, and the knuckle that it needs there.
/// @param search of the parent's path.
/// @param own of the parent's own centreline: beside its first row the path is straight from its
///   hole to its first ring, so a child on one of them may be on the wrong side of the other.
/// @param attach arc length of the child's attach point on the parent's path.
/// @param narrowing_steps see build_surface.
Exit find_exit(const PathSearch& search, const PathSearch& own, double attach,
               const LimbPath& child, int32_t child_index, const LengthLimits& scale,
               int narrowing_steps);

/// The child's path from its hole on. A second stem begins with its own width on its own
/// centreline, at the heel of its crotch, and has its first ring where it is clear of its parent.
///
/// For all others: drops its own joints inside the parent's surface or whose
/// ring would cut it, and joints close to the hole whose ring would hang over the parent's side
/// with a gap under it, if the path without them is nearly straight. Narrows rings that hardly
/// clear the parent. At least the tip remains.
/// @param parent the hull of the parent's rings.
LimbPath leave_parent(const LimbPath& child, const Hole& hole, const LimbHull& parent,
                      const LengthLimits& scale, int narrowing_steps);

}  // namespace snowbough::tree
