#pragma once

#include <cstdint>
#include <vector>

#include "tree/surface/surface.h"

namespace snowbough::tree {

/// Which limb leaves which through which hole.
struct LimbHoles {
  explicit LimbHoles(const Surface& surface);

  bool has_hole(size_t limb) const { return of[limb] >= 0; }

  /// A limb's first child at a row's side or after it: the place in `leaving`.
  std::vector<int32_t>::const_iterator first_leaving(size_t limb, size_t row, int side) const;

  const std::vector<Junction>& junctions;
  /// Per branch: the junction that it leaves its parent from, or -1.
  std::vector<int32_t> of;
  /// Per branch: the junctions of its children, in their order along it.
  std::vector<std::vector<int32_t>> leaving;
};

/// Of the circle that has the limb's area at a ring.
double radius_of(const Ring& ring);

/// From the middle of a row's ring to the next one's.
double row_length(const LimbSurface& limb, size_t row);

/// Per limb and ring: quads across each of the four sides, a power of two. Of a hole in the
/// parent's side, that of the limb's next ring.
using SideCounts = std::vector<std::vector<int>>;

/// Sides by the limbs' thickness. Knuckles and short rows have as many at both ends, and so have a
/// limb's end and what continues it.
///
/// @param height  the tree's.
/// @param most_sides  of a limb: 8, 16 or 32.
/// @param error  metres that the middle of a side may lie inside the round limb.
SideCounts count_sides(const Surface& surface, const LimbHoles& holes, double height,
                       int most_sides, double error);

/// The least power of two that is enough, or nearly: a tenth more sides than wanted are not worth
/// twice as many.
int power_of_two_from(double wanted, int most);

}  // namespace snowbough::tree
