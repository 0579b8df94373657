#include "snow/scene/smooth_points.h"

#include <algorithm>

#include "base/group_by_key.h"

namespace snowbough::snow {
namespace {

bool is_smooth(const SceneObject& object) {
  const std::vector<int32_t>& shading = object.description.shading;
  return object.description.receive &&
         std::any_of(shading.begin(), shading.end(), [](int32_t number) { return number >= 0; });
}

/// Adds an object's points: `first_triangle` is its first in the scene, `count` the points so far.
void add_points(const SceneObject& object, size_t first_triangle, uint32_t& count,
                std::vector<shared::uvec4>& of_triangle) {
  const std::vector<int32_t>& shading = object.description.shading;
  // Shading numbers may be arbitrary; these are the ones in use, ascending.
  std::vector<int32_t> numbers;
  for (const int32_t number : shading) {
    if (number >= 0) numbers.push_back(number);
  }
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  uint32_t next = count + static_cast<uint32_t>(numbers.size());
  for (size_t t = 0; t < shading.size() / 3; ++t) {
    const int32_t* own = &shading[3 * t];
    if (std::max({own[0], own[1], own[2]}) < 0) continue;
    const auto point_of = [&](int32_t number) {
      if (number < 0) return next++;
      const auto found = std::lower_bound(numbers.begin(), numbers.end(), number);
      return count + static_cast<uint32_t>(found - numbers.begin());
    };
    shared::uvec4& points = of_triangle[first_triangle + t];
    points.x = point_of(own[0]);
    points.y = point_of(own[1]);
    points.z = point_of(own[2]);
  }
  count = next;
}

}  // namespace

SmoothPoints find_smooth_points(const std::vector<const SceneObject*>& objects) {
  SmoothPoints points;
  if (std::none_of(objects.begin(), objects.end(),
                   [](const SceneObject* object) { return is_smooth(*object); })) {
    return points;
  }
  size_t triangles = 0;
  for (const SceneObject* object : objects) {
    triangles += static_cast<size_t>(object->triangle_count());
  }
  points.of_triangle.assign(triangles, shared::uvec4(shared::kNowhere));
  uint32_t count = 0;
  size_t first = 0;
  for (const SceneObject* object : objects) {
    if (is_smooth(*object)) add_points(*object, first, count, points.of_triangle);
    first += static_cast<size_t>(object->triangle_count());
  }
  const auto for_each_corner = [&](const auto& visit) {
    for (size_t t = 0; t < triangles; ++t) {
      const shared::uvec4& own = points.of_triangle[t];
      if (own.x == shared::kNowhere) continue;
      const auto corner = static_cast<uint32_t>(3 * t);
      visit(own.x, corner);
      visit(own.y, corner + 1);
      visit(own.z, corner + 2);
    }
  };
  base::group_by_key(count, for_each_corner, points.begin, points.corners);
  return points;
}

}  // namespace snowbough::snow
