#include "tree/surface/builder.h"

#include <algorithm>
#include <array>
#include <utility>

#include "base/parallel_for.h"
#include "tree/surface/crotch.h"
#include "tree/surface/limb.h"

namespace snowbough::tree {
namespace {

/// Limbs per thread at a time, for building and joining.
constexpr size_t kBuildBlock = 16;
constexpr size_t kPlaceBlock = 64;

void append(const std::vector<int32_t>& more, std::vector<int32_t>& all) {
  all.insert(all.end(), more.begin(), more.end());
}

/// Offsets of a limb's part in the surface.
struct Place {
  size_t vertex = 0, quad = 0, junction = 0;
  /// Vertices of the limb's start.
  std::array<int32_t, 4> start{};

  int32_t number(int32_t local) const {
    return local >= 0 ? static_cast<int32_t>(vertex) + local : start[-1 - local];
  }
  std::array<int32_t, 4> numbers(const std::array<int32_t, 4>& local) const {
    return {number(local[0]), number(local[1]), number(local[2]), number(local[3])};
  }
};

/// Builds all limbs, parents before their children.
std::vector<LimbPart> build_limbs(const LimbPlan& plan, const std::vector<uint8_t>& narrowing_steps,
                                  int threads) {
  std::vector<LimbPart> parts(plan.paths.size());
  // Branches by depth below the root.
  std::vector<std::vector<int32_t>> generations;
  std::vector<size_t> depth(parts.size(), 0);
  for (size_t b = 0; b < parts.size(); ++b) {
    const int32_t parent = plan.parents[b];
    if (parent >= 0) depth[b] = depth[parent] + 1;
    if (depth[b] == generations.size()) generations.emplace_back();
    generations[depth[b]].push_back(static_cast<int32_t>(b));
  }
  for (const std::vector<int32_t>& limbs : generations) {
    base::parallel_for(limbs.size(), kBuildBlock, {threads, {}}, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const int32_t b = limbs[i], parent = plan.parents[b];
        parts[b] = parent < 0
                       ? build_limb(plan, b, narrowing_steps, {}, nullptr)
                       : build_limb(plan, b, narrowing_steps, parts[parent].starts[plan.sibling[b]],
                                    &parts[parent].hull);
      }
    });
  }
  return parts;
}

/// Joins the limbs to a surface.
Surface join_limbs(const LimbPlan& plan, std::vector<LimbPart> parts, int threads) {
  Surface surface;
  std::vector<Place> places(parts.size());
  Place next;
  for (size_t b = 0; b < parts.size(); ++b) {
    const int32_t parent = plan.parents[b];
    places[b] = next;
    if (parent >= 0) {
      const LimbStart& start = parts[parent].starts[plan.sibling[b]];
      places[b].start = places[parent].numbers(start.hole.vertices);
    }
    next.vertex += parts[b].vertices.size();
    next.quad += parts[b].quads.size();
    next.junction += parts[b].junctions.size();
    append(parts[b].clamped, surface.clamped);
    append(parts[b].squeezed, surface.squeezed);
  }
  surface.vertices.resize(next.vertex);
  surface.quads.resize(next.quad);
  surface.origins.resize(next.quad);
  surface.junctions.resize(next.junction);
  surface.limbs.resize(parts.size());
  base::parallel_for(parts.size(), kPlaceBlock, {threads, {}}, [&](size_t begin, size_t end) {
    for (size_t b = begin; b < end; ++b) {
      const LimbPart& part = parts[b];
      const Place& place = places[b];
      std::copy(part.vertices.begin(), part.vertices.end(),
                surface.vertices.begin() + place.vertex);
      std::transform(part.quads.begin(), part.quads.end(), surface.quads.begin() + place.quad,
                     [&](const Quad& quad) { return place.numbers(quad); });
      std::copy(part.origins.begin(), part.origins.end(), surface.origins.begin() + place.quad);
      std::copy(part.junctions.begin(), part.junctions.end(),
                surface.junctions.begin() + place.junction);
      surface.limbs[b] = std::move(parts[b].limb);
      for (Ring& ring : surface.limbs[b].rings) {
        ring.vertices = place.numbers(ring.vertices);
      }
    }
  });
  return surface;
}

}  // namespace

Surface build_surface(const Skeleton& skeleton, const std::vector<LimbPath>& paths,
                      const LengthLimits& scale, const SurfaceOptions& options,
                      const std::vector<uint8_t>& narrowing_steps, int threads) {
  LimbPlan plan{skeleton, paths, scale, options, surface_parents(skeleton, paths, scale), {}, {}};
  plan.children.resize(paths.size());
  plan.sibling.resize(paths.size(), 0);
  for (size_t b = 0; b < paths.size(); ++b) {
    const int32_t parent = plan.parents[b];
    if (parent < 0) continue;
    plan.sibling[b] = static_cast<int32_t>(plan.children[parent].size());
    plan.children[parent].push_back(static_cast<int32_t>(b));
  }
  Surface surface = join_limbs(plan, build_limbs(plan, narrowing_steps, threads), threads);
  surface.parents = std::move(plan.parents);
  return surface;
}

}  // namespace snowbough::tree
