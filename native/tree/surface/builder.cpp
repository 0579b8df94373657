#include "tree/surface/builder.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>

#include "base/parallel_for.h"

namespace snowbough::tree {
namespace {

/// Limbs per thread at a time, for building and joining.
constexpr size_t kBuildBlock = 16;
constexpr size_t kPlaceBlock = 64;

/// Whether children of both limbs start in the same way.
bool same_rings(const LimbSurface& a, const LimbSurface& b) {
  return std::equal(
      a.rings.begin(), a.rings.end(), b.rings.begin(), b.rings.end(),
      [](const Ring& r, const Ring& s) { return r.centre == s.centre && r.corner == s.corner; });
}

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

}  // namespace

SurfaceBuilder::SurfaceBuilder(const Skeleton& skeleton, const std::vector<LimbPath>& paths,
                               const SurfaceScale& scale, const SurfaceOptions& options,
                               int threads)
    : plan_{skeleton, paths, scale, options, {}, {}}, threads_(threads), parts_(paths.size()) {
  plan_.children.resize(paths.size());
  plan_.sibling.resize(paths.size(), 0);
  std::vector<size_t> depth(paths.size(), 0);
  for (size_t b = 0; b < paths.size(); ++b) {
    const int32_t parent = skeleton.branches[b].parent;
    if (parent >= 0) {
      depth[b] = depth[parent] + 1;
      plan_.sibling[b] = static_cast<int32_t>(plan_.children[parent].size());
      plan_.children[parent].push_back(static_cast<int32_t>(b));
    }
    if (depth[b] == generations_.size()) {
      generations_.emplace_back();
    }
    generations_[depth[b]].push_back(static_cast<int32_t>(b));
  }
}

const LimbStart& SurfaceBuilder::start_of(int32_t branch) const {
  static const LimbStart root;
  const int32_t parent = plan_.skeleton.branches[branch].parent;
  return parent < 0 ? root : parts_[parent].starts[plan_.sibling[branch]];
}

void SurfaceBuilder::build(const std::vector<uint8_t>& narrowing_steps) {
  const bool first = narrowing_steps_.empty();
  std::vector<uint8_t> dirty(parts_.size(), first ? 1 : 0);
  for (size_t b = 0; b < dirty.size() && !first; ++b) {
    const int32_t parent = plan_.skeleton.branches[b].parent;
    if (narrowing_steps[b] != narrowing_steps_[b]) {
      dirty[b] = 1;
      if (parent >= 0) {
        dirty[parent] = 1;
      }
    }
  }
  for (const std::vector<int32_t>& generation : generations_) {
    std::vector<int32_t> limbs;
    std::copy_if(generation.begin(), generation.end(), std::back_inserter(limbs),
                 [&](int32_t b) { return dirty[b] != 0; });
    base::parallel_for(limbs.size(), kBuildBlock, {threads_, {}}, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        rebuild_limb(limbs[i], narrowing_steps, dirty);
      }
    });
  }
  narrowing_steps_ = narrowing_steps;
}

/// Builds a limb whose parent is finished, and marks the children that change.
void SurfaceBuilder::rebuild_limb(int32_t branch, const std::vector<uint8_t>& narrowing_steps,
                                  std::vector<uint8_t>& dirty) {
  const int32_t parent = plan_.skeleton.branches[branch].parent;
  LimbPart part = build_limb(plan_, branch, narrowing_steps, start_of(branch),
                             parent >= 0 ? &parts_[parent].hull : nullptr);
  LimbPart& old = parts_[branch];
  const std::vector<int32_t>& children = plan_.children[branch];
  if (!old.starts.empty()) {
    const bool rings_stay = same_rings(part.limb, old.limb);
    for (size_t i = 0; i < children.size(); ++i) {
      const LimbStart& start = part.starts[i];
      if (!start.grows_like(old.starts[i]) || (!rings_stay && !start.continues)) {
        dirty[children[i]] = 1;
      }
    }
  }
  old = std::move(part);
}

Surface SurfaceBuilder::surface(const std::vector<uint8_t>& only) const {
  const auto wanted = [&only](size_t b) { return only.empty() || only[b] != 0; };
  Surface surface;
  std::vector<Place> places(parts_.size());
  Place next;
  for (size_t b = 0; b < parts_.size(); ++b) {
    const int32_t parent = plan_.skeleton.branches[b].parent;
    Place& place = places[b];
    place = next;
    if (parent >= 0 && wanted(static_cast<size_t>(parent))) {
      place.start = places[parent].numbers(start_of(static_cast<int32_t>(b)).hole.vertices);
    }
    if (wanted(b)) {
      next.vertex += parts_[b].vertices.size();
      next.quad += parts_[b].quads.size();
      next.junction += parts_[b].junctions.size();
      append(parts_[b].clamped, surface.clamped);
      append(parts_[b].squeezed, surface.squeezed);
    }
  }
  surface.vertices.resize(next.vertex);
  surface.quads.resize(next.quad);
  surface.origins.resize(next.quad);
  surface.junctions.resize(next.junction);
  surface.limbs.resize(parts_.size());
  base::parallel_for(parts_.size(), kPlaceBlock, {threads_, {}}, [&](size_t begin, size_t end) {
    for (size_t b = begin; b < end; ++b) {
      const LimbPart& part = parts_[b];
      const Place& place = places[b];
      const int32_t parent = plan_.skeleton.branches[b].parent;
      if (!wanted(b)) {
        if (parent >= 0 && wanted(static_cast<size_t>(parent))) {
          surface.limbs[b].rings.emplace_back().vertices = place.start;
        }
        continue;
      }
      std::copy(part.vertices.begin(), part.vertices.end(),
                surface.vertices.begin() + place.vertex);
      std::transform(part.quads.begin(), part.quads.end(), surface.quads.begin() + place.quad,
                     [&](const Quad& quad) { return place.numbers(quad); });
      std::copy(part.origins.begin(), part.origins.end(), surface.origins.begin() + place.quad);
      std::copy(part.junctions.begin(), part.junctions.end(),
                surface.junctions.begin() + place.junction);
      surface.limbs[b] = part.limb;
      for (Ring& ring : surface.limbs[b].rings) {
        ring.vertices = place.numbers(ring.vertices);
      }
    }
  });
  return surface;
}

}  // namespace snowbough::tree
