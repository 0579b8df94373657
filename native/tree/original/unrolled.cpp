#include "tree/original/unrolled.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <tuple>

#include "base/triangle_tree.h"

namespace snowbough::tree {
namespace {

/// Tolerance for equal coordinates.
constexpr float kSameUv = 1e-3f;
/// A corner this much closer to the axis than the place has no direction: a tip.
constexpr double kOnAxis = 1e-3;
/// Number of steps after which a walk is checked for cycles; and the maximum number of steps. A
/// scan has hundreds of triangles along one rebuilt face.
constexpr int kSureSteps = 64;
constexpr int kMaxSteps = 16384;
/// A larger ratio between two nearby distances from the axis means another limb.
constexpr double kOtherLimb = 2.5;
/// Extrapolation beyond an open edge, in heights of the triangle there.
constexpr double kRunOn = 2.0;

using Flat = std::array<glm::dvec2, 3>;

double cross(const glm::dvec2& a, const glm::dvec2& b) {
  return a.x * b.y - a.y * b.x;
}

/// A triangle's corner around the place: x along the limb's circumference, y along the axis,
/// metres. The place is (0, 0).
struct Corner {
  glm::dvec2 at{0.0};
  /// Without a direction from the axis.
  bool on_axis = false;
};

/// The unrolled surroundings of a place.
class Surroundings {
 public:
  explicit Surroundings(const AxisPlace& place)
      : place_(place), radius_(glm::length(place.across)) {
    out_ = radius_ > 0.0 ? place.across / radius_ : glm::dvec3(0.0);
    side_ = glm::cross(place.along, out_);
  }

  Corner corner(const glm::dvec3& p) const {
    const glm::dvec3 from = p - place_.axis;
    const double x = glm::dot(from, side_), y = glm::dot(from, out_);
    Corner corner;
    corner.at.y = glm::dot(from, place_.along) - place_.beyond;
    corner.on_axis = x * x + y * y <= kOnAxis * kOnAxis * radius_ * radius_;
    if (!corner.on_axis) corner.at.x = std::atan2(x, y) * radius_;
    return corner;
  }

 private:
  const AxisPlace& place_;
  double radius_;
  glm::dvec3 out_, side_;
};

/// A triangle with these corners: one on the axis lies between the others.
Flat flat_of(const std::array<Corner, 3>& corners) {
  Flat flat{};
  double sum = 0.0;
  int count = 0;
  for (int k = 0; k < 3; ++k) {
    flat[k] = corners[k].at;
    if (corners[k].on_axis) continue;
    sum += flat[k].x;
    ++count;
  }
  for (int k = 0; k < 3; ++k) {
    if (corners[k].on_axis) flat[k].x = count > 0 ? sum / count : 0.0;
  }
  return flat;
}

/// Barycentric weights at (0, 0); NaN for a triangle without area.
std::array<double, 3> shares_at_origin(const Flat& flat) {
  const double area = cross(flat[1] - flat[0], flat[2] - flat[0]);
  return {cross(flat[1], flat[2]) / area, cross(flat[2], flat[0]) / area,
          cross(flat[0], flat[1]) / area};
}

/// Weights at the triangle's point nearest to (0, 0).
std::array<double, 3> nearest_shares(const Flat& flat) {
  const auto flat3 = [](const glm::dvec2& p) { return glm::dvec3(p, 0.0); };
  const glm::dvec3 near =
      base::nearest_on_triangle(glm::dvec3(0.0), {flat3(flat[0]), flat3(flat[1]), flat3(flat[2])});
  Flat moved = flat;
  for (glm::dvec2& corner : moved) corner -= glm::dvec2(near);
  return shares_at_origin(moved);
}

/// Distance from the axis of the point with these weights.
double radius_at(const AxisPlace& place, const std::array<glm::dvec3, 3>& corners,
                 const std::array<double, 3>& shares) {
  glm::dvec3 off = -place.axis;
  for (int k = 0; k < 3; ++k) off += corners[k] * shares[k];
  return glm::length(off - place.along * glm::dot(off, place.along));
}

bool finite(const std::array<double, 3>& shares) {
  return std::isfinite(shares[0] + shares[1] + shares[2]);
}

}  // namespace

Unrolled::Unrolled(const OriginalWood& wood) : wood_(wood), across_(wood.triangles.size()) {
  for (size_t p = 0; p + 1 < wood.piece_begin.size(); ++p) {
    join_edges(wood.piece_begin[p], wood.piece_begin[p + 1]);
  }
}

void Unrolled::join_edges(int32_t begin, int32_t end) {
  struct Edge {
    int32_t a, b, triangle, k;
  };
  std::vector<Edge> edges;
  edges.reserve(static_cast<size_t>(end - begin) * 3);
  for (int32_t t = begin; t < end; ++t) {
    for (int k = 0; k < 3; ++k) {
      const int32_t a = wood_.triangles[t][k], b = wood_.triangles[t][(k + 1) % 3];
      if (a != b) edges.push_back({std::min(a, b), std::max(a, b), t, k});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& e, const Edge& f) {
    return std::tie(e.a, e.b, e.triangle, e.k) < std::tie(f.a, f.b, f.triangle, f.k);
  });
  for (size_t i = 0; i < edges.size();) {
    size_t next = i + 1;
    while (next < edges.size() && edges[next].a == edges[i].a && edges[next].b == edges[i].b)
      ++next;
    // Where more than two triangles meet, they do not continue one another.
    if (next - i == 2) {
      const Edge &e = edges[i], &f = edges[i + 1];
      across_[e.triangle][e.k] = across(e.triangle, e.k, f.triangle, f.k);
      across_[f.triangle][f.k] = across(f.triangle, f.k, e.triangle, e.k);
    } else if (next - i > 2) {
      for (size_t j = i; j < next; ++j) across_[edges[j].triangle][edges[j].k].seam = true;
    }
    i = next;
  }
}

Unrolled::Across Unrolled::across(int32_t t, int k, int32_t u, int l) const {
  const bool same_way = wood_.triangles[t][k] == wood_.triangles[u][l];
  const auto& here = wood_.uvs[t];
  const auto& there = wood_.uvs[u];
  const glm::vec2 first = here[k] - there[same_way ? l : (l + 1) % 3];
  const glm::vec2 second = here[(k + 1) % 3] - there[same_way ? (l + 1) % 3 : l];
  const glm::vec2 shift = glm::round(first);
  const auto near = [&](const glm::vec2& difference) {
    const glm::vec2 off = glm::abs(difference - shift);
    return std::max(off.x, off.y) <= kSameUv;
  };
  return {u, shift, !near(first) || !near(second)};
}

UnrolledPlace Unrolled::walk(const AxisPlace& place, int32_t from) const {
  UnrolledPlace found;
  glm::vec2 shift(0.0f);
  int32_t at = from;
  int32_t before = -1;
  std::array<double, 3> shares{};
  const auto corners = [&](int32_t t) {
    const std::array<int32_t, 3>& v = wood_.triangles[t];
    return std::array<glm::dvec3, 3>{wood_.vertices[v[0]], wood_.vertices[v[1]],
                                     wood_.vertices[v[2]]};
  };
  // Brent's cycle detection: one place is remembered, each time twice as long.
  int32_t kept = -1;
  int keep_at = kSureSteps;
  const Surroundings surroundings(place);
  // Two of a neighbour's corners are known.
  const auto unroll = [&](int32_t t, int32_t known, const std::array<Corner, 3>& known_corners) {
    std::array<Corner, 3> result;
    for (int k = 0; k < 3; ++k) {
      const int32_t v = wood_.triangles[t][k];
      const auto& others = wood_.triangles[known];
      const auto same = std::find(others.begin(), others.end(), v);
      result[k] = t != known && same != others.end() ? known_corners[same - others.begin()]
                                                     : surroundings.corner(wood_.vertices[v]);
    }
    return result;
  };
  std::array<Corner, 3> here = unroll(from, from, {});
  Flat flat = flat_of(here);
  const Flat first_flat = flat;
  for (int step = 0;; ++step) {
    const bool circles = at == kept;
    if (step == keep_at) {
      kept = at;
      keep_at *= 2;
    }
    shares = shares_at_origin(flat);
    if (!finite(shares)) {
      shares = nearest_shares(flat);
      break;
    }
    // Across the edge that the place is farthest behind. Corner k is opposite to edge k + 1.
    int out = -1;
    double farthest = -1e-9;
    bool open = false;
    std::array<Corner, 3> there;
    Flat next_flat{};
    for (int k = 0; k < 3; ++k) {
      const Across& next = across_[at][(k + 1) % 3];
      if (shares[k] >= farthest) continue;
      open = open || (next.triangle < 0 && !next.seam);
      if (next.triangle < 0 || next.seam || next.triangle == before) continue;
      // Ignores a neighbour that folds back over this triangle.
      const std::array<Corner, 3> next_corners = unroll(next.triangle, at, here);
      const Flat beyond = flat_of(next_corners);
      const glm::dvec2 edge = flat[(k + 2) % 3] - flat[(k + 1) % 3];
      const glm::dvec2 start = flat[(k + 1) % 3];
      const double side = cross(edge, flat[k] - start);
      bool is_continued = false;
      for (const glm::dvec2& corner : beyond) {
        is_continued = is_continued || cross(edge, corner - start) * side < -1e-12 * side * side;
      }
      if (!is_continued) continue;
      out = k;
      farthest = shares[k];
      there = next_corners;
      next_flat = beyond;
    }
    if (out < 0 || circles || step == kMaxSteps) {
      const bool inside = *std::min_element(shares.begin(), shares.end()) >= -1e-9;
      const bool runs_on = open && *std::min_element(shares.begin(), shares.end()) >= -kRunOn;
      if (!inside && !runs_on) shares = nearest_shares(flat);
      break;
    }
    const Across& next = across_[at][(out + 1) % 3];
    shift += next.shift;
    before = at;
    at = next.triangle;
    here = there;
    flat = next_flat;
  }
  if (at != from) {
    // In a crotch of a forking surface the walk may have gone up the other limb.
    const std::array<double, 3> first = nearest_shares(first_flat);
    if (radius_at(place, corners(at), shares) >
        kOtherLimb * radius_at(place, corners(from), first)) {
      at = from;
      shares = first;
      shift = glm::vec2(0.0f);
    }
  }
  found.triangle = at;
  if (!finite(shares)) shares = {1.0, 0.0, 0.0};
  glm::dvec2 uv(shift);
  for (int k = 0; k < 3; ++k) uv += glm::dvec2(wood_.uvs[at][k]) * shares[k];
  found.uv = glm::vec2(uv);
  return found;
}

}  // namespace snowbough::tree
