#include "tree/surface/limb_hull.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/geometric.hpp>
#include <utility>

namespace snowbough::tree {
namespace {

std::vector<glm::dvec3> centres_of(const std::vector<Ring>& rings) {
  std::vector<glm::dvec3> centres;
  centres.reserve(rings.size());
  for (const Ring& ring : rings) {
    centres.push_back(ring.centre);
  }
  return centres;
}

}  // namespace

LimbHull::LimbHull(const std::vector<Ring>& rings) : centres_(centres_of(rings)) {
  for (const Ring& ring : rings) {
    corners_.push_back(ring.corner);
  }
  for (const StripTree::Node& node : centres_.nodes()) {
    thickest_.push_back(
        *std::max_element(corners_.begin() + node.begin, corners_.begin() + node.end + 1));
  }
}

bool LimbHull::cone_clears(size_t first, const glm::dvec3& point, double margin) const {
  const glm::dvec3 a = centres_.points()[first];
  const glm::dvec3 ab = centres_.points()[first + 1] - a;
  const double square = glm::dot(ab, ab);
  const double t = square > 0.0 ? std::clamp(glm::dot(point - a, ab) / square, 0.0, 1.0) : 0.0;
  const double corner = corners_[first] + (corners_[first + 1] - corners_[first]) * t;
  return glm::distance(point, a + ab * t) - corner > margin;
}

bool LimbHull::clears(const glm::dvec3& point, double margin) const {
  const std::vector<StripTree::Node>& nodes = centres_.nodes();
  const double enough = margin + centres_.rounding();
  const auto outside = [&](int32_t node) {
    return centres_.least_distance(nodes[node], point) - thickest_[node] * (1.0 + 1e-12);
  };
  if (nodes.empty() || outside(0) > enough) {
    return true;
  }
  // Runs are halved at most 31 times, each leaving one entry.
  std::array<int32_t, 40> stack{};
  size_t count = 1;
  while (count > 0) {
    const int32_t number = stack[--count];
    const StripTree::Node& node = nodes[number];
    if (node.second == 0) {
      for (int32_t i = node.begin; i < node.end; ++i) {
        if (!cone_clears(i, point, margin)) {
          return false;
        }
      }
      continue;
    }
    // The nearer half first: it more likely contains a cone that is not clear.
    std::pair<double, int32_t> near(outside(number + 1), number + 1);
    std::pair<double, int32_t> far(outside(node.second), node.second);
    if (far < near) {
      std::swap(near, far);
    }
    for (const auto& [distance, half] : {far, near}) {
      if (distance <= enough) {
        stack[count++] = half;
      }
    }
  }
  return true;
}

}  // namespace snowbough::tree
