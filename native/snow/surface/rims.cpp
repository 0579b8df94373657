#include "snow/surface/rims.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "base/group_by_key.h"
#include "snow/surface/face_parts.h"
#include "snow/surface/rim_finder.h"
#include "snow/surface/vectors.h"

namespace snowbough::snow {
namespace {

/// A point belongs to a rim's supporting or far face if the cosine between the normals of that face
/// and of the point's own face is at least this.
constexpr float kSameFace = 0.5f;
/// Greatest distance of a point from the plane of the rim's face, as a fraction of its distance to
/// the rim.
constexpr float kOffPlane = 0.55f;
/// Greatest part of the distance to a rim that may lie outwards of it, on the supporting face.
constexpr float kOutwards = 0.3f;
/// A point whose normal is this close to that of a rim's supporting or far face, as a cosine, lies
/// on that face and not on the strip between them.
constexpr float kOnFace = 0.996f;
/// Tolerance of positions on a strip, as a fraction of its width.
constexpr float kStripSlack = 0.15f;
/// Rims that are more than this many softnesses farther away than the nearest rim are ignored.
constexpr float kBlendRange = 4.0f;

float eased(float x, float from, float to) {
  const float t = std::clamp((x - from) / (to - from), 0.0f, 1.0f);
  return t * t * (3.0f - 2.0f * t);
}

glm::vec3 level(const glm::vec3& v) {
  return unit(glm::vec3(v.x, v.y, 0.0f));
}

glm::vec3 nearest_on(const Rim& rim, const glm::vec3& point) {
  const glm::vec3 along = rim.to - rim.from;
  const float share = glm::dot(point - rim.from, along) / glm::dot(along, along);
  return rim.from + std::clamp(share, 0.0f, 1.0f) * along;
}

/// True if a point, as seen from its nearest point of the rim, lies behind the end of the rim's
/// supporting face.
bool is_past_face(const Rim& rim, const glm::vec3& from_foot) {
  constexpr float kSlack = 1.1f;
  return -glm::dot(from_foot, rim.out) > kSlack * rim.extent + rim.strip_out + 1e-6f;
}

/// A point relative to one rim.
struct Beside {
  float distance = 0.0f;
  /// RimPosition::distance and RimPosition::below.
  float off = 0.0f, below = 0.0f;
};

/// True if the point lies on the rim's strip. Sets its position across it.
bool is_on_strip(const Rim& rim, const glm::vec3& from_foot, const glm::vec3& normal,
                 Beside& beside) {
  const float size = rim.strip_out + rim.strip_down;
  if (size <= 0.0f ||
      std::max(glm::dot(normal, rim.support), glm::dot(normal, rim.far_normal)) > kOnFace)
    return false;
  const float c = glm::dot(rim.out, rim.down);
  const float square = std::max(1.0f - c * c, 0.05f);
  const float x = -glm::dot(from_foot, rim.out), y = glm::dot(from_foot, rim.down);
  const float inwards = (x + c * y) / square, below = (y + c * x) / square;
  const float slack = kStripSlack * size;
  const glm::vec3 aside = from_foot + rim.out * inwards - rim.down * below;
  if (inwards < -slack || below < -slack || inwards > rim.strip_out + slack ||
      below > rim.strip_down + slack || glm::length(aside) > size + slack) {
    return false;
  }
  beside.below = std::max(below, 0.0f);
  beside.off = std::max(inwards, 0.0f) - beside.below;
  return true;
}

/// True if the point lies on a face of the rim.
bool is_beside(const Rim& rim, const glm::vec3& point, const glm::vec3& foot,
               const glm::vec3& normal, Beside& beside) {
  beside.distance = glm::distance(point, foot);
  if (is_on_strip(rim, point - foot, normal, beside)) return true;
  const float to_support = glm::dot(normal, rim.support);
  const float to_far = glm::dot(normal, rim.far_normal);
  const bool on_support = to_support >= to_far - 0.02f;
  if ((on_support ? to_support : to_far) < kSameFace) return false;
  // A point outwards of the rim lies on another face that is about as level.
  if (on_support && glm::dot(point - foot, rim.out) > kOutwards * beside.distance + 1e-6f)
    return false;
  if (on_support && is_past_face(rim, point - foot)) return false;
  const glm::vec3& plane = on_support ? rim.support : rim.far_normal;
  const float strip = rim.strip_out + rim.strip_down;
  if (std::abs(glm::dot(point - foot, plane)) > kOffPlane * beside.distance + strip + 1e-6f)
    return false;
  beside.off = on_support ? beside.distance : -beside.distance;
  beside.below = on_support ? 0.0f : beside.distance;
  return true;
}

}  // namespace

Rims::Rims(const SurfaceMesh& mesh, const base::TriangleTree& tree,
           const std::vector<int32_t>& shading, float reach, float far_reach, float strip)
    : part_of_triangle_(face_parts(mesh)), reach_(reach) {
  const std::vector<Rim> found =
      find_rims(mesh, tree, shading, part_of_triangle_, {2.0f * reach, far_reach, strip});
  const auto for_rims = [&](const auto& visit) {
    for (const Rim& rim : found) visit(rim.part, rim);
  };
  base::group_by_key(mesh.triangle.size(), for_rims, part_begin_, rims_);
  std::vector<CellGrid::Box> boxes;
  for (const Rim& rim : rims_) {
    boxes.push_back({glm::min(rim.from, rim.to), glm::max(rim.from, rim.to)});
  }
  grid_ = CellGrid(boxes, reach);
}

template <typename Visit>
void Rims::visit_near(const glm::vec3& point, int32_t part, const Visit& visit) const {
  // A part with few rims, such as a needle or a leaf, is searched in full: the cells around it hold
  // the rims of thousands of other parts.
  constexpr int32_t kFew = 48;
  const int32_t begin = part_begin_[static_cast<size_t>(part)];
  const int32_t end = part_begin_[static_cast<size_t>(part) + 1];
  // Slightly more, since distances are rounded.
  const glm::vec3 around(1.001f * reach_);
  if (end - begin <= kFew) {
    for (int32_t number = begin; number < end; ++number) {
      const Rim& rim = rims_[static_cast<size_t>(number)];
      const bool is_away = glm::any(glm::lessThan(glm::max(rim.from, rim.to) + around, point)) ||
                           glm::any(glm::greaterThan(glm::min(rim.from, rim.to) - around, point));
      if (!is_away) visit(number);
    }
    return;
  }
  grid_.visit(point - around, point + around, [&](int32_t number) {
    if (rims_[static_cast<size_t>(number)].part == part) visit(number);
  });
}

RimPosition Rims::place(const glm::vec3& point, const glm::vec3& normal, int32_t part,
                        float softness) const {
  struct Seen {
    int32_t rim;
    glm::vec3 foot;
    Beside beside;
  };
  thread_local std::vector<Seen> seen;
  seen.clear();
  float nearest = reach_;
  visit_near(point, part, [&](int32_t number) {
    const glm::vec3 foot = nearest_on(rims_[number], point);
    Beside beside;
    if (!is_beside(rims_[number], point, foot, normal, beside) || beside.distance >= reach_) return;
    nearest = std::min(nearest, beside.distance);
    seen.push_back({number, foot, beside});
  });
  RimPosition place;
  if (seen.empty()) return place;
  // A rim that overlaps several cells was visited once per cell. The result must not depend on the
  // order of the visits.
  std::sort(seen.begin(), seen.end(), [](const Seen& a, const Seen& b) {
    const float apart = a.beside.distance - b.beside.distance;
    return apart != 0.0f ? apart < 0.0f : a.rim < b.rim;
  });
  seen.erase(std::unique(seen.begin(), seen.end(),
                         [](const Seen& a, const Seen& b) { return a.rim == b.rim; }),
             seen.end());
  const Rim& first = rims_[seen.front().rim];
  const bool on_support = seen.front().beside.off >= 0.0f;
  float sum = 0.0f;
  size_t counted = 0;
  for (const Seen& one : seen) {
    if (one.beside.distance > nearest + kBlendRange * softness) break;
    const Rim& rim = rims_[one.rim];
    if ((one.beside.off >= 0.0f) != on_support) continue;
    const float weight = std::exp((nearest - one.beside.distance) / std::max(softness, 1e-6f)) *
                         eased(glm::dot(rim.out, first.out), -0.7f, -0.1f);
    place.out += weight * rim.out;
    place.level_out += weight * glm::vec3(rim.out.x, rim.out.y, 0.0f);
    place.down += weight * rim.down;
    place.foot += weight * one.foot;
    place.support += weight * rim.support;
    place.far_extent += weight * rim.far_extent;
    place.extent += weight * rim.extent;
    place.strip += weight * (rim.strip_out + rim.strip_down);
    if (counted < place.parts.size()) place.parts[counted++] = {one.rim, weight, one.foot};
    sum += weight;
  }
  float weights = 0.0f;
  for (const RimPosition::Part& one : place.parts) weights += one.weight;
  for (RimPosition::Part& one : place.parts) one.weight /= weights;
  place.is_far_off = false;
  place.distance = seen.front().beside.off;
  place.below = seen.front().beside.below;
  place.strip /= sum;
  place.strip_faces = first.strip_faces;
  place.out = unit(place.out);
  place.level_out = unit(place.level_out);
  const float down = glm::length(place.down / sum);
  place.down /= sum * std::max(down, 0.3f);
  place.foot /= sum;
  place.far_extent /= sum;
  place.extent /= sum;
  place.support = unit(place.support);
  place.has_far = first.far_normal != glm::vec3(0.0f);
  return place;
}

float Rims::distance(const glm::vec3& point, const glm::vec3& normal, int32_t part,
                     bool far_too) const {
  float nearest = reach_;
  visit_near(point, part, [&](int32_t number) {
    const Rim& rim = rims_[number];
    const bool may_carry = glm::dot(rim.support, normal) >= kSameFace;
    if (!may_carry && !(far_too && glm::dot(rim.far_normal, normal) >= kSameFace)) return;
    const glm::vec3 foot = nearest_on(rim, point);
    if (may_carry && is_past_face(rim, point - foot)) return;
    nearest = std::min(nearest, glm::distance(point, foot));
  });
  return nearest;
}

float Rims::room(const RimPosition& place, int32_t part, float most, bool narrow) const {
  constexpr int kSteps = 8;
  const auto clear = [&](float inwards) {
    return distance(place.foot - place.out * inwards, place.support, part, false);
  };
  // Steps past the middle of a narrow top would pass the top, too.
  const auto passes_middle = [&](float step) {
    if (clear(step) >= 0.999f * step) return false;
    float last = 0.0f;
    for (int k = 1; k <= kSteps; ++k) {
      const float here = clear(step * static_cast<float>(k) / kSteps);
      if (here < last - 0.05f * step) return true;
      last = here;
    }
    return false;
  };
  most = std::min(most, 0.5f * place.extent);
  float step = most / kSteps;
  while (narrow && step > 1e-3f * most && passes_middle(step)) step *= 0.5f;
  float room = 0.0f;
  float before = 0.0f;
  for (float inwards = step; inwards < most + 0.5f * step; inwards += step) {
    const float here = clear(inwards);
    if (here < before - 1e-6f) break;
    room = std::max(room, here);
    before = here;
    if (2.0f * step <= here && 16.0f * step <= most) step *= 2.0f;
  }
  return room;
}

Rims::Opposite Rims::opposite(const RimPosition& place, float most) const {
  constexpr float kMinPart = 0.05f;
  constexpr float kMinAlong = 0.6f;
  Opposite mean;
  float near = 0.0f;
  for (const RimPosition::Part& part : place.parts) {
    if (part.weight < kMinPart) continue;
    const Rim& rim = rims_[part.rim];
    const Opposite one = opposite_of(rim, part.foot, most);
    if (one.nearness <= 0.0f) continue;
    const float weight = part.weight * one.nearness;
    const float along = std::max(glm::dot(place.level_out, level(rim.out)), kMinAlong);
    mean.nearness += weight;
    mean.gap += weight * one.gap / along;
    mean.step += weight * one.step;
    near += weight;
  }
  if (near > 0.0f) {
    mean.gap /= near;
    mean.step /= near;
  }
  return mean;
}

Rims::Step Rims::step_above(const glm::vec3& point, const glm::vec3& normal, float reach,
                            float most) const {
  constexpr float kMinStep = 0.01f;
  Step found;
  float nearest = reach;
  const glm::vec3 around(reach, reach, 0.0f);
  grid_.visit(point - around, point + around + glm::vec3(0.0f, 0.0f, most), [&](int32_t number) {
    const Rim& rim = rims_[number];
    const glm::vec3 foot = nearest_on(rim, point);
    const glm::vec3 from = point - foot;
    const float height = -glm::dot(from, normal);
    // A rim lies above its own strip.
    const float least = std::max(kMinStep * most, rim.strip_out + rim.strip_down);
    if (height <= least || height > most) return;
    const glm::vec3 level_out = level(rim.out);
    const float out = glm::dot(from, level_out);
    const float aside = glm::length(glm::vec3(from.x, from.y, 0.0f) - out * level_out);
    const float away = std::abs(out) + aside;
    if (aside > 0.25f * reach || away > nearest || (away == nearest && found.height > 0.0f)) return;
    nearest = away;
    found = {height, out, foot, level_out};
  });
  return found;
}

Rims::Opposite Rims::opposite_of(const Rim& own, const glm::vec3& foot, float most) const {
  Opposite found;
  float best = 0.0f;
  const glm::vec3 level_out = level(own.out);
  const glm::vec3 around(most);
  grid_.visit(foot - around, foot + around, [&](int32_t number) {
    const Rim& rim = rims_[number];
    const float against = -glm::dot(rim.out, own.out);
    if (against < 0.5f) return;
    const glm::vec3 across = nearest_on(rim, foot) - foot;
    const float gap = glm::dot(across, level_out);
    if (gap < 0.0f || gap >= most) return;
    const float aside = glm::length(glm::vec3(across.x, across.y, 0.0f) - gap * level_out);
    // Each factor falls off gradually, so that bridges do not end abruptly.
    const float nearness = eased(aside, 0.5f * most, 0.1f * most) *
                           eased(std::abs(across.z), most, 0.4f * most) *
                           eased(against, 0.5f, 0.85f);
    const float worth = nearness * (1.0f - gap / most);
    if (worth > best) {
      best = worth;
      found = {nearness, gap, across.z};
    }
  });
  return found;
}

}  // namespace snowbough::snow
