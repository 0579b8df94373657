#include "tree/rims/unrolled_limbs.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <span>
#include <utility>

#include "base/parallel_for.h"
#include "tree/rims/membrane.h"

namespace snowbough::tree {
namespace {

/// Range of the movement around a rim: a multiple of its farthest point's displacement, plus a
/// number of the hole's radii.
constexpr double kReachOfMove = 2.5;
constexpr double kReachOfFork = 2.0;
/// Vertices up to this many edges from a rim, more for rims with many, move between their
/// neighbours; neighbours farther than the rim's own edge length, or this many radii of the hole,
/// pull as if they were closer.
constexpr int kSpreadDepth = 3;
constexpr double kSpread = 0.5;
/// Chains per thread at a time.
constexpr size_t kBlock = 4;

RimReach rim_reach(int32_t junction, const Rim& rim, const Fork& fork, const LimbTubes& tubes) {
  glm::dvec2 middle(0.0);
  for (const RimPoint& point : rim) middle += difference(rim[0].base, point.base);
  middle /= static_cast<double>(rim.size());
  RimReach reach;
  reach.junction = junction;
  reach.centre = {rim[0].base.length + middle.y, rim[0].base.quarter + middle.x};
  reach.quarter_length = 0.5 * M_PI * tubes.radius(fork.parent_chain, reach.centre.length);
  double extent = 0.0;
  for (const RimPoint& point : rim) {
    reach.farthest = std::max(reach.farthest, reach.metres(difference(point.base, point.target)));
    extent = std::max({extent, reach.from_centre(point.base), reach.from_centre(point.target)});
  }
  reach.spread = std::min(kSpread, 2.0 * M_PI / static_cast<double>(rim.size())) * fork.radius;
  reach.spread_depth = std::max(kSpreadDepth, static_cast<int>(rim.size()) / 6);
  reach.most_ahead = fork.radius;
  reach.radius = extent + kReachOfMove * reach.farthest + kReachOfFork * fork.radius;
  return reach;
}

/// Divides a chain's rims into groups whose reaches overlap: groups are independent and may take
/// different numbers of steps.
std::vector<std::span<const RimReach>> apart(std::span<RimReach> rims) {
  std::sort(rims.begin(), rims.end(), [](const RimReach& a, const RimReach& b) {
    const double low = a.centre.length - a.radius, other = b.centre.length - b.radius;
    return low != other ? low < other : a.junction < b.junction;
  });
  std::vector<std::span<const RimReach>> parts;
  size_t first = 0;
  double end = -1e300;
  for (size_t i = 0; i < rims.size(); ++i) {
    if (i > first && rims[i].centre.length - rims[i].radius > end) {
      parts.push_back(rims.subspan(first, i - first));
      first = i;
    }
    end = std::max(end, rims[i].centre.length + rims[i].radius);
  }
  parts.push_back(rims.subspan(first));
  return parts;
}

}  // namespace

void move_rims(const std::vector<Rim>& rims, const std::vector<Fork>& forks, const LimbTubes& tubes,
               int threads, UnrolledLimbs& unrolled) {
  const Neighbours neighbours(unrolled.quads, unrolled.places.size());
  std::vector<std::pair<int32_t, int32_t>> by_chain;
  for (size_t j = 0; j < forks.size(); ++j) {
    if (forks[j].blends) by_chain.emplace_back(forks[j].parent_chain, static_cast<int32_t>(j));
  }
  std::sort(by_chain.begin(), by_chain.end());
  std::vector<RimReach> reaches;
  std::vector<size_t> first;
  for (size_t i = 0; i < by_chain.size(); ++i) {
    const auto [chain, j] = by_chain[i];
    if (i == 0 || chain != by_chain[i - 1].first) first.push_back(i);
    reaches.push_back(rim_reach(j, rims[j], forks[j], tubes));
  }
  first.push_back(by_chain.size());
  unrolled.shares.assign(unrolled.places.size(), 0.0);
  Locals locals{std::vector<int32_t>(unrolled.places.size(), -1),
                std::vector<int32_t>(unrolled.quads.size(), -1)};
  base::parallel_for(first.size() - 1, kBlock, {threads, {}}, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const std::span<RimReach> on_chain(reaches.data() + first[i], first[i + 1] - first[i]);
      for (const std::span<const RimReach> rims_beside : apart(on_chain)) {
        move_membrane(neighbours, rims, rims_beside, unrolled, locals);
      }
    }
  });
}

}  // namespace snowbough::tree
