#include "snow/surface/fronts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "base/parallel_for.h"
#include "shaders/lib/snow_noise.h"
#include "snow/surface/point_tree.h"
#include "snow/surface/vectors.h"

namespace snowbough::snow {
namespace {

using shared::eased;
using shared::layered_noise;
using shared::SnowFront;

/// Overhang on the lee side in a horizontal wind, as a fraction of the snow's height.
constexpr float kLee = 0.4f;
/// Points at least this fraction into their zone give the height of the snow behind a rim.
constexpr float kInland = 0.6f;
/// Points this far into the zone of a narrow top lie about where the height is wanted: if there are
/// any within this distance, in depths, the others do not count. On a slope, heights nearer to the
/// rim are lower.
constexpr float kMiddle = 0.78f;
constexpr float kMiddleReach = 0.2f;
/// Distance, in depths, up to which snow in the open gives the height, before snow in shelter does:
/// behind the rim of a ledge there may be no other. Where that is bare, the point gives its own.
constexpr float kOpenReach = 1.3f;
constexpr float kIsBare = 0.02f;
/// Distance from a point within a piece at which snow beside the piece is looked for, in depths.
constexpr float kFromHidden = 0.4f;
/// Where the snow behind a rim is looked for, as a fraction of the zone.
constexpr float kBehind = 1.02f;

/// Heights of snow, in widths of a bevel, at which the bevel begins to vanish and has vanished.
constexpr float kBareBevel = 0.3f;
constexpr float kCoveredBevel = 1.2f;

/// What lies below a rim is looked for at these distances outwards, from this far above the rim
/// down to this depth, as fractions of the depth; within a body, up to the height that follows. The
/// first one that is hit says how far below it lies; the snow there has the thickness at the last
/// distance, off the foot of the step.
constexpr std::array<float, 3> kBeyond{0.03f, 0.15f, 0.35f};
constexpr float kAbove = 0.05f;
constexpr float kDeepest = 1.5f;
constexpr float kHighest = 0.5f;
/// Distance to both sides at which the ground beyond a rim is looked at, as well, likewise.
constexpr float kBeside = 0.06f;
/// Greatest slope of what lies below, and least part of a rim in a place that counts.
constexpr float kSlopeBelow = 1.2f;
constexpr float kMinPart = 0.05f;
/// Presence below which a front hardly shows, whatever it joins.
constexpr float kHardly = 0.1f;
/// Rays for shelter start this far above a face, and this far inwards from a rim, as fractions of
/// the depth.
constexpr float kOffFace = 0.01f;
constexpr float kNearRim = 0.02f;
/// Height above a rim within which another piece covers it, likewise, and the least height of such
/// a rim: tiles cover each other's sides.
constexpr float kCovered = 0.25f;
/// Least upward component of the normal where snow lies below a rim.
constexpr float kCarriesBelow = 0.3f;

/// Snow reaches over that of another receiver by the first fraction of the depth if the ground
/// there lies lower by less than the third; not at all if it lies lower by more than the second.
constexpr float kReachesOver = 0.08f;
constexpr float kFarBelow = 0.4f;
constexpr float kNearBelow = 0.2f;
/// Greatest upward component of the normal of an upright face.
constexpr float kSteepBank = 0.12f;

/// A blanket reaches outwards by the first fraction of the snow's height, beyond half the gap. It
/// does so over the second part of the zone, and dips by the third, as a fraction of that way.
constexpr float kBlanketOver = 0.14f;
constexpr float kBlanketRun = 0.2f;
constexpr float kBlanketDip = 0.3f;
/// Distances from a rim at which its step counts fully and not at all, as fractions of the depth.
constexpr float kNearStep = 0.6f;
constexpr float kFarStep = 1.2f;
/// Steps behind which furrows are filled, and steps behind which they are not, likewise.
constexpr float kLowStep = 0.25f;
constexpr float kHighStep = 0.5f;

/// Points whose feet are within this many depths of each other belong to one stretch of a rim.
constexpr float kFullnessReach = 0.4f;
/// Least mean thickness in a zone, as a fraction of that behind the rim.
constexpr float kMinFull = 0.4f;
/// Fraction of the map's volume by which fronts may exceed it: on narrow tops, and on wide tops,
/// where the difference is less visible. The last two constants are the room of narrow and wide
/// tops, in depths.
constexpr float kMoreSnow = 0.24f;
constexpr float kMoreOnWide = 0.7f;
constexpr float kNarrowFront = 0.9f;
constexpr float kWideFront = 2.0f;

/// True if another surface lies less than a depth above a place.
bool is_sheltered(const base::TriangleTree& tree, const glm::vec3& place, float depth) {
  const glm::dvec3 from = place + glm::vec3(0.0f, 0.0f, kOffFace * depth);
  return std::isfinite(tree.first_along(0, from, {0.0, 0.0, 1.0}, 1e-5, depth).distance);
}

/// Unit normals of the faces at each point, those of the most level ones above all.
std::vector<glm::vec3> upper_normals(const SurfaceMesh& mesh) {
  std::vector<glm::vec3> normal(mesh.position.size(), glm::vec3(0.0f));
  for (size_t t = 0; t < mesh.triangle.size(); ++t) {
    const glm::vec3 cross = triangle_cross(mesh, t);
    const float level = std::max(unit(cross).z, 0.02f);
    for (const int32_t p : mesh.triangle[t]) normal[p] += cross * (level * level * level);
  }
  for (glm::vec3& one : normal) one = unit(one);
  return normal;
}

std::vector<uint8_t> sheltered_points(const SurfacePoints& points, const base::TriangleTree& tree,
                                      float depth) {
  std::vector<uint8_t> sheltered(points.count(), 0);
  base::for_each_item(sheltered.size(), 256, [&](size_t p) {
    if (points.normal[p].z < kCarriesBelow) return;
    sheltered[p] = is_sheltered(tree, points.mesh.position[p], depth) ? 1 : 0;
  });
  return sheltered;
}

/// What lies below a place beyond a rim: where, how far below the place, and the thickness of the
/// snow there if it is another receiver's, in depths, else below 0.
struct Ground {
  glm::vec3 at{0.0f};
  float drop = std::numeric_limits<float>::infinity();
  float other = -1.0f;
};

/// Looks at the ground in the middle and to both sides, and takes the middle one of the three: a
/// narrow joint beyond a rim is not the ground.
template <typename GroundAt>
Ground usual_ground(const glm::vec3& place, const glm::vec3& along, const GroundAt& ground_below) {
  std::array<Ground, 3> found{ground_below(place - along), ground_below(place),
                              ground_below(place + along)};
  std::sort(found.begin(), found.end(),
            [](const Ground& a, const Ground& b) { return a.drop < b.drop; });
  return found[1];
}

/// What lies below the rims of a place. A rim with the greatest part in the place says how far
/// below it lies, and what it is; `lying_at` returns the points there that snow can lie on.
template <typename LyingAt>
Fronts::Fall fall_beyond(const RimPosition& place, const Rims& rims, const SurfaceMesh& receiver,
                         const base::TriangleTree& tree, const Beyond& others, bool may_bridge,
                         float depth, const LyingAt& lying_at) {
  const double most_below = (kDeepest + kAbove) * depth;
  const double highest = (kHighest - kAbove) * depth;
  const auto ground_below = [&](const glm::vec3& beyond) {
    const glm::dvec3 above = glm::dvec3(beyond) + glm::dvec3(0.0, 0.0, kAbove * depth);
    const double own =
        ground_at(tree, receiver.position, receiver.triangle, above, most_below, highest).distance;
    const Beyond::Below theirs = others.below(above, most_below, highest);
    const double hit = std::min(own, theirs.drop);
    if (!std::isfinite(hit)) return Ground{};
    const float drop = static_cast<float>(hit) - kAbove * depth;
    return Ground{beyond - glm::vec3(0.0f, 0.0f, drop), drop,
                  theirs.drop < own ? theirs.thickness / depth : -1.0f};
  };
  Fronts::Fall found;
  float most = 0.0f;
  for (const RimPosition::Part& part : place.parts) {
    if (part.weight < kMinPart) continue;
    const Rim& rim = rims.all()[part.rim];
    const glm::vec3 level_out = unit(glm::vec3(rim.out.x, rim.out.y, 0.0f));
    const glm::vec3 along = kBeside * depth * unit(rim.to - rim.from);
    Ground ground;
    float drop = std::numeric_limits<float>::infinity();
    for (const float distance : kBeyond) {
      const Ground next =
          usual_ground(part.foot + level_out * (distance * depth), along, ground_below);
      if (!std::isfinite(next.drop)) continue;
      // Beyond a gap, only a bridge meets the snow on the other side.
      if (!std::isfinite(drop) && may_bridge && distance > kBeyond[0]) break;
      // The surface beyond may be a slope, but not a further step.
      if (std::isfinite(drop) && std::abs(next.drop - drop) > kSlopeBelow * distance * depth) break;
      if (!std::isfinite(drop)) drop = next.drop;
      ground = next;
    }
    if (!std::isfinite(drop)) continue;
    found.weight += part.weight;
    if (part.weight <= most) continue;
    most = part.weight;
    found.drop = drop;
    found.other = ground.other;
    if (ground.other < 0.0f) found.at = lying_at(ground.at);
  }
  return found;
}

/// A front's constants but for its presence and what lies beyond the rim.
SnowFront front_in(const RimZones::Zone& here, const glm::vec2& wind, const glm::vec3& noise_shift,
                   float depth) {
  SnowFront front;
  front.distance = here.place.distance;
  front.below = here.place.below;
  front.bevel = here.place.strip;
  front.zone = here.support;
  front.far_zone = here.far;
  front.has_far = here.place.has_far ? 1.0f : 0.0f;
  front.support = here.place.support;
  front.full = 1.0f;
  front.outward = here.place.out;
  front.level_out = here.place.level_out;
  front.down = here.place.down;
  front.eave = std::clamp(-here.place.out.z, 0.0f, 1.0f) * front.has_far;
  const glm::vec3 support = here.place.distance >= 0.0f ? here.place.support : glm::vec3(0, 0, 1);
  const glm::vec3 lift = unit(0.7f * glm::vec3(0, 0, 1) + 0.3f * support);
  front.lift = lift / std::max(glm::dot(lift, support), 0.5f);
  const glm::vec3 at = here.place.foot / depth + noise_shift;
  front.noise_slow = std::clamp(layered_noise(at + 9.0f, {3.0f, 1.4f, 0.6f}, 0.75f), -1.3f, 1.3f);
  front.noise_fast = std::clamp(layered_noise(at + 31.0f, {2.4f, 1.2f, 0.7f}, 0.65f), -1.3f, 1.3f);
  front.noise_shoulder = layered_noise(at + 77.0f, {3.0f, 1.2f, 0.0f}, 0.6f);
  const float lee = glm::dot(glm::vec2(here.place.level_out), wind);
  front.lee = kLee * std::max(lee, 0.0f);
  return front;
}

}  // namespace

shared::SnowBehind Fronts::behind(size_t number, const std::vector<float>& height,
                                  float open_depth) const {
  const bool may_bridge = front[number].bridged > 0.0f;
  const Fall& below = fall[number];
  const float others = below.other * open_depth;
  float beyond = 0.0f;
  if (below.weight > 0.0f) {
    const float there = below.other < 0.0f ? below.at.of(height) / below.up : others;
    beyond = std::max(there - below.drop, 0.0f) * below.own_up * below.weight;
  }
  // The weights are 0 unless a rim of this receiver lies across.
  const float next = std::max(across[number].of(height), others * below.own_up);
  return {inland[number].of(height), may_bridge ? next : 0.0f, beyond};
}

float Fronts::presence(size_t number, const shared::SnowBehind& behind,
                       const shared::SnowJoin& join) const {
  const SnowFront& at = front[number];
  // Snow thinner than a bevel lies on it.
  const float covers = at.bevel > 0.0f
                           ? eased(behind.inland, kBareBevel * at.bevel, kCoveredBevel * at.bevel)
                           : 1.0f;
  const float own = at.presence * covers;
  return std::max(own, join.joined * std::min(own / kHardly, 1.0f));
}

float Fronts::goes_on(size_t number, const shared::SnowJoin& join, float depth) const {
  const SnowFront& at = front[number];
  if (at.presence <= 0.0f || depth <= 0.0f) return 0.0f;
  return join.joined * eased(std::abs(at.distance), kFarStep * depth, kNearStep * depth);
}

void Fronts::fill_hidden(std::vector<float>& thickness) const {
  const std::vector<float> own = thickness;
  for (const Hidden& one : hidden) {
    thickness[one.point] = std::max(own[one.point], one.beside.of(own));
  }
}

void smooth_joins(Fronts& fronts, const HeightSamples& samples) {
  std::vector<int32_t> front_of(samples.count(), -1);
  for (size_t f = 0; f < fronts.count(); ++f) front_of[fronts.point[f]] = static_cast<int32_t>(f);
  fronts.beside_begin.push_back(0);
  for (const int32_t p : fronts.point) {
    for (int32_t i = samples.neighbour_begin[p]; i < samples.neighbour_begin[p + 1]; ++i) {
      const int32_t other = front_of[samples.neighbour[i]];
      if (other >= 0) fronts.beside.push_back(other);
    }
    fronts.beside_begin.push_back(static_cast<int32_t>(fronts.beside.size()));
  }
  std::vector<glm::vec3> joins;
  for (const SnowFront& front : fronts.front) {
    joins.push_back(front.bridged * glm::vec3(1.0f, front.half_gap, front.half_step));
  }
  fronts.smooth(joins);
  for (size_t f = 0; f < fronts.count(); ++f) {
    SnowFront& front = fronts.front[f];
    front.bridged = joins[f].x;
    if (front.bridged <= 0.0f) continue;
    front.half_gap = joins[f].y / front.bridged;
    front.half_step = joins[f].z / front.bridged;
  }
}

glm::vec3 Fronts::blanket_offset(size_t number, const shared::SnowJoin& join,
                                 const std::vector<float>& shown, const glm::vec3& offset,
                                 const glm::vec3& up) const {
  const SnowFront& at = front[number];
  const bool is_far = at.distance < 0.0f;
  const float height = is_far ? edge[number].of(shown) : std::max(shown[point[number]], 0.0f);
  const float reach = join.bridged * at.half_gap;
  const float near = std::clamp(1.0f - at.distance / (kBlanketRun * at.zone), 0.0f, 1.0f);
  const float over = kBlanketOver * height;
  const float out = (reach + over) * near;
  // Level up to where the other side begins: no edge must show between them.
  const float beyond = std::clamp((out - at.distance - reach) / std::max(over, 1e-6f), 0.0f, 1.0f);
  // Along the slope of the blanket.
  const float slope = glm::dot(at.outward, up) / std::max(glm::dot(at.support, up), kCarriesBelow);
  const float dip = kBlanketDip * over * beyond * beyond + slope * out;
  if (!is_far) return offset + at.outward * out - at.support * dip;
  // Down to the far face: whatever the snow beyond leaves open, this closes.
  const float dive = eased(-at.distance, 0.0f, shared::kTucked * at.far_zone);
  const glm::vec3 to_rim = at.outward * (at.distance + at.below) - at.down * at.below;
  return glm::mix(to_rim + at.outward * out + at.support * (height - dip), offset, dive);
}

Fronts find_fronts(SurfacePoints& points, const std::vector<float>& area,
                   const std::vector<float>& thickness, const std::vector<RimZones::Zone>& zone,
                   const Rims& rims, const SurfaceMesh& receiver, const base::TriangleTree& tree,
                   const Beyond& beyond, const glm::vec2& wind, const glm::vec3& noise_shift,
                   float depth, bool needles) {
  Fronts fronts;
  const std::vector<uint8_t> sheltered = sheltered_points(points, tree, depth);
  const auto within_piece = [&](const glm::vec3& place) {
    const glm::dvec3 off = place + glm::vec3(0.0f, 0.0f, kOffFace * depth);
    return is_within(tree, receiver.position, receiver.triangle, off) || beyond.surround(off);
  };
  // Where snow can lie: in the open, or within a piece that stands there.
  constexpr uint8_t kLies = 1, kHidden = 2;
  std::vector<uint8_t> state(points.count(), 0);
  base::for_each_item(state.size(), 256, [&](size_t p) {
    const bool is_far = !zone[p].place.is_far_off && zone[p].share < -1e-3f;
    if (is_far || points.normal[p].z < kCarriesBelow) return;
    state[p] = within_piece(points.mesh.position[p]) ? kHidden : kLies;
  });
  std::vector<int32_t> behind_rims, middles, lie;
  for (size_t p = 0; p < points.count(); ++p) {
    if (state[p] != kLies) continue;
    lie.push_back(static_cast<int32_t>(p));
    const bool is_behind = !zone[p].place.is_far_off && zone[p].share > kInland;
    if (is_behind) behind_rims.push_back(static_cast<int32_t>(p));
    if (is_behind && zone[p].share > kMiddle) middles.push_back(static_cast<int32_t>(p));
  }
  const std::vector<glm::vec3>& position = points.mesh.position;
  const NearestPoints inland(position, std::move(behind_rims), sheltered, depth);
  const NearestPoints middle(position, std::move(middles), sheltered, depth);
  const NearestPoints lying(position, std::move(lie), sheltered, depth);
  fronts.counted.assign(points.count(), 1.0f);
  for (size_t p = 0; p < points.count(); ++p) {
    if (state[p] != kHidden) continue;
    fronts.counted[p] = 0.0f;
    const auto own = static_cast<int32_t>(p);
    const PointMean beside = lying.at(position[p], own, kFromHidden * depth, false);
    if (beside.point[0] != own) fronts.hidden.push_back({own, beside});
  }
  fronts.banks = find_banks(points, receiver, tree, lying, depth);
  // Below a rim over an upright face, the front has the shape.
  std::erase_if(fronts.banks, [&](const Bank& bank) {
    const RimPosition& place = zone[bank.point].place;
    return !place.is_far_off && rims.all()[place.parts[0].rim].far_normal.z < kSteepBank;
  });
  if (rims.all().empty()) return fronts;
  for (size_t p = 0; p < points.count(); ++p) {
    if (zone[p].place.is_far_off || zone[p].share < -1.6f) continue;
    // The zones of a narrow top end just before its middle.
    if (zone[p].share >= (zone[p].support < rim_zone(depth) ? 1.1f : 1.0f)) continue;
    fronts.point.push_back(static_cast<int32_t>(p));
  }
  fronts.front.resize(fronts.point.size());
  fronts.inland.resize(fronts.front.size());
  fronts.across.resize(fronts.front.size());
  fronts.fall.resize(fronts.front.size());
  base::for_each_item(fronts.front.size(), 64, [&](size_t f) {
    const auto p = static_cast<size_t>(fronts.point[f]);
    const RimZones::Zone& here = zone[p];
    shared::SnowFront& front = fronts.front[f];
    front = front_in(here, wind, noise_shift, depth);
    const Rims::Opposite opposite = rims.opposite(here.place, shared::kBridgedGap * depth);
    front.bridged = opposite.nearness;
    front.half_gap = 0.5f * opposite.gap + 0.0005f;
    front.half_step = 0.5f * opposite.step;

    // The tip of a needle counts as a rim but is too small for a front.
    // Under another piece there is no room for one either: a table's leg, a stone under a stone.
    const RimPosition::Part& first = here.place.parts[0];
    const glm::vec3 on_rim = first.foot - rims.all()[first.rim].out * (kNearRim * depth);
    const bool is_high = rims.all()[first.rim].far_extent > kCovered * depth;
    const bool is_covered = (is_high && !needles && is_sheltered(tree, on_rim, kCovered * depth)) ||
                            within_piece(on_rim);
    front.presence = is_covered ? 0.0f : eased(here.room / depth, 0.03f, 0.09f);
    const float farthest = front.presence > 0.0f ? 3.0f * depth : 0.0f;
    const auto own = static_cast<int32_t>(p);
    // A rim below another surface has the snow of its own shelter behind it.
    const bool shelter = is_covered || is_sheltered(tree, on_rim, depth);
    // Off the foot of a piece that stands on the top.
    float inwards = kBehind;
    glm::vec3 behind = here.place.foot - here.place.out * (here.support * inwards);
    while (inwards > 0.5f && within_piece(behind)) {
      inwards -= 0.2f;
      behind = here.place.foot - here.place.out * (here.support * (inwards - 0.2f));
    }
    PointMean& height = fronts.inland[f];
    height = {glm::ivec4(own), glm::vec4(1.0f, 0.0f, 0.0f, 0.0f)};
    if (front.presence > 0.0f) {
      if (inwards == kBehind) height = middle.at(behind, own, kMiddleReach * depth, shelter);
      const float reach = shelter ? farthest : kOpenReach * depth;
      if (height.point[0] == own) height = inland.at(behind, own, reach, shelter);
      if (height.point[0] == own) height = inland.at(behind, own, farthest, true);
    }
    if (front.presence > 0.0f) {
      const bool may_bridge = front.bridged > 0.0f;
      const auto lying_at = [&](const glm::vec3& place) {
        return lying.at(place, own, depth, shelter);
      };
      fronts.fall[f] =
          fall_beyond(here.place, rims, receiver, tree, beyond, may_bridge, depth, lying_at);
      Fronts::Fall& fall = fronts.fall[f];
      float up = 0.0f;
      for (int k = 0; k < 4; ++k) up += fall.at.weight[k] * points.normal[fall.at.point[k]].z;
      fall.up = std::max(up, kCarriesBelow);
      fall.own_up = std::max(here.place.support.z, kCarriesBelow);
      // Two meshes never fit to the millimetre: this one's snow goes on below the other's.
      if (!may_bridge && fall.other >= 0.0f) {
        front.bridged = fall.weight * eased(fall.drop, kFarBelow * depth, kNearBelow * depth);
        front.half_gap = kReachesOver * depth;
        front.half_step = -0.5f * fall.drop;
      }
    }
    if (opposite.nearness > 0.0f) {
      const glm::vec3 across = here.place.foot + glm::vec3(0.0f, 0.0f, opposite.step) +
                               here.place.level_out * (opposite.gap + here.support * kBehind);
      fronts.across[f] = inland.at(across, own, farthest, shelter);
    }
  });
  for (size_t p = 0; p < points.count(); ++p) {
    if (zone[p].place.is_far_off || zone[p].share < -1e-4f) continue;
    const float near = eased(zone[p].share, 1.15f, 0.6f);
    points.normal[p] = unit(glm::mix(points.normal[p], zone[p].place.support, near));
  }
  const std::vector<glm::vec3> upper = upper_normals(points.mesh);
  std::vector<Blanket::Member> members = find_feet(points.mesh.position, upper, rims, lying, depth);
  for (const Blanket::Member& foot : members) {
    if (foot.tucked > 0.0f) fronts.counted[foot.point] = 0.0f;
  }
  std::vector<int32_t> foot_of(points.count(), -1);
  for (size_t i = 0; i < members.size(); ++i) foot_of[members[i].point] = static_cast<int32_t>(i);
  for (size_t f = 0; f < fronts.count(); ++f) {
    const SnowFront& front = fronts.front[f];
    const Fronts::Fall& fall = fronts.fall[f];
    if (!(fall.weight > 0.0f || front.bridged > 0.0f)) continue;
    int32_t& at = foot_of[fronts.point[f]];
    if (at < 0) {
      at = static_cast<int32_t>(members.size());
      members.emplace_back();
      members.back().point = fronts.point[f];
    }
    members[at].front = static_cast<int32_t>(f);
    members[at].is_far = front.distance < 0.0f;
    if (fall.other < 0.0f) members[at].step = std::max(members[at].step, fall.drop * fall.weight);
    if (members[at].foot <= 0.0f && !members[at].is_far) {
      members[at].off = fronts.inland[f];
      members[at].in_shelter = sheltered[fronts.point[f]] != 0;
      members[at].filled = filled_behind(front.distance, depth) *
                           eased(members[at].step, kHighStep * depth, kLowStep * depth);
    }
  }
  fronts.edge.resize(fronts.count());
  base::for_each_item(fronts.count(), 64, [&](size_t f) {
    if (fronts.front[f].distance >= 0.0f || fronts.front[f].presence <= 0.0f) return;
    const RimPosition& place = zone[fronts.point[f]].place;
    const glm::vec3 rim = points.mesh.position[fronts.point[f]] +
                          place.out * (place.distance + place.below) - place.down * place.below;
    fronts.edge[f] = lying.at(rim, fronts.point[f], 0.6f * depth, false);
  });
  std::vector<int32_t> open = lying.chosen();
  std::erase_if(open, [&](int32_t p) { return sheltered[p] != 0; });
  fronts.blanket = Blanket(points, open, area, std::move(members), depth);
  if (!fronts.blanket.empty()) fronts.blanket.aim(points, upper, thickness, points.normal);
  fronts.room.resize(fronts.front.size());
  for (size_t f = 0; f < fronts.front.size(); ++f) fronts.room[f] = zone[fronts.point[f]].room;
  return fronts;
}

void find_presence(Fronts& fronts, const SurfacePoints& points, const HeightSamples& samples,
                   const std::vector<float>& thickness, const std::vector<float>& shown,
                   float depth) {
  for (size_t f = 0; f < fronts.front.size(); ++f) {
    if (fronts.inland[f].of(thickness) > kIsBare * depth) continue;
    fronts.inland[f] = {glm::ivec4(fronts.point[f]), glm::vec4(1.0f, 0.0f, 0.0f, 0.0f)};
  }
  // Snow on a narrow top lies as a dome after sliding. Upright fronts would hold more snow than the
  // map has.
  const auto foot_of = [&](size_t f) {
    const SnowFront& front = fronts.front[f];
    return points.mesh.position[fronts.point[f]] + front.outward * (front.distance + front.below) -
           front.down * front.below;
  };
  std::vector<glm::vec3> feet;
  std::vector<size_t> supports;
  for (size_t f = 0; f < fronts.front.size(); ++f) {
    if (fronts.front[f].distance < 0.0f) continue;
    feet.push_back(foot_of(f));
    supports.push_back(f);
  }
  const PointTree tree(std::move(feet));
  // What the zones hold, and what upright fronts would hold: sums over the points before each.
  std::vector<double> held{0.0}, upright{0.0};
  for (const int32_t i : tree.order()) {
    const size_t f = supports[i];
    const auto p = static_cast<size_t>(fronts.point[f]);
    held.push_back(held.back() + samples.area[p] * thickness[p]);
    upright.push_back(upright.back() + samples.area[p] * fronts.behind(f, thickness, depth).inland);
  }
  base::for_each_item(fronts.front.size(), 64, [&](size_t f) {
    SnowFront& front = fronts.front[f];
    const float full = std::clamp(1.5f * fronts.room[f], 0.05f * depth, depth);
    // A front needs snow behind the rim in the last frame.
    front.presence *= eased(fronts.behind(f, shown, depth).inland, 0.06f * full, 0.3f * full);
    if (front.presence <= 0.0f) return;
    double holds = 0.0, most = 0.0;
    tree.visit_within(foot_of(f), kFullnessReach * depth, [&](int32_t begin, int32_t end) {
      holds += held[end] - held[begin];
      most += upright[end] - upright[begin];
    });
    if (most <= 0.0) return;
    const float fullness = std::clamp(static_cast<float>(holds / most), 0.0f, 0.999f);
    front.full = std::max(fullness, kMinFull);
    const float wide = eased(fronts.room[f], kNarrowFront * depth, kWideFront * depth);
    const float more = glm::mix(kMoreSnow, kMoreOnWide, wide);
    front.presence *= std::min(more * fullness / (1.0f - fullness), 1.0f);
  });
  std::vector<float> presence;
  for (const SnowFront& front : fronts.front) presence.push_back(front.presence);
  fronts.smooth(presence);
  for (size_t f = 0; f < fronts.count(); ++f) fronts.front[f].presence = presence[f];
}

}  // namespace snowbough::snow
