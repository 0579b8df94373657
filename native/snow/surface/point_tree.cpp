#include "snow/surface/point_tree.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace snowbough::snow {
namespace {

/// Greatest number of points in a leaf.
constexpr int32_t kLeaf = 8;

}  // namespace

PointTree::PointTree(std::vector<glm::vec3> points)
    : points_(std::move(points)), order_(points_.size()) {
  std::iota(order_.begin(), order_.end(), 0);
  if (!points_.empty()) build(0, static_cast<int32_t>(points_.size()));
}

void PointTree::build(int32_t begin, int32_t end) {
  glm::vec3 low = points_[order_[begin]], high = low;
  for (int32_t i = begin; i < end; ++i) {
    low = glm::min(low, points_[order_[i]]);
    high = glm::max(high, points_[order_[i]]);
  }
  const size_t number = nodes_.size();
  nodes_.push_back({low, high, begin, end, -1});
  if (end - begin <= kLeaf) return;
  const glm::vec3 size = high - low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const int32_t middle = begin + (end - begin) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                   [&](int32_t a, int32_t b) {
                     const float p = points_[a][axis], q = points_[b][axis];
                     return p != q ? p < q : a < b;
                   });
  build(begin, middle);
  nodes_[number].second = static_cast<int32_t>(nodes_.size());
  build(middle, end);
}

std::array<PointTree::Found, 4> PointTree::nearest(const glm::vec3& place, float reach) const {
  // A place without a point is as far as the reach, which no point may have.
  std::array<Found, 4> found;
  found.fill({reach, -1});
  if (!nodes_.empty()) find(0, place, found);
  return found;
}

void PointTree::find(int32_t number, const glm::vec3& place, std::array<Found, 4>& found) const {
  const auto distance_to = [&](int32_t n) {
    const glm::vec3 off = glm::max(nodes_[n].low - place, place - nodes_[n].high);
    return glm::length(glm::max(off, 0.0f));
  };
  const Node& node = nodes_[number];
  if (node.second < 0) {
    for (int32_t i = node.begin; i < node.end; ++i) {
      const Found one{glm::distance(points_[order_[i]], place), order_[i]};
      const auto is_before = [](const Found& a, const Found& b) {
        return a.distance != b.distance ? a.distance < b.distance : a.point < b.point;
      };
      if (!is_before(one, found.back())) continue;
      const auto at = std::upper_bound(found.begin(), found.end(), one, is_before);
      std::move_backward(at, found.end() - 1, found.end());
      *at = one;
    }
    return;
  }
  std::array<int32_t, 2> child{number + 1, node.second};
  std::array<float, 2> away{distance_to(child[0]), distance_to(child[1])};
  if (away[1] < away[0]) {
    std::swap(child[0], child[1]);
    std::swap(away[0], away[1]);
  }
  for (const int k : {0, 1}) {
    if (away[k] <= found.back().distance) find(child[k], place, found);
  }
}

}  // namespace snowbough::snow
