#include "tree/tubes/side_counts.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "tree/tubes/detail.h"

namespace snowbough::tree {
namespace {

/// Sides up to this much longer are accepted instead of doubling their number.
constexpr double kSpareSides = 1.15;
/// In rows shorter than this many sides of the end with fewer, the number of sides stays.
constexpr double kShortChange = 2.0;

/// Gives knuckles and short rows the same number of sides at both ends.
void keep_sides_in_short_rows(const Surface& surface, const LimbHoles& holes, size_t limb,
                              std::vector<int>& across) {
  const std::vector<Ring>& rings = surface.limbs[limb].rings;
  std::vector<uint8_t> same(rings.size() - 1, 0);
  for (const int32_t j : holes.leaving[limb]) same[surface.junctions[j].row] = 1;
  // The first ring has the number of the ring after the hole, or its parent's.
  const size_t first = holes.has_hole(limb) || surface.limbs[limb].continues_parent ? 1 : 0;
  const auto keep = [&](size_t row) {
    const size_t fewer = across[row] < across[row + 1] ? row : row + 1;
    const double side = 0.5 * M_PI * radius_of(rings[fewer]) / across[fewer];
    if (same[row] != 0 || row_length(surface.limbs[limb], row) < kShortChange * side) {
      across[row] = across[row + 1] = std::max(across[row], across[row + 1]);
    }
  };
  for (size_t row = first; row + 1 < rings.size(); ++row) keep(row);
  for (size_t row = rings.size() - 1; row-- > first;) keep(row);
  if (holes.has_hole(limb)) across[0] = across[1];
}

}  // namespace

LimbHoles::LimbHoles(const Surface& surface)
    : junctions(surface.junctions), of(surface.limbs.size(), -1), leaving(surface.limbs.size()) {
  for (size_t j = 0; j < junctions.size(); ++j) {
    of[junctions[j].child] = static_cast<int32_t>(j);
    leaving[junctions[j].parent].push_back(static_cast<int32_t>(j));
  }
}

std::vector<int32_t>::const_iterator LimbHoles::first_leaving(size_t limb, size_t row,
                                                              int side) const {
  return std::lower_bound(leaving[limb].begin(), leaving[limb].end(),
                          std::pair(static_cast<int32_t>(row), side),
                          [&](int32_t j, const std::pair<int32_t, int>& at) {
                            return std::pair(junctions[j].row, junctions[j].side) < at;
                          });
}

double radius_of(const Ring& ring) {
  return ring.corner * std::sqrt(2.0 / M_PI);
}

double row_length(const LimbSurface& limb, size_t row) {
  return glm::distance(limb.rings[row].centre, limb.rings[row + 1].centre);
}

SideCounts count_sides(const Surface& surface, const LimbHoles& holes, double height,
                       int most_sides, double error) {
  const size_t count = surface.limbs.size();
  SideCounts across(count);
  // By the lowest vertex of a ring shared by child and parent: that ring.
  std::vector<std::pair<int32_t, int32_t>> ends(surface.vertices.size(), {-1, -1});
  for (size_t b = 0; b < count; ++b) {
    const LimbSurface& limb = surface.limbs[b];
    for (const Ring& ring : limb.rings) {
      // The middle of one of n sides lies (pi / n)^2 / 2 of the radius inside.
      const double sides = M_PI * std::sqrt(radius_of(ring) / (2.0 * error));
      across[b].push_back(power_of_two_from(0.25 * sides, most_sides / 4));
    }
    if (holes.has_hole(b)) {
      // Parents come first. With four sides a fork has no room for a fillet.
      const Junction& junction = surface.junctions[holes.of[b]];
      const int parent = across[junction.parent][junction.row];
      if (parent > 1 && radius_of(limb.rings[0]) > kMinFork * height) {
        across[b][1] = std::max(across[b][1], 2);
      }
      across[b][0] = across[b][1];
    }
    const auto last = static_cast<int32_t>(limb.rings.size()) - 1;
    ends[limb.rings.back().vertices[0]] = {static_cast<int32_t>(b), last};
  }
  // Parents come first.
  for (size_t b = 0; b < count; ++b) {
    if (surface.limbs[b].continues_parent) {
      const auto [limb, ring] = ends[surface.limbs[b].rings[0].vertices[0]];
      int& end = across[limb][ring];
      end = across[b][0] = std::max(end, across[b][0]);
    }
    keep_sides_in_short_rows(surface, holes, b, across[b]);
  }
  return across;
}

int power_of_two_from(double wanted, int most) {
  int count = 1;
  while (count < most && count * kSpareSides < wanted) {
    count *= 2;
  }
  return count;
}

}  // namespace snowbough::tree
