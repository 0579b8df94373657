#include "tree/surface_relief.h"

#include <algorithm>

#include "tree/surface_crossings.h"

namespace snowbough::tree {
namespace {

constexpr int kRounds = 6;
/// Junctions that did not improve for this many rounds will not.
constexpr int kPatience = 2;

/// Raises the relief of the branches that cross: of two, the one further from the trunk; in later
/// rounds both, unless it is the limb that the junction is on.
void relieve(const Surface& surface, const JunctionCrossings& crossings, int round,
             std::vector<uint8_t>& relief, std::vector<uint8_t>& changed) {
  for (size_t j = 0; j < crossings.size(); ++j) {
    for (const auto& [f, g] : crossings[j]) {
      const int32_t a = surface.origins[f].branch, b = surface.origins[g].branch;
      changed[std::max(a, b)] = 1;
      if (round >= 2) {
        changed[surface.junctions[j].child] = 1;
        if (std::min(a, b) != surface.junctions[j].parent) {
          changed[std::min(a, b)] = 1;
        }
      }
    }
  }
  for (size_t b = 0; b < relief.size(); ++b) {
    relief[b] = static_cast<uint8_t>(relief[b] + changed[b]);
  }
}

/// Junctions at either end of a branch that changed, and their neighbours on the same limb.
std::vector<uint8_t> affected(const Skeleton& skeleton, const Surface& surface,
                              const std::vector<uint8_t>& changed) {
  std::vector<uint8_t> limb(changed);
  for (size_t b = 0; b < changed.size(); ++b) {
    if (changed[b] != 0 && skeleton.branches[b].parent >= 0) {
      limb[skeleton.branches[b].parent] = 1;
    }
  }
  std::vector<uint8_t> only;
  for (const Junction& junction : surface.junctions) {
    only.push_back(limb[junction.parent] | limb[junction.child]);
  }
  return only;
}

std::vector<int32_t> crossing_children(const Surface& surface, const JunctionCrossings& crossings) {
  std::vector<int32_t> children;
  for (size_t j = 0; j < crossings.size(); ++j) {
    if (!crossings[j].empty()) {
      children.push_back(surface.junctions[j].child);
    }
  }
  return children;
}

}  // namespace

UncrossedSurface build_uncrossed_surface(const Skeleton& skeleton,
                                         const std::vector<LimbPath>& paths,
                                         const SurfaceScale& scale, const SurfaceOptions& options) {
  std::vector<uint8_t> relief(paths.size(), 0);
  UncrossedSurface best;
  best.surface = build_surface(skeleton, paths, scale, options, relief);
  JunctionCrossings crossings = find_crossings(best.surface);
  best.crossing = crossing_children(best.surface, crossings);
  std::vector<uint8_t> best_relief = relief;

  Surface surface = best.surface;
  int idle = 0;
  for (int round = 0; round < kRounds && idle < kPatience && !best.crossing.empty(); ++round) {
    std::vector<uint8_t> changed(relief.size(), 0);
    relieve(surface, crossings, round, relief, changed);
    surface = build_surface(skeleton, paths, scale, options, relief);
    crossings = find_crossings(surface, affected(skeleton, surface, changed));
    std::vector<int32_t> still = crossing_children(surface, crossings);
    ++idle;
    if (still.size() < best.crossing.size()) {
      idle = 0;
      best.surface = surface;
      best.crossing = std::move(still);
      best_relief = relief;
    }
  }
  for (size_t b = 0; b < best_relief.size(); ++b) {
    if (best_relief[b] > 0) {
      best.narrowed.push_back(static_cast<int32_t>(b));
    }
  }
  return best;
}

}  // namespace snowbough::tree
