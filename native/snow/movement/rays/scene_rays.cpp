#include "snow/movement/rays/scene_rays.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

namespace snowbough::snow {
namespace {

/// Whether a ray may meet a box nearer than `most`.
bool may_meet(const Bounds& bounds, const glm::dvec3& from, const glm::dvec3& direction,
              double most) {
  double enters = 0.0;
  double leaves = most;
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0.0) {
      if (from[axis] < bounds.low[axis] || from[axis] > bounds.high[axis]) return false;
      continue;
    }
    const double a = (bounds.low[axis] - from[axis]) / direction[axis];
    const double b = (bounds.high[axis] - from[axis]) / direction[axis];
    enters = std::max(enters, std::min(a, b));
    leaves = std::min(leaves, std::max(a, b));
  }
  // The factor covers rounding, as in the trees.
  return enters <= leaves * (1.0 + 1e-12);
}

}  // namespace

void SceneRays::lay_out(const std::vector<const SceneObject*>& objects) {
  objects_ = objects;
  items_.clear();
  for (const SceneObject* object : objects) {
    items_.push_back(std::make_unique<ObjectRays>(*object));
    items_.back()->set_pose(object->positions);
  }
  order_.resize(objects.size());
  std::iota(order_.begin(), order_.end(), size_t{0});
  leaves_ = std::bit_ceil(objects.size());
  split(0, leaves_);
  leaf_of_.resize(objects.size());
  boxes_.assign(2 * leaves_, {});
  for (size_t k = 0; k < order_.size(); ++k) {
    leaf_of_[order_[k]] = leaves_ + k;
    boxes_[leaves_ + k] = box_of(order_[k]);
  }
  for (size_t node = leaves_ - 1; node > 0; --node) join(node);
}

/// Puts the objects of the leaves [begin, begin + size), a power of 2, into the order of the tree:
/// each half of the leaves lies on one side of the other, along the widest axis.
void SceneRays::split(size_t begin, size_t size) {
  const size_t end = std::min(begin + size, order_.size());
  const size_t middle = begin + size / 2;
  if (size < 2 || middle >= end) {
    if (size > 1 && begin < end) split(begin, size / 2);
    return;
  }
  // Twice the centre.
  const auto centre = [&](size_t object) {
    const Bounds& bounds = objects_[object]->bounds;
    return bounds.empty() ? glm::dvec3(0.0) : bounds.low + bounds.high;
  };
  Bounds centres;
  for (size_t k = begin; k < end; ++k) centres.include(centre(order_[k]));
  const glm::dvec3 extent = centres.high - centres.low;
  int axis = extent.y > extent.x ? 1 : 0;
  if (extent.z > extent[axis]) axis = 2;
  const auto at = [&](size_t k) { return order_.begin() + static_cast<std::ptrdiff_t>(k); };
  std::nth_element(at(begin), at(middle), at(end), [&](size_t a, size_t b) {
    return std::pair(centre(a)[axis], a) < std::pair(centre(b)[axis], b);
  });
  split(begin, size / 2);
  split(middle, size / 2);
}

/// That of an object that rays meet; others have none.
Bounds SceneRays::box_of(size_t object) const {
  const ObjectDescription& description = objects_[object]->description;
  return description.receive || description.occlude ? objects_[object]->bounds : Bounds();
}

void SceneRays::join(size_t node) {
  boxes_[node] = boxes_[2 * node];
  boxes_[node].include(boxes_[2 * node + 1]);
}

void SceneRays::forget_pose(size_t object) {
  items_[object]->set_pose(objects_[object]->positions);
  size_t node = leaf_of_[object];
  boxes_[node] = box_of(object);
  while ((node /= 2) > 0) join(node);
}

RayHit SceneRays::first_along(const glm::dvec3& from, const glm::dvec3& direction, double least,
                              double most, const SceneObject* except) const {
  base::TriangleTree::Hit hit;
  hit.distance = most;
  size_t object = objects_.size();
  std::array<size_t, 2 * std::numeric_limits<size_t>::digits> stack{};
  size_t pending = 0;
  if (!objects_.empty()) stack[pending++] = 1;
  while (pending > 0) {
    const size_t node = stack[--pending];
    if (boxes_[node].empty() || !may_meet(boxes_[node], from, direction, hit.distance)) continue;
    if (node < leaves_) {
      stack[pending++] = 2 * node + 1;
      stack[pending++] = 2 * node;
      continue;
    }
    const size_t i = order_[node - leaves_];
    if (objects_[i]->positions.empty() || objects_[i]->hidden || objects_[i] == except) continue;
    // Of equally near surfaces, that of the first object in the list counts.
    const bool is_earlier = hit.triangle >= 0 && i < object;
    const double under = is_earlier
                             ? std::nextafter(hit.distance, std::numeric_limits<double>::infinity())
                             : hit.distance;
    const base::TriangleTree::Hit own = items_[i]->first_along(from, direction, least, under);
    if (own.triangle < 0) continue;
    hit = own;
    object = i;
  }
  if (hit.triangle < 0) return {};
  return items_[object]->hit_at(hit, static_cast<int32_t>(object), from, direction);
}

}  // namespace snowbough::snow
