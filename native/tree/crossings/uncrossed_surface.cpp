#include "tree/crossings/uncrossed_surface.h"

#include <algorithm>

#include "tree/crossings/crossings.h"
#include "tree/surface/builder.h"

namespace snowbough::tree {
namespace {

constexpr int kRounds = 6;
/// Number of rounds without improvement after which the search stops.
constexpr int kRoundsWithoutGain = 2;

/// Adds a narrowing step to branches that intersect: of two, the one farther from the trunk; in
/// later rounds both, except the junction's own limb.
void narrow_crossing(const Surface& surface, const JunctionCrossings& crossings, int round,
                     std::vector<uint8_t>& narrowing_steps, std::vector<uint8_t>& changed) {
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
  for (size_t b = 0; b < narrowing_steps.size(); ++b) {
    narrowing_steps[b] = static_cast<uint8_t>(narrowing_steps[b] + changed[b]);
  }
}

/// Branches whose faces move when `changed` are narrowed: they and their parents.
std::vector<uint8_t> moved_limbs(const Skeleton& skeleton, const std::vector<uint8_t>& changed) {
  std::vector<uint8_t> moved(changed);
  for (size_t b = 0; b < changed.size(); ++b) {
    if (changed[b] != 0 && skeleton.branches[b].parent >= 0) {
      moved[skeleton.branches[b].parent] = 1;
    }
  }
  return moved;
}

/// Junctions at either end of a moved branch, and their neighbours on the same limb.
std::vector<uint8_t> affected(const Surface& surface, const std::vector<uint8_t>& moved) {
  std::vector<uint8_t> only;
  only.reserve(surface.junctions.size());
  for (const Junction& junction : surface.junctions) {
    only.push_back(moved[junction.parent] | moved[junction.child]);
  }
  return only;
}

/// Adds all ancestors of the branches in `only`.
void add_ancestors(const Skeleton& skeleton, std::vector<uint8_t>& only) {
  for (size_t b = only.size(); b-- > 0;) {
    if (only[b] != 0 && skeleton.branches[b].parent >= 0) {
      only[skeleton.branches[b].parent] = 1;
    }
  }
}

/// The part of the surface with all faces near the affected junctions.
Surface surface_around(const SurfaceBuilder& builder, const Skeleton& skeleton,
                       const std::vector<uint8_t>& moved) {
  // Their children, grandchildren and siblings: a junction's neighbourhood rarely reaches further.
  std::vector<uint8_t> only(moved);
  for (size_t b = 0; b < moved.size(); ++b) {
    if (moved[b] != 0 && skeleton.branches[b].parent >= 0) {
      only[skeleton.branches[b].parent] = 1;
    }
  }
  for (int step = 0; step < 2; ++step) {
    const std::vector<uint8_t> before(only);
    for (size_t b = 0; b < moved.size(); ++b) {
      const int32_t parent = skeleton.branches[b].parent;
      only[b] |= parent >= 0 ? before[parent] : 0;
    }
  }
  while (true) {
    add_ancestors(skeleton, only);
    Surface surface = builder.surface(only);
    const std::vector<int32_t> missing = missing_limbs(surface, affected(surface, moved));
    if (missing.empty()) {
      return surface;
    }
    for (const int32_t b : missing) {
      only[b] = 1;
    }
  }
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
                                         const SurfaceScale& scale, const SurfaceOptions& options,
                                         const base::Execution& execution) {
  std::vector<uint8_t> narrowing_steps(paths.size(), 0);
  UncrossedSurface best;
  SurfaceBuilder builder(skeleton, paths, scale, options, execution.threads);
  builder.build(narrowing_steps);
  best.surface = builder.surface();
  base::report_progress(execution.progress, 0.3f);
  CrossingMemo memo(paths.size());
  JunctionCrossings crossings = find_crossings(best.surface, {}, execution.part(0.3f, 0.7f), &memo);
  best.crossing = crossing_children(best.surface, crossings);
  std::vector<uint8_t> best_narrowing = narrowing_steps;

  Surface around;
  int idle = 0;
  for (int round = 0; round < kRounds && idle < kRoundsWithoutGain && !best.crossing.empty();
       ++round) {
    const float share = 0.7f + 0.2f * static_cast<float>(round) / kRounds;
    base::report_progress(execution.progress, share);
    std::vector<uint8_t> changed(narrowing_steps.size(), 0);
    narrow_crossing(round == 0 ? best.surface : around, crossings, round, narrowing_steps, changed);
    const std::vector<uint8_t> moved = moved_limbs(skeleton, changed);
    builder.build(narrowing_steps);
    around = surface_around(builder, skeleton, moved);
    // On a limb without enough room, narrowing one child shifts knuckles along all of it: the memo
    // is useless then and not consulted.
    CrossingMemo* const known = round == 0 || memo.hits() > 0 ? &memo : nullptr;
    crossings =
        find_crossings(around, affected(around, moved), execution.part(share, share), known);
    std::vector<int32_t> still = crossing_children(around, crossings);
    ++idle;
    if (still.size() < best.crossing.size()) {
      idle = 0;
      best.crossing = std::move(still);
      best_narrowing = narrowing_steps;
    }
  }
  for (size_t b = 0; b < best_narrowing.size(); ++b) {
    if (best_narrowing[b] > 0) {
      best.narrowed.push_back(static_cast<int32_t>(b));
    }
  }
  if (!best.narrowed.empty()) {
    base::report_progress(execution.progress, 0.9f);
    builder.build(best_narrowing);
    best.surface = builder.surface();
  }
  return best;
}

}  // namespace snowbough::tree
