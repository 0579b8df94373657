#include "tree/tubes/limb_shape.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace snowbough::tree {
namespace {

/// Minimum distance of a hole's corners from the edges of their side.
constexpr double kMinMargin = 0.02;
/// A joint closer to a ring than this fraction of the row coincides with it.
constexpr double kAtRing = 1e-3;
/// Minimum radius between two rings, relative to the thinner one's.
constexpr double kThinnest = 0.7;

/// A ring's directions to its corners 0 and 1, made perpendicular. For a skewed hole both are
/// corrected equally.
Frame frame_of(const Ring& ring, const std::vector<glm::dvec3>& vertices) {
  const glm::dvec3 first = glm::normalize(vertices[ring.vertices[0]] - ring.centre);
  const glm::dvec3 second = glm::normalize(vertices[ring.vertices[1]] - ring.centre);
  Frame frame;
  frame.normal = glm::normalize(glm::cross(first, second));
  frame.u = glm::normalize(first + glm::cross(second, frame.normal));
  frame.v = glm::cross(frame.normal, frame.u);
  return frame;
}

/// The largest angle between the sides of a ring and those of a limb along the frame's normal, seen
/// along it.
double largest_turn(const Ring& ring, const Frame& limb, const std::vector<glm::dvec3>& vertices) {
  const std::array<glm::dvec3, 4> sides = {limb.v - limb.u, -limb.u - limb.v, limb.u - limb.v,
                                           limb.u + limb.v};
  double largest = 0.0;
  for (int k = 0; k < 4; ++k) {
    const glm::dvec3 edge = vertices[ring.vertices[(k + 1) % 4]] - vertices[ring.vertices[k]];
    const glm::dvec3 seen = edge - limb.normal * glm::dot(edge, limb.normal);
    const double sine = glm::length(glm::cross(seen, sides[k]));
    largest = std::max(largest, std::atan2(sine, glm::dot(seen, sides[k])));
  }
  return largest;
}

}  // namespace

LimbShape::LimbShape(const LimbPath& path, const LimbSurface& limb,
                     const std::vector<glm::dvec3>& vertices, const glm::dvec3& before,
                     const glm::dvec3& after, double thin_stray)
    : curve_(path, before, after, thin_stray) {
  for (const Ring& ring : limb.rings) {
    RingShape& shape = rings_.emplace_back();
    shape.length = ring.bone_length;
    // A ring of the base on the straight segments is moved to the curve.
    shape.offset = ring.centre - curve_.straight_position(ring.bone_length);
    shape.corner = ring.corner;
    shape.corner_offset = ring.corner - curve_.straight_corner(ring.bone_length);
    shape.frame = frame_of(ring, vertices);
  }
  if (!limb.continues_parent && rings_.size() > 1) {
    // The hole is skewed; the limb around it is as round as at its first own ring.
    rings_[0].frame = rings_[1].frame;
    const glm::dvec3 vector = centre(0, 1.0) - centre(0, 0.0);
    const Frame& next = rings_[1].frame;
    const double length = glm::length(vector);
    hole_twist_ = largest_turn(limb.rings[0],
                               length > 0.0 ? transport(next, vector / length) : next, vertices);
  }
}

double LimbShape::length_at(size_t row, double v) const {
  return rings_[row].length + (rings_[row + 1].length - rings_[row].length) * v;
}

glm::dvec3 LimbShape::centre(size_t row, double v) const {
  return curve_.position(length_at(row, v)) + rings_[row].offset * (1.0 - v) +
         rings_[row + 1].offset * v;
}

double LimbShape::radius(size_t row, double v) const {
  const RingShape& a = rings_[row];
  const RingShape& b = rings_[row + 1];
  const double corner =
      curve_.corner(length_at(row, v)) + a.corner_offset * (1.0 - v) + b.corner_offset * v;
  return std::max(corner, kThinnest * std::min(a.corner, b.corner)) * std::sqrt(2.0 / M_PI);
}

Frame LimbShape::frame(size_t row, double v, const glm::dvec3& tangent) const {
  const Frame low = transport(rings_[row].frame, tangent);
  const Frame high = transport(rings_[row + 1].frame, tangent);
  const double twist = v * std::atan2(glm::dot(high.u, low.v), glm::dot(high.u, low.u));
  const glm::dvec3 u = low.u * std::cos(twist) + low.v * std::sin(twist);
  return {u, glm::cross(tangent, u), tangent};
}

std::vector<double> LimbShape::joints(size_t row) const {
  const double low = rings_[row].length, length = rings_[row + 1].length - low;
  std::vector<double> shares;
  for (const double s : curve_.joints()) {
    const double share = length > 0.0 ? (s - low) / length : 0.0;
    if (share > kAtRing && share < 1.0 - kAtRing) shares.push_back(share);
  }
  return shares;
}

std::vector<LimbShape> limb_shapes(const Surface& surface, const std::vector<LimbPath>& paths,
                                   const std::vector<int32_t>& parents, double thin_stray) {
  std::vector<glm::dvec3> before(paths.size(), glm::dvec3(0.0)), after(before);
  for (size_t b = 0; b < paths.size(); ++b) {
    if (surface.limbs[b].continues_parent) {
      before[b] = direction_at(paths[parents[b]], paths[parents[b]].length());
      after[parents[b]] = direction_at(paths[b], 0.0);
    }
  }
  std::vector<LimbShape> shapes;
  shapes.reserve(paths.size());
  for (size_t b = 0; b < paths.size(); ++b) {
    shapes.emplace_back(paths[b], surface.limbs[b], surface.vertices, before[b], after[b],
                        thin_stray);
  }
  return shapes;
}

HolePlace hole_place(const Surface& surface, const Junction& junction) {
  HolePlace place;
  place.parent = junction.parent;
  place.row = junction.row;
  place.side = junction.side;
  place.inset = junction.inset;
  if (!junction.inset) return place;
  const LimbSurface& parent = surface.limbs[junction.parent];
  const Ring& low = parent.rings[junction.row];
  const Ring& high = parent.rings[junction.row + 1];
  const int after = (junction.side + 1) % 4;
  const auto point = [&](int32_t vertex) { return surface.vertices[vertex]; };
  const glm::dvec3 p0 = point(low.vertices[junction.side]), p1 = point(low.vertices[after]);
  const glm::dvec3 p2 = point(high.vertices[after]), p3 = point(high.vertices[junction.side]);
  const glm::dvec3 across = 0.5 * (p1 + p2 - p0 - p3), along = 0.5 * (p2 + p3 - p0 - p1);
  const glm::dvec3 middle = 0.25 * (p0 + p1 + p2 + p3);
  const auto share = [](const glm::dvec3& p, const glm::dvec3& axis, double low_end) {
    return std::clamp(0.5 + glm::dot(p, axis) / glm::dot(axis, axis), low_end, 1.0 - low_end);
  };
  const Ring& hole = surface.limbs[junction.child].rings.front();
  for (int k = 0; k < 4; ++k) {
    const glm::dvec3 p = point(hole.vertices[k]) - middle;
    const double x = 2.0 * share(p, across, kMinMargin) - 1.0;
    place.corners[k] = {0.5 + 2.0 / M_PI * std::atan(x), share(p, along, kMinMargin)};
  }
  return place;
}

}  // namespace snowbough::tree
