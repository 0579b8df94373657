#include "tree/crossings/triangles.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

namespace snowbough::tree {
namespace {

/// A sum of non-overlapping doubles: the exact value of the additions.
class ExactSum {
 public:
  void add(double value) {
    int kept = 0;
    for (int i = 0; i < count_; ++i) {
      const double sum = value + terms_[i];
      const double part = sum - value;
      const double error = (value - (sum - part)) + (terms_[i] - part);
      value = sum;
      if (error != 0.0) {
        terms_[kept++] = error;
      }
    }
    terms_[kept++] = value;
    count_ = kept;
  }
  /// Adds a * b * c.
  void add_product(double a, double b, double c) {
    const double high = a * b;
    const double low = std::fma(a, b, -high);
    for (double part : {low, high}) {
      const double product = part * c;
      add(std::fma(part, c, -product));
      add(product);
    }
  }
  int sign() const {
    const double largest = terms_[count_ - 1];
    return largest > 0.0 ? 1 : largest < 0.0 ? -1 : 0;
  }

 private:
  std::array<double, 32> terms_{};
  int count_ = 0;
};

/// The exact sign if the rounded determinant cannot decide it; separate, so that the usual case can
/// be inlined.
[[gnu::noinline]] int exact_orientation(const glm::dvec3& u, const glm::dvec3& v,
                                        const glm::dvec3& w) {
  ExactSum sum;
  sum.add_product(u.x, v.y, w.z);
  sum.add_product(u.y, v.z, w.x);
  sum.add_product(u.z, v.x, w.y);
  sum.add_product(-u.z, v.y, w.x);
  sum.add_product(-u.x, v.z, w.y);
  sum.add_product(-u.y, v.x, w.z);
  return sum.sign();
}

inline int side_of_plane(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c,
                         const glm::dvec3& d) {
  const glm::dvec3 u = a - d, v = b - d, w = c - d;
  const double positive = u.x * v.y * w.z + u.y * v.z * w.x + u.z * v.x * w.y;
  const double negative = u.z * v.y * w.x + u.x * v.z * w.y + u.y * v.x * w.z;
  const double determinant = positive - negative;
  const double magnitude = std::abs(u.x * v.y * w.z) + std::abs(u.y * v.z * w.x) +
                           std::abs(u.z * v.x * w.y) + std::abs(u.z * v.y * w.x) +
                           std::abs(u.x * v.z * w.y) + std::abs(u.y * v.x * w.z);
  if (std::abs(determinant) > 1e-14 * magnitude) {
    return determinant > 0.0 ? 1 : -1;
  }
  if (magnitude == 0.0) {
    return 0;
  }
  return exact_orientation(u, v, w);
}

glm::dvec2 flatten(const glm::dvec3& p, int axis) {
  return axis == 0 ? glm::dvec2(p.y, p.z) : axis == 1 ? glm::dvec2(p.z, p.x) : glm::dvec2(p.x, p.y);
}

double turn(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Whether a segment in a triangle's plane has a part inside.
bool crosses_in_plane(const glm::dvec3& p, const glm::dvec3& q, const Triangle& t) {
  const glm::dvec3 normal = glm::abs(glm::cross(t[1] - t[0], t[2] - t[0]));
  const int axis = normal.x >= normal.y && normal.x >= normal.z ? 0 : normal.y >= normal.z ? 1 : 2;
  std::array<glm::dvec2, 3> corners = {flatten(t[0], axis), flatten(t[1], axis),
                                       flatten(t[2], axis)};
  if (turn(corners[0], corners[1], corners[2]) < 0.0) {
    std::swap(corners[1], corners[2]);
  }
  const glm::dvec2 a = flatten(p, axis), b = flatten(q, axis);
  // Clips the segment to the three edges' half planes.
  double begin = 0.0, end = 1.0;
  for (int k = 0; k < 3; ++k) {
    const double da = turn(corners[k], corners[(k + 1) % 3], a);
    const double db = turn(corners[k], corners[(k + 1) % 3], b);
    if (da <= 0.0 && db <= 0.0) {
      return false;
    }
    if (da < 0.0) {
      begin = std::max(begin, da / (da - db));
    } else if (db < 0.0) {
      end = std::min(end, da / (da - db));
    }
  }
  return end - begin > 1e-9;
}

bool segment_crosses(const glm::dvec3& p, const glm::dvec3& q, const Triangle& t) {
  const int side_p = side_of_plane(t[0], t[1], t[2], p);
  const int side_q = side_of_plane(t[0], t[1], t[2], q);
  if (side_p * side_q > 0) {
    return false;
  }
  if (side_p == 0 && side_q == 0) {
    return crosses_in_plane(p, q, t);
  }
  const int a = side_of_plane(p, q, t[0], t[1]);
  const int b = side_of_plane(p, q, t[1], t[2]);
  const int c = side_of_plane(p, q, t[2], t[0]);
  return (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
}

/// Whether `b` lies on one side of the plane of `a`: the usual case for opposite walls of a limb.
bool on_one_side(const Triangle& a, const Triangle& b) {
  const int side = side_of_plane(a[0], a[1], a[2], b[0]);
  return side != 0 && side_of_plane(a[0], a[1], a[2], b[1]) == side &&
         side_of_plane(a[0], a[1], a[2], b[2]) == side;
}

bool apart(const Triangle& a, const Triangle& b) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto [low_a, high_a] = std::minmax({a[0][axis], a[1][axis], a[2][axis]});
    const auto [low_b, high_b] = std::minmax({b[0][axis], b[1][axis], b[2][axis]});
    if (low_a > high_b || low_b > high_a) {
      return true;
    }
  }
  return false;
}

}  // namespace

int orientation(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c,
                const glm::dvec3& d) {
  return side_of_plane(a, b, c, d);
}

bool triangles_cross(const Triangle& a, const Triangle& b, const std::array<int, 3>& shared) {
  if (apart(a, b)) {
    return false;
  }
  const auto common = std::count_if(shared.begin(), shared.end(), [](int k) { return k >= 0; });
  if (common >= 3) {
    return true;
  }
  if (common == 2) {
    const int free_a = shared[0] < 0 ? 0 : shared[1] < 0 ? 1 : 2;
    const int edge_0 = (free_a + 1) % 3, edge_1 = (free_a + 2) % 3;
    const int free_b = 3 - shared[edge_0] - shared[edge_1];
    if (side_of_plane(a[0], a[1], a[2], b[free_b]) != 0) {
      return false;
    }
    const glm::dvec3 edge = a[edge_1] - a[edge_0];
    const glm::dvec3 to_a = glm::cross(edge, a[free_a] - a[edge_0]);
    const glm::dvec3 to_b = glm::cross(edge, b[free_b] - a[edge_0]);
    return glm::dot(to_a, to_b) > 0.0;
  }
  if (common == 1) {
    const int corner_a = shared[0] >= 0 ? 0 : shared[1] >= 0 ? 1 : 2;
    const int corner_b = shared[corner_a];
    // Off the other's plane except for the shared corner: the usual case for neighbours on a limb.
    const int side = side_of_plane(b[0], b[1], b[2], a[(corner_a + 1) % 3]);
    if (side != 0 && side_of_plane(b[0], b[1], b[2], a[(corner_a + 2) % 3]) == side) {
      return false;
    }
    return segment_crosses(a[(corner_a + 1) % 3], a[(corner_a + 2) % 3], b) ||
           segment_crosses(b[(corner_b + 1) % 3], b[(corner_b + 2) % 3], a);
  }
  if (on_one_side(a, b) || on_one_side(b, a)) {
    return false;
  }
  for (int k = 0; k < 3; ++k) {
    if (segment_crosses(a[k], a[(k + 1) % 3], b) || segment_crosses(b[k], b[(k + 1) % 3], a)) {
      return true;
    }
  }
  return false;
}

}  // namespace snowbough::tree
