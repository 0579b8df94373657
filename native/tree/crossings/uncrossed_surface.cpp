#include "tree/crossings/uncrossed_surface.h"

#include <algorithm>

#include "tree/crossings/crossings.h"
#include "tree/surface/builder.h"

namespace snowbough::tree {
namespace {

constexpr int kRounds = 6;
/// Number of rounds without improvement after which the search stops.
constexpr int kRoundsWithoutGain = 2;
/// Number of attempts to take narrowing back.
constexpr int kRoundsBack = 5;

/// Adds a narrowing step to branches that intersect: of two, the one farther from the trunk; in
/// later rounds both, except the junction's own limb.
/// @return per branch, 1 if its faces may move: the narrowed ones, their parents, and the children
///   of both.
std::vector<uint8_t> narrow_crossing(const Surface& surface, const JunctionCrossings& crossings,
                                     int round, std::vector<uint8_t>& narrowing_steps) {
  std::vector<uint8_t> changed(narrowing_steps.size(), 0);
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
  std::vector<uint8_t> moved(changed);
  for (size_t b = 0; b < changed.size(); ++b) {
    const int32_t parent = surface.parents[b];
    if (changed[b] != 0 && parent >= 0) moved[parent] = 1;
  }
  // Backwards, so that the children of children stay out: parents come first.
  for (size_t b = moved.size(); b-- > 0;) {
    const int32_t parent = surface.parents[b];
    if (parent >= 0 && moved[parent] != 0) moved[b] = 1;
  }
  return moved;
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

/// Takes narrowing back where it avoids nothing: first of limbs that intersect nevertheless, then
/// of all. Those keep it without which others would intersect, and if that does not suffice, those
/// beside them: the knuckles of a parent's children share its length.
/// @param best, narrowing  the best round; receive the result.
template <typename Build>
void take_back(const Build& build, int threads, UncrossedSurface& best,
               std::vector<uint8_t>& narrowing) {
  if (std::all_of(narrowing.begin(), narrowing.end(), [](uint8_t steps) { return steps == 0; })) {
    return;
  }
  // The rounds searched moved faces only.
  best.crossing = crossing_children(best.surface, find_crossings(best.surface, {}, threads));
  std::vector<uint8_t> needed(narrowing.size(), 0), crosses(narrowing.size(), 0);
  for (const int32_t child : best.crossing) crosses[child] = 1;
  for (int round = 0; round < kRoundsBack; ++round) {
    std::vector<uint8_t> less(narrowing);
    for (size_t b = 0; b < less.size(); ++b) {
      const int32_t parent = best.surface.parents[b];
      // The knuckles of its siblings are on the same limb.
      const bool is_beside = parent >= 0 && needed[parent] != 0;
      if (needed[b] == 0 && !is_beside) less[b] = 0;
    }
    if (less == narrowing) return;
    Surface wider = build(less);
    const JunctionCrossings crossings = find_crossings(wider, {}, threads);
    const std::vector<uint8_t> before(needed);
    bool more = false;
    for (size_t j = 0; j < crossings.size(); ++j) {
      const int32_t child = wider.junctions[j].child;
      if (crossings[j].empty() || crosses[child] != 0) continue;
      more = true;
      std::vector<int32_t> there{child};
      for (const auto& [f, g] : crossings[j]) {
        there.push_back(wider.origins[f].branch);
        there.push_back(wider.origins[g].branch);
      }
      const bool are_needed =
          std::all_of(there.begin(), there.end(), [&](int32_t b) { return before[b] != 0; });
      for (const int32_t b : there) {
        needed[b] = 1;
        if (are_needed && wider.parents[b] >= 0) needed[wider.parents[b]] = 1;
      }
    }
    if (more) continue;
    best.crossing = crossing_children(wider, crossings);
    best.surface = std::move(wider);
    narrowing = std::move(less);
    return;
  }
}

}  // namespace

UncrossedSurface build_uncrossed_surface(const Skeleton& skeleton,
                                         const std::vector<LimbPath>& paths,
                                         const LengthLimits& scale, const SurfaceOptions& options,
                                         const base::Execution& execution) {
  const auto build = [&](const std::vector<uint8_t>& narrowing_steps) {
    return build_surface(skeleton, paths, scale, options, narrowing_steps, execution.threads);
  };
  std::vector<uint8_t> narrowing_steps(paths.size(), 0), best_narrowing(narrowing_steps);
  UncrossedSurface best;
  best.surface = build(narrowing_steps);
  base::report_progress(execution.progress, 0.3f);
  JunctionCrossings crossings = find_crossings(best.surface, {}, execution.threads);
  best.crossing = crossing_children(best.surface, crossings);

  Surface narrowed;
  int idle = 0;
  for (int round = 0; round < kRounds && idle < kRoundsWithoutGain && !best.crossing.empty();
       ++round) {
    base::report_progress(execution.progress, 0.5f + 0.4f * static_cast<float>(round) / kRounds);
    const std::vector<uint8_t> moved =
        narrow_crossing(round == 0 ? best.surface : narrowed, crossings, round, narrowing_steps);
    narrowed = build(narrowing_steps);
    crossings = find_crossings(narrowed, moved, execution.threads);
    std::vector<int32_t> still = crossing_children(narrowed, crossings);
    ++idle;
    if (still.size() < best.crossing.size()) {
      idle = 0;
      best.crossing = std::move(still);
      best.surface = narrowed;
      best_narrowing = narrowing_steps;
    }
  }
  take_back(build, execution.threads, best, best_narrowing);
  for (size_t b = 0; b < best_narrowing.size(); ++b) {
    if (best_narrowing[b] > 0) {
      best.narrowed.push_back(static_cast<int32_t>(b));
    }
  }
  base::report_progress(execution.progress, 0.9f);
  return best;
}

}  // namespace snowbough::tree
