#include "tree/rings/square_links.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

namespace snowbough::tree {
namespace {

/// Minimum cosine between a plane's normal and a link.
constexpr double kAcross = 0.5;
/// Cost of a link for each of its planes that it meets obliquely (per 1 - cosine), and for a jump
/// of the radius (per e-fold, at most two). Chosen on AL06a with its squares shuffled, where 20 to
/// 30 are best.
constexpr double kSlantCost = 25.0;
constexpr double kRadiusCost = 0.7;
/// Number of best links stored per plane and side.
constexpr size_t kBest = 12;
/// A plane is between two others if the path through it is no longer than this factor, ...
constexpr double kDetour = 1.08;
/// ... it is met at no smaller cosine than this, and its radius is within these factors of their
/// radii.
constexpr double kSquarely = 0.85;
constexpr double kThinner = 0.7;
constexpr double kThicker = 1.4;

}  // namespace

std::vector<Plane> planes_of(std::span<const CrossSection> sections) {
  const Limb limb = limb_from_cross_sections(sections);
  std::vector<Plane> planes(sections.size());
  for (size_t i = 0; i < sections.size(); ++i) {
    planes[i].centre = limb.points[i];
    planes[i].radius = limb.radii[i];
    const std::vector<glm::vec3>& corners = sections[i].corners;
    for (size_t c = 1; c + 1 < corners.size(); ++c) {
      planes[i].normal +=
          glm::cross(glm::dvec3(corners[c] - corners[0]), glm::dvec3(corners[c + 1] - corners[0]));
    }
    const double length = glm::length(planes[i].normal);
    planes[i].normal = length > 0.0 ? planes[i].normal / length : glm::dvec3(0.0);
  }
  return planes;
}

Links::Links(const std::vector<Plane>& planes) : planes_(planes), best_(planes.size()) {
  glm::dvec3 low(1e300), high(-1e300);
  for (const Plane& plane : planes) {
    low = glm::min(low, plane.centre);
    high = glm::max(high, plane.centre);
  }
  const glm::dvec3 extent = high - low;
  const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
  std::vector<uint32_t> order(planes.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
    return planes[a].centre[axis] < planes[b].centre[axis];
  });
  for (size_t at = 0; at < order.size(); ++at) {
    const uint32_t i = order[at];
    // A link costs at least its length, so nothing beyond the worst stored one can be better.
    const auto far = [&](uint32_t j) {
      return std::abs(planes[j].centre[axis] - planes[i].centre[axis]) > limit(i);
    };
    for (size_t next = at + 1; next < order.size() && !far(order[next]); ++next) {
      consider(i, order[next]);
    }
    for (size_t next = at; next-- > 0 && !far(order[next]);) consider(i, order[next]);
  }
}

std::vector<Link> Links::sorted() const {
  std::vector<Link> all;
  for (const auto& sides : best_) {
    for (const std::vector<Link>& side : sides) all.insert(all.end(), side.begin(), side.end());
  }
  std::sort(all.begin(), all.end(), [](const Link& a, const Link& b) {
    return std::tie(a.cost, a.from, a.to) < std::tie(b.cost, b.from, b.to);
  });
  return all;
}

bool Links::passes_through_another(const Link& link) const {
  const Plane& a = planes_[link.from];
  const Plane& b = planes_[link.to];
  const double thin = kThinner * std::min(a.radius, b.radius);
  const double thick = kThicker * std::max(a.radius, b.radius);
  const std::vector<Link>& from = best_[link.from][link.from_side];
  return std::any_of(from.begin(), from.end(), [&](const Link& first) {
    if (first.to == link.to) return false;
    const Plane& between = planes_[first.to];
    const glm::dvec3 in = between.centre - a.centre, out = b.centre - between.centre;
    const double there = glm::length(in), on = glm::length(out);
    return there > 0.0 && on > 0.0 && there + on <= kDetour * link.length &&
           between.radius >= thin && between.radius <= thick &&
           between.across(in / there) >= kSquarely && between.across(out / on) >= kSquarely;
  });
}

double Links::limit(uint32_t i) const {
  double worst = 0.0;
  for (int side = 0; side < (planes_[i].has_normal() ? 2 : 1); ++side) {
    if (best_[i][side].size() < kBest) return 1e300;
    worst = std::max(worst, best_[i][side].back().cost);
  }
  return worst;
}

void Links::consider(uint32_t i, uint32_t j) {
  const Plane& a = planes_[i];
  const Plane& b = planes_[j];
  const glm::dvec3 step = b.centre - a.centre;
  const double length = glm::length(step);
  if (length == 0.0) return;
  const double first = a.across(step / length), second = b.across(step / length);
  if (first < kAcross || second < kAcross) return;
  const double smallest = 1e-6 * length;
  const double jump =
      std::abs(std::log(std::max(a.radius, smallest) / std::max(b.radius, smallest)));
  Link link;
  link.cost =
      length * std::exp(kSlantCost * (2.0 - first - second) + kRadiusCost * std::min(jump, 2.0));
  link.from = i;
  link.to = j;
  link.from_side = static_cast<uint8_t>(a.side(step));
  link.to_side = static_cast<uint8_t>(b.side(-step));
  link.length = length;
  std::vector<Link>& best = best_[i][link.from_side];
  const auto place = std::upper_bound(best.begin(), best.end(), link,
                                      [](const Link& x, const Link& y) { return x.cost < y.cost; });
  best.insert(place, link);
  if (best.size() > kBest) best.pop_back();
}

}  // namespace snowbough::tree
