#pragma once

#include <cstdint>
#include <vector>

#include "tree/surface/surface.h"

namespace snowbough::tree {

/// Which limb leaves which through which hole.
struct LimbHoles {
  explicit LimbHoles(const Surface& surface);

  bool has_hole(size_t limb) const { return of[limb] >= 0; }

  /// A limb's first child at or after a row's side: an iterator into `leaving`.
  std::vector<int32_t>::const_iterator first_leaving(size_t limb, size_t row, int side) const;

  const std::vector<Junction>& junctions;
  /// Per branch: the junction at which it leaves its parent, or -1.
  std::vector<int32_t> of;
  /// Per branch: its children's junctions, in order along it.
  std::vector<std::vector<int32_t>> leaving;
};

/// Radius of the circle with the limb's area at a ring.
double radius_of(const Ring& ring);

/// Distance between the centres of a row's rings.
double row_length(const LimbSurface& limb, size_t row);

/// Per limb and ring: quads across each of the four sides, a power of two. A hole in the parent's
/// side has the number of the limb's next ring.
using SideCounts = std::vector<std::vector<int>>;

/// Chooses the number of sides by thickness. Knuckles and short rows have the same number at both
/// ends, and so do a limb's end and the limb that continues it.
///
/// @param height  of the tree.
/// @param most_sides  of a limb: 8, 16 or 32.
/// @param error  maximum distance in metres of a side's middle from the round limb.
SideCounts count_sides(const Surface& surface, const LimbHoles& holes, double height,
                       int most_sides, double error);

/// The smallest power of two that is enough within a tenth: slightly more sides than wanted are not
/// worth twice as many.
int power_of_two_from(double wanted, int most);

}  // namespace snowbough::tree
