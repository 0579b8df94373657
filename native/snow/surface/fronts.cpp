#include "snow/surface/fronts.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "base/parallel_for.h"
#include "shaders/lib/snow_noise.h"
#include "snow/surface/vectors.h"

namespace snowbough::snow {
namespace {

using shared::bridged_part;
using shared::eased;
using shared::layered_noise;
using shared::SnowFront;

/// Overhang on the lee side in a horizontal wind, as a fraction of the snow's height.
constexpr float kLee = 0.4f;
/// Points at least this fraction into their zone give the height of the snow behind a rim.
constexpr float kInland = 0.6f;

/// Heights of snow, in widths of a bevel, at which the bevel begins to vanish and has vanished.
constexpr float kBareBevel = 0.3f;
constexpr float kCoveredBevel = 1.2f;

/// What lies below a rim is looked for this far outwards, from this far above the rim down to this
/// depth, as fractions of the depth.
constexpr float kBeyond = 0.15f;
constexpr float kAbove = 0.05f;
constexpr float kDeepest = 1.5f;
/// A rim is hidden where less than the first part of the height behind it stands above the snow
/// beyond, and stands free from the second part on.
constexpr float kHidden = 0.25f;
constexpr float kStandsFree = 0.6f;
/// Least upward component of the normal where snow lies below a rim.
constexpr float kCarriesBelow = 0.3f;

/// Points whose feet are within this many depths of each other belong to one stretch of a rim.
constexpr float kFullnessReach = 0.4f;
/// Fraction of the map's volume by which fronts may exceed it: on narrow tops, and on wide tops,
/// where the difference is less visible. The last two constants are the room of narrow and wide
/// tops, in depths.
constexpr float kMoreSnow = 0.24f;
constexpr float kMoreOnWide = 0.7f;
constexpr float kNarrowFront = 0.9f;
constexpr float kWideFront = 2.0f;

void smooth_presence(Fronts& fronts, const HeightSamples& samples) {
  std::vector<int32_t> front_of(samples.count(), -1);
  for (size_t f = 0; f < fronts.front.size(); ++f)
    front_of[fronts.point[f]] = static_cast<int32_t>(f);
  constexpr int kRounds = 8;
  std::vector<float> before(fronts.front.size());
  for (int round = 0; round < kRounds; ++round) {
    for (size_t f = 0; f < fronts.front.size(); ++f) before[f] = fronts.front[f].presence;
    base::for_each_item(fronts.front.size(), 256, [&](size_t f) {
      const auto p = static_cast<size_t>(fronts.point[f]);
      float sum = before[f];
      float count = 1.0f;
      for (int32_t i = samples.neighbour_begin[p]; i < samples.neighbour_begin[p + 1]; ++i) {
        const int32_t other = front_of[samples.neighbour[i]];
        if (other < 0) continue;
        sum += before[other];
        count += 1.0f;
      }
      fronts.front[f].presence = sum / count;
    });
  }
}

float mean_at(const Fronts::Inland& at, const std::vector<float>& height) {
  float sum = 0.0f;
  for (int k = 0; k < 4; ++k) sum += at.weight[k] * std::max(height[at.point[k]], 0.0f);
  return sum;
}

}  // namespace

shared::SnowBehind Fronts::behind(size_t number, const std::vector<float>& height) const {
  const bool may_bridge = front[number].bridged > 0.0f;
  return {mean_at(inland[number], height), may_bridge ? mean_at(across[number], height) : 0.0f};
}

float Fronts::open_part(size_t number, const std::vector<float>& height) const {
  const Fall& below = fall[number];
  const float top = mean_at(inland[number], height) / below.own_up;
  if (!std::isfinite(below.drop) || top <= 0.0f) return 1.0f;
  const float beyond = mean_at(below.at, height) / below.up - below.drop;
  return std::clamp((top - beyond) / top, 0.0f, 1.0f);
}

void Fronts::cover(std::vector<float>& thickness) const {
  std::vector<std::pair<int32_t, float>> covered;
  for (size_t f = 0; f < count(); ++f) {
    if (fall[f].hidden <= 0.0f || front[f].distance >= 0.0f) continue;
    const float both = 0.5f * (mean_at(inland[f], thickness) + mean_at(fall[f].at, thickness));
    const float own = thickness[point[f]];
    covered.emplace_back(point[f], glm::mix(own, std::max(own, both), fall[f].hidden));
  }
  for (const auto& [p, height] : covered) thickness[p] = height;
}

float Fronts::presence(size_t number, const shared::SnowStyle& style,
                       const shared::SnowBehind& behind) const {
  const SnowFront& at = front[number];
  // Snow thinner than a bevel lies on it.
  const float covers = at.bevel > 0.0f
                           ? eased(behind.inland, kBareBevel * at.bevel, kCoveredBevel * at.bevel)
                           : 1.0f;
  const float own = at.presence * covers;
  return own > 0.0f ? std::max(own, bridged_part(at, style, behind)) : 0.0f;
}

Fronts find_fronts(SurfacePoints& points, const std::vector<RimZones::Zone>& zone, const Rims& rims,
                   const base::TriangleTree& tree, const glm::vec2& wind,
                   const glm::vec3& noise_shift, float depth) {
  Fronts fronts;
  if (rims.all().empty()) return fronts;
  // Collect the points inland of rims.
  std::vector<CellGrid::Box> boxes;
  std::vector<int32_t> inland;
  for (size_t p = 0; p < points.count(); ++p) {
    if (!zone[p].place.is_far_off && zone[p].share > kInland) {
      boxes.push_back({points.mesh.position[p], points.mesh.position[p]});
      inland.push_back(static_cast<int32_t>(p));
    }
  }
  const CellGrid grid(boxes, 0.25f * depth);
  // And those that snow can lie on.
  std::vector<CellGrid::Box> lying_boxes;
  std::vector<int32_t> lying;
  for (size_t p = 0; p < points.count(); ++p) {
    const bool is_far = !zone[p].place.is_far_off && zone[p].share < -1e-3f;
    if (is_far || points.normal[p].z < kCarriesBelow) continue;
    lying_boxes.push_back({points.mesh.position[p], points.mesh.position[p]});
    lying.push_back(static_cast<int32_t>(p));
  }
  const CellGrid lying_grid(lying_boxes, 0.25f * depth);

  for (size_t p = 0; p < points.count(); ++p) {
    if (zone[p].place.is_far_off || zone[p].share >= 1.0f || zone[p].share < -1.6f) continue;
    fronts.point.push_back(static_cast<int32_t>(p));
  }
  fronts.front.resize(fronts.point.size());
  fronts.inland.resize(fronts.front.size());
  fronts.across.resize(fronts.front.size());
  fronts.fall.resize(fronts.front.size());
  // The points of a grid that are nearest to a place; the point itself if there are none.
  const auto nearest_of = [&](const CellGrid& grid, const std::vector<int32_t>& of,
                              const glm::vec3& place, size_t own, float farthest) {
    struct Found {
      float distance;
      int32_t point;
    };
    thread_local std::vector<Found> found;
    found.clear();
    for (float reach = 0.15f * depth; reach < farthest && found.size() < 4; reach *= 1.7f) {
      found.clear();
      grid.visit(place - reach, place + reach, [&](int32_t i) {
        const int32_t q = of[i];
        const float distance = glm::distance(points.mesh.position[q], place);
        if (distance < reach) found.push_back({distance, q});
      });
    }
    std::sort(found.begin(), found.end(), [](const Found& a, const Found& b) {
      return a.distance != b.distance ? a.distance < b.distance : a.point < b.point;
    });
    Fronts::Inland at{glm::ivec4(static_cast<int32_t>(own)), glm::vec4(0.0f)};
    for (int k = 0; k < 4 && k < static_cast<int>(found.size()); ++k) {
      at.point[k] = found[k].point;
      at.weight[k] = 1.0f / (found[k].distance + 0.025f * depth);
    }
    if (found.empty()) at.weight[0] = 1.0f;
    at.weight /= at.weight.x + at.weight.y + at.weight.z + at.weight.w;
    return at;
  };
  base::for_each_item(fronts.front.size(), 64, [&](size_t f) {
    const auto p = static_cast<size_t>(fronts.point[f]);
    const RimZones::Zone& here = zone[p];
    shared::SnowFront& front = fronts.front[f];
    front.distance = here.place.distance;
    front.below = here.place.below;
    front.bevel = here.place.strip;
    front.zone = here.support;
    front.far_zone = here.far;
    front.has_far = here.place.has_far ? 1.0f : 0.0f;
    front.outward = here.place.out;
    front.level_out = here.place.level_out;
    front.down = here.place.down;
    front.eave = std::clamp(-here.place.out.z, 0.0f, 1.0f) * front.has_far;
    const glm::vec3 support = here.place.distance >= 0.0f ? here.place.support : glm::vec3(0, 0, 1);
    const glm::vec3 lift = unit(0.7f * glm::vec3(0, 0, 1) + 0.3f * support);
    front.lift = lift / std::max(glm::dot(lift, support), 0.5f);
    const glm::vec3 at = here.place.foot / depth + noise_shift;
    front.noise_slow = std::clamp(layered_noise(at + 9.0f, {3.0f, 1.4f, 0.6f}, 0.75f), -1.3f, 1.3f);
    front.noise_fast =
        std::clamp(layered_noise(at + 31.0f, {2.4f, 1.2f, 0.7f}, 0.65f), -1.3f, 1.3f);
    front.noise_shoulder = layered_noise(at + 77.0f, {3.0f, 1.2f, 0.0f}, 0.6f);
    const float lee = glm::dot(glm::vec2(here.place.level_out), wind);
    front.lee = kLee * std::max(lee, 0.0f);
    const Rims::Opposite opposite = rims.opposite(here.place, shared::kBridgedGap * depth);
    front.bridged = opposite.nearness;
    front.half_gap = 0.5f * opposite.gap + 0.0005f;
    front.half_step = 0.5f * opposite.step;

    // The tip of a needle counts as a rim but is too small for a front.
    front.presence = eased(here.room / depth, 0.03f, 0.09f);
    const float farthest = front.presence > 0.0f ? 3.0f * depth : 0.0f;
    const glm::vec3 behind = here.place.foot - here.place.out * (here.support * 1.02f);
    fronts.inland[f] = nearest_of(grid, inland, behind, p, farthest);
    const glm::vec3 beyond = here.place.foot + here.place.level_out * (kBeyond * depth);
    const glm::dvec3 above = glm::dvec3(beyond) + glm::dvec3(0.0, 0.0, kAbove * depth);
    const double drop = tree.first_along(0, above, {0.0, 0.0, -1.0}, 1e-5).distance;
    if (front.presence > 0.0f && drop < kDeepest * depth) {
      Fronts::Fall& fall = fronts.fall[f];
      const float below = static_cast<float>(drop) - kAbove * depth;
      fall.at = nearest_of(lying_grid, lying, beyond - glm::vec3(0.0f, 0.0f, below), p, depth);
      float up = 0.0f;
      for (int k = 0; k < 4; ++k) up += fall.at.weight[k] * points.normal[fall.at.point[k]].z;
      fall.drop = below;
      fall.up = std::max(up, kCarriesBelow);
      fall.own_up = std::max(here.place.support.z, kCarriesBelow);
    }
    if (front.bridged > 0.0f) {
      const glm::vec3 across = here.place.foot + glm::vec3(0.0f, 0.0f, opposite.step) +
                               here.place.level_out * (opposite.gap + here.support * 1.02f);
      fronts.across[f] = nearest_of(grid, inland, across, p, farthest);
    }
  });
  fronts.room.resize(fronts.front.size());
  for (size_t f = 0; f < fronts.front.size(); ++f) fronts.room[f] = zone[fronts.point[f]].room;
  for (size_t p = 0; p < points.count(); ++p) {
    if (zone[p].place.is_far_off || zone[p].share < -1e-4f) continue;
    const float near = eased(zone[p].share, 1.15f, 0.6f);
    points.normal[p] = unit(glm::mix(points.normal[p], zone[p].place.support, near));
  }
  return fronts;
}

void find_presence(Fronts& fronts, const SurfacePoints& points, const HeightSamples& samples,
                   const std::vector<float>& thickness, const std::vector<float>& shown,
                   float depth) {
  // Snow on a narrow top lies as a dome after sliding. Upright fronts would hold more snow than the
  // map has.
  const auto foot_of = [&](size_t f) {
    const SnowFront& front = fronts.front[f];
    return points.mesh.position[fronts.point[f]] + front.outward * (front.distance + front.below) -
           front.down * front.below;
  };
  std::vector<CellGrid::Box> boxes;
  std::vector<size_t> supports;
  for (size_t f = 0; f < fronts.front.size(); ++f) {
    if (fronts.front[f].distance < 0.0f) continue;
    const glm::vec3 foot = foot_of(f);
    boxes.push_back({foot, foot});
    supports.push_back(f);
  }
  const CellGrid grid(boxes, kFullnessReach * depth);
  base::for_each_item(fronts.front.size(), 64, [&](size_t f) {
    SnowFront& front = fronts.front[f];
    const float full = std::clamp(1.5f * fronts.room[f], 0.05f * depth, depth);
    // A front needs snow behind the rim in the last frame.
    front.presence *= eased(fronts.behind(f, shown).inland, 0.06f * full, 0.3f * full);
    if (front.presence <= 0.0f) return;
    const glm::vec3 foot = foot_of(f);
    const float reach = kFullnessReach * depth;
    float held = 0.0f, upright = 0.0f;
    grid.visit(foot - reach, foot + reach, [&](int32_t i) {
      const size_t other = supports[i];
      const auto q = static_cast<size_t>(fronts.point[other]);
      if (glm::distance(boxes[i].low, foot) > reach) return;
      held += samples.area[q] * thickness[q];
      upright += samples.area[q] * fronts.behind(other, thickness).inland;
    });
    if (upright <= 0.0f) return;
    const float fullness = std::clamp(held / upright, 0.0f, 0.999f);
    const float wide = eased(fronts.room[f], kNarrowFront * depth, kWideFront * depth);
    const float more = glm::mix(kMoreSnow, kMoreOnWide, wide);
    front.presence *= std::min(more * fullness / (1.0f - fullness), 1.0f);
  });
  for (size_t f = 0; f < fronts.count(); ++f) {
    Fronts::Fall& fall = fronts.fall[f];
    fall.hidden = 1.0f - eased(fronts.open_part(f, thickness), kHidden, kStandsFree);
    fronts.front[f].presence *= 1.0f - fall.hidden;
  }
  smooth_presence(fronts, samples);
}

}  // namespace snowbough::snow
