#include "snow/movement/rays/object_rays.h"

#include <cmath>
#include <glm/geometric.hpp>

#include "snow/texels/open_sheets.h"

namespace snowbough::snow {

void ObjectRays::update() {
  const std::scoped_lock lock(mutex_);
  if (is_current_) return;
  if (tree_ != nullptr) {
    tree_->refit(*positions_, triangles_);
  } else {
    const std::vector<int32_t>& corners = object_->description.topology.triangles;
    triangles_.resize(corners.size() / 3);
    for (size_t t = 0; t < triangles_.size(); ++t) {
      triangles_[t] = {corners[3 * t], corners[3 * t + 1], corners[3 * t + 2]};
    }
    const std::vector<glm::vec3>& rest = object_->description.rest;
    is_open_ = find_open_sheets(corners, rest.empty() ? *positions_ : rest);
    tree_ = std::make_unique<base::TriangleTree>(
        *positions_, triangles_, std::vector<int32_t>{0, static_cast<int32_t>(triangles_.size())});
  }
  is_current_ = true;
}

base::TriangleTree::Hit ObjectRays::first_along(const glm::dvec3& from, const glm::dvec3& direction,
                                                double least, double most) {
  if (!is_current_) update();
  return tree_->first_along(0, from, direction, least, most);
}

RayHit ObjectRays::hit_at(const base::TriangleTree::Hit& hit, int32_t object,
                          const glm::dvec3& from, const glm::dvec3& direction) const {
  if (hit.triangle < 0) return {};
  const auto triangle = static_cast<size_t>(hit.triangle);
  const auto corner = [&](size_t k) {
    return glm::dvec3((*positions_)[static_cast<size_t>(triangles_[triangle][k])]);
  };
  const glm::dvec3 b = corner(1) - corner(0);
  const glm::dvec3 c = corner(2) - corner(0);
  const glm::dvec3 normal = glm::cross(b, c);
  const double square = glm::dot(normal, normal);
  const glm::dvec3 at = from + hit.distance * direction - corner(0);
  RayHit met;
  met.object = object;
  met.triangle = hit.triangle;
  met.distance = hit.distance;
  met.is_open = is_open_[triangle] != 0;
  if (!(square > 0.0)) return met;
  met.up = normal.z / std::sqrt(square);
  met.weights = glm::vec2(glm::dot(glm::cross(at, c), normal) / square,
                          glm::dot(glm::cross(b, at), normal) / square);
  return met;
}

}  // namespace snowbough::snow
