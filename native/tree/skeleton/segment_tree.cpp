#include "tree/skeleton/segment_tree.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <tuple>
#include <utility>

namespace snowbough::tree {
namespace {

using base::bits;
using base::Float4;
using base::four;
using base::Int4;
using base::larger;
using base::smaller;
using base::square_root;

constexpr int32_t kLeafSize = 8;
/// Weight of the distance to the centreline relative to the distance to the surface.
constexpr double kInsideShare = 0.05;
/// Relative margin for decisions in floats: more than their rounding.
constexpr float kSpare = 1e-5f;
/// Distances are clamped to this, so that their squares do not overflow.
constexpr float kFar = 1e18f;
/// Smaller squared lengths count as zero: their inverse would overflow.
constexpr float kNoLength = 1e-30f;
constexpr int32_t kLastOrder = std::numeric_limits<int32_t>::max();

Float4 clamped(const Float4& v, float low, float high) {
  return smaller(larger(v, four(low)), four(high));
}

}  // namespace

SegmentTree::SegmentTree(const std::vector<Branch>& branches, std::vector<int32_t> order,
                         float radius_floor)
    : order_(std::move(order)), radius_floor_(radius_floor) {
  for (size_t b = 0; b < branches.size(); ++b) {
    const Branch& branch = branches[b];
    const size_t last = branch.points.size() == 1 ? 1 : branch.points.size() - 1;
    for (size_t i = 0; i < last && !branch.points.empty(); ++i) {
      const size_t j = std::min(i + 1, branch.points.size() - 1);
      segments_.push_back({branch.points[i], branch.points[j], branch.radii[i], branch.radii[j],
                           static_cast<int32_t>(b), static_cast<int32_t>(i)});
    }
  }
  if (!segments_.empty()) {
    nodes_.reserve(segments_.size() / 12 + 2);
    fours_.reserve(segments_.size() / 3 + 2);
    build(0, static_cast<int32_t>(segments_.size()));
  }
}

/// Sorts the segments [begin, end) into two halves along their longer extent.
/// @return where the second begins; `end` if they are few enough for one leaf.
int32_t SegmentTree::split(int32_t begin, int32_t end) {
  if (end - begin <= kLeafSize) {
    return end;
  }
  glm::vec3 low(std::numeric_limits<float>::max());
  glm::vec3 high(std::numeric_limits<float>::lowest());
  for (int32_t i = begin; i < end; ++i) {
    low = glm::min(low, glm::min(segments_[i].a, segments_[i].b));
    high = glm::max(high, glm::max(segments_[i].a, segments_[i].b));
  }
  const glm::vec3 size = high - low;
  int axis = size.y > size.x ? 1 : 0;
  if (size.z > size[axis]) axis = 2;
  const int32_t middle = begin + (end - begin) / 2;
  std::nth_element(segments_.begin() + begin, segments_.begin() + middle, segments_.begin() + end,
                   [axis](const Segment& s, const Segment& t) {
                     const float ms = s.a[axis] + s.b[axis];
                     const float mt = t.a[axis] + t.b[axis];
                     return std::tie(ms, s.branch, s.segment) < std::tie(mt, t.branch, t.segment);
                   });
  return middle;
}

int32_t SegmentTree::build(int32_t begin, int32_t end) {
  const auto number = static_cast<int32_t>(nodes_.size());
  nodes_.emplace_back();
  Node node{};
  node.order += kLastOrder;
  const int32_t middle = split(begin, end);
  const std::array<int32_t, 5> bounds = {begin, split(begin, middle), middle, split(middle, end),
                                         end};
  for (int k = 0; k < 4; ++k) {
    const int32_t from = bounds[k], to = bounds[k + 1];
    if (from == to) {
      continue;
    }
    glm::vec3 low(std::numeric_limits<float>::max());
    glm::vec3 high(std::numeric_limits<float>::lowest());
    for (int32_t i = from; i < to; ++i) {
      const Segment& s = segments_[i];
      low = glm::min(low, glm::min(s.a, s.b));
      high = glm::max(high, glm::max(s.a, s.b));
      node.radius[k] = std::max(node.radius[k], std::max(s.radius_a, s.radius_b));
      node.order[k] = std::min(node.order[k], order_[s.branch]);
    }
    for (int axis = 0; axis < 3; ++axis) {
      node.low[axis][k] = low[axis];
      node.high[axis][k] = high[axis];
    }
    if (to - from <= kLeafSize) {
      node.child[k] = static_cast<int32_t>(fours_.size());
      add_fours(from, to);
      node.count[k] = static_cast<int32_t>(fours_.size()) - node.child[k];
    } else {
      node.child[k] = build(from, to);
    }
  }
  nodes_[number] = node;
  return number;
}

void SegmentTree::add_fours(int32_t begin, int32_t end) {
  for (int32_t first = begin; first < end; first += 4) {
    Four fours{};
    fours.order += kLastOrder;
    fours.first = first;
    for (int32_t k = 0; k < std::min(4, end - first); ++k) {
      const Segment& s = segments_[first + k];
      const glm::vec3 along = s.b - s.a;
      for (int axis = 0; axis < 3; ++axis) {
        fours.from[axis][k] = s.a[axis];
        fours.along[axis][k] = along[axis];
      }
      const float squared = glm::dot(along, along);
      const bool none = !(squared > kNoLength && squared < kFar);
      fours.inverse[k] = none ? 0.0f : 1.0f / squared;
      fours.slack[k] = std::sqrt(squared) * (none ? 2.0f : kSpare);
      fours.radius[k] = std::max(s.radius_a, s.radius_b);
      fours.order[k] = order_[s.branch];
    }
    fours_.push_back(fours);
  }
}

/// One search through the tree.
class SegmentTree::Search {
 public:
  Search(const SegmentTree& tree, const glm::vec3& point, int32_t below_order, Measure measure,
         const std::vector<char>* excluded, double limit)
      : tree_(tree),
        point_(point),
        lanes_{four(point.x), four(point.y), four(point.z)},
        below_order_(Int4{} + below_order),
        measure_(measure),
        excluded_(excluded) {
    best_.cost = limit;
  }

  NearestSegment run() {
    // The stack never holds more than three siblings per level, and the tree is balanced.
    std::array<PendingNode, 96> stack;
    size_t depth = 0;
    if (!tree_.nodes_.empty()) stack[depth++] = {0.0f, 0, 0};
    while (depth > 0) {
      const PendingNode next = stack[--depth];
      if (next.bound > best_.cost) continue;
      if (next.count > 0) {
        for (int32_t i = next.number; i < next.number + next.count; ++i) look_at(tree_.fours_[i]);
        continue;
      }
      const Node& node = tree_.nodes_[next.number];
      const Float4 bound = bounds(node);
      const size_t before = depth;
      for (uint32_t lanes = bits(node.order < below_order_); lanes != 0; lanes &= lanes - 1) {
        const int k = std::countr_zero(lanes);
        if (bound[k] > best_.cost) continue;
        // The nearest on top.
        size_t at = depth++;
        for (; at > before && stack[at - 1].bound < bound[k]; --at) stack[at] = stack[at - 1];
        stack[at] = {bound[k], node.child[k], node.count[k]};
      }
    }
    return best_;
  }

 private:
  /// A node (count 0) or some of fours_, and their minimum cost.
  struct PendingNode {
    float bound;
    int32_t number, count;
  };

  /// Lower bound of the cost of limbs at `distance` with `radius`.
  Float4 least_cost(const Float4& distance, const Float4& radius) const {
    switch (measure_) {
      case Measure::kRadii:
        return distance / (radius + tree_.radius_floor_) * (1.0f - kSpare);
      case Measure::kSurface: {
        const Float4 outside = distance - radius * (1.0f + kSpare);
        return larger(outside, Float4{}) +
               distance * static_cast<float>(kInsideShare) * (1.0f - kSpare);
      }
      default:
        return distance;
    }
  }

  Float4 bounds(const Node& node) const {
    Float4 squared = {};
    for (int axis = 0; axis < 3; ++axis) {
      const Float4 outside =
          larger(larger(node.low[axis] - lanes_[axis], lanes_[axis] - node.high[axis]), Float4{});
      squared += outside * outside;
    }
    return least_cost(smaller(square_root(squared), four(kFar)) * (1.0f - kSpare), node.radius);
  }

  void look_at(const Four& fours) {
    std::array<Float4, 3> to{};
    Float4 dot = {};
    for (int axis = 0; axis < 3; ++axis) {
      to[axis] = lanes_[axis] - fours.from[axis];
      dot += to[axis] * fours.along[axis];
    }
    const Float4 t = clamped(dot * fours.inverse, 0.0f, 1.0f);
    Float4 squared = {};
    for (int axis = 0; axis < 3; ++axis) {
      const Float4 off = to[axis] - t * fours.along[axis];
      squared += off * off;
    }
    const Float4 distance = square_root(squared) * (1.0f - kSpare) - fours.slack;
    const Float4 bound = least_cost(clamped(distance, 0.0f, kFar), fours.radius);
    for (uint32_t lanes = bits(fours.order < below_order_); lanes != 0; lanes &= lanes - 1) {
      const int k = std::countr_zero(lanes);
      if (!(bound[k] > best_.cost)) look_at(tree_.segments_[fours.first + k]);
    }
  }

  double cost_of(double distance, double radius) const {
    switch (measure_) {
      case Measure::kRadii:
        return distance / (radius + tree_.radius_floor_);
      case Measure::kSurface:
        return std::max(distance - radius, 0.0) + kInsideShare * distance;
      default:
        return distance;
    }
  }

  void look_at(const Segment& s) {
    if (excluded_ != nullptr && (*excluded_)[s.branch]) return;
    const glm::dvec3 point(point_), a(s.a);
    const glm::dvec3 along = glm::dvec3(s.b) - a;
    const double squared = glm::dot(along, along);
    const double t =
        squared > 0.0 ? std::clamp(glm::dot(point - a, along) / squared, 0.0, 1.0) : 0.0;
    const glm::dvec3 foot = a + t * along;
    const double distance = glm::length(point - foot);
    const auto radius = static_cast<float>(s.radius_a + t * (s.radius_b - s.radius_a));
    const double cost = cost_of(distance, radius);
    if (cost < best_.cost || (cost == best_.cost && std::tie(s.branch, s.segment) <
                                                        std::tie(best_.branch, best_.segment))) {
      best_ = {
          s.branch, s.segment, static_cast<float>(t), glm::vec3(foot), static_cast<float>(distance),
          radius,   cost};
    }
  }

  const SegmentTree& tree_;
  glm::vec3 point_;
  /// The point's coordinates in all lanes.
  std::array<Float4, 3> lanes_;
  Int4 below_order_;
  Measure measure_;
  const std::vector<char>* excluded_;
  NearestSegment best_;
};

NearestSegment SegmentTree::nearest(const glm::vec3& point, int32_t below_order, Measure measure,
                                    const std::vector<char>* excluded, double limit) const {
  return Search(*this, point, below_order, measure, excluded, limit).run();
}

}  // namespace snowbough::tree
