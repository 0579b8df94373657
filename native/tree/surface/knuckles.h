#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "tree/surface/crotch.h"
#include "tree/surface/limb_path.h"

namespace snowbough::tree {

/// A child that leaves its parent.
struct ChildRequest {
  int32_t child = -1;
  /// Arc length on the parent's path where the child's centreline passes through the parent's
  /// surface.
  double position = 0.0;
  /// Arc length on the parent beside the child's further course: children that lean forward more
  /// are placed in front.
  double heading = 0.0;
  /// Side length of the child's square base, at most half as much again as the parent's.
  double width = 0.0;
  /// Length of the hole along the parent, and of the knuckle that it needs.
  double hole_length = 0.0;
  double length = 0.0;
  /// Where the child leaves as a second stem.
  std::optional<Crotch> crotch;
  /// Unit vector from the parent's centreline towards the child.
  glm::dvec3 direction{1.0, 0.0, 0.0};
};

/// A stretch of limb between two parallel rings where up to four children leave, one per side.
struct Knuckle {
  double begin = 0.0;
  double end = 0.0;
  std::vector<ChildRequest> children;
};

struct KnuckleRow {
  /// In order along the limb, separated from each other and from the limb's ends.
  std::vector<Knuckle> knuckles;
  /// End of the limb: moved outwards if the smallest knuckles do not fit otherwise.
  double end = 0.0;
};

/// Distributes the limb from `begin` to `end` among the children that leave it. Children at one
/// place in different directions share a knuckle; the others follow one another, shrunk (to 0.6
/// first, further only if the whole limb lacks room) and shifted as little as possible.
///
/// @param gap desired free length between two knuckles and at the ends.
KnuckleRow place_knuckles(std::vector<ChildRequest> requests, double begin, double end, double gap,
                          const LengthLimits& scale);

/// The same for a limb with sharp bends: no knuckle spans a bend, unless the children between two
/// bends need more room than there is.
/// @param bends per sharp bend, in order: its arc length, and the length to keep free beside it.
KnuckleRow place_knuckles_between(std::vector<ChildRequest> requests, double begin, double end,
                                  double gap, std::vector<std::pair<double, double>> bends,
                                  const LengthLimits& scale);

}  // namespace snowbough::tree
