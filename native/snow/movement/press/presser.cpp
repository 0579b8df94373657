#include "snow/movement/press/presser.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>
#include <limits>

#include "snow/texels/open_sheets.h"

namespace snowbough::snow {
namespace {

/// Rays begin this far below a texel, in metres, so that they meet an object that stands on it.
constexpr double kBelow = 1e-4;

/// Of `thinnest`: the most faces, and the least cosine between their normals and their motion; and
/// between the normals of opposite faces, against each other.
constexpr size_t kMaxFaces = 1024;
constexpr double kAheadLeast = 0.5;
constexpr double kOppositeLeast = 0.5;

bool meet(const Bounds& a, const Bounds& b) {
  return glm::all(glm::greaterThanEqual(a.high, b.low)) &&
         glm::all(glm::lessThanEqual(a.low, b.high));
}

Bounds bounds_of(const std::vector<glm::vec3>& points) {
  Bounds bounds;
  for (const glm::vec3& point : points) bounds.include(glm::dvec3(point));
  return bounds;
}

}  // namespace

Presser::Presser(const SceneObject& object) : object_(&object) {
  const std::vector<int32_t>& corners = object.description.topology.triangles;
  triangles_.resize(corners.size() / 3);
  for (size_t t = 0; t < triangles_.size(); ++t) {
    triangles_[t] = {corners[3 * t], corners[3 * t + 1], corners[3 * t + 2]};
  }
}

void Presser::begin(const std::vector<glm::vec3>& last) {
  last_ = &last;
  motion_.emplace(last, object_->positions);
  motion_->pose(0.0, pose_);
  swept_ = bounds_of(pose_);
  swept_.include(bounds_of(object_->positions));
  // A turning object leaves the box of its two poses by less than this.
  const glm::dvec3 margin(0.5 * motion_->travel());
  swept_.low -= margin;
  swept_.high += margin;
}

double Presser::travel(const Bounds& box) const {
  const std::vector<glm::vec3>& now = object_->positions;
  if (last_->size() != now.size()) return 0.0;
  std::vector<glm::vec3> half_way;
  motion_->pose(0.5, half_way);
  double longest = 0.0;
  for (size_t i = 0; i < now.size(); ++i) {
    const glm::dvec3 from((*last_)[i]);
    const glm::dvec3 to(now[i]);
    Bounds way;
    for (const glm::dvec3& point : {from, glm::dvec3(half_way[i]), to}) way.include(point);
    if (meet(way, box)) longest = std::max(longest, glm::length(to - from));
  }
  return longest;
}

double Presser::thinnest(const Bounds& box) {
  update_tree();
  const auto last = [&](int32_t vertex) { return glm::dvec3(pose_[static_cast<size_t>(vertex)]); };
  const auto normal_of = [&](int32_t triangle) {
    const auto [a, b, c] = triangles_[static_cast<size_t>(triangle)];
    return glm::cross(last(b) - last(a), last(c) - last(a));
  };
  const size_t step = triangles_.size() / kMaxFaces + 1;
  double thinnest = std::numeric_limits<double>::infinity();
  for (size_t t = 0; t < triangles_.size(); t += step) {
    const auto [a, b, c] = triangles_[t];
    Bounds face;
    glm::dvec3 way(0.0);
    for (const int32_t vertex : {a, b, c}) {
      face.include(last(vertex));
      way += glm::dvec3(object_->positions[static_cast<size_t>(vertex)]) - last(vertex);
    }
    if (!meet(face, box)) continue;
    const glm::dvec3 normal = normal_of(static_cast<int32_t>(t));
    if (!(glm::dot(normal, way) > kAheadLeast * glm::length(normal) * glm::length(way))) continue;
    if (is_open_[t] != 0) return 0.0;
    way = glm::normalize(way);
    const glm::dvec3 middle = (last(a) + last(b) + last(c)) / 3.0;
    const base::TriangleTree::Hit hit =
        tree_->first_along(0, middle - kBelow * way, -way, 0.0, thinnest);
    if (hit.triangle < 0) continue;
    // Through a corner, as behind a slanting blade's end, an object has no thickness of its own.
    const glm::dvec3 behind = normal_of(hit.triangle);
    if (glm::dot(normal, behind) > -kOppositeLeast * glm::length(normal) * glm::length(behind)) {
      continue;
    }
    thinnest = std::min(thinnest, hit.distance);
  }
  return thinnest;
}

void Presser::update_tree() {
  if (is_open_.size() != triangles_.size()) {
    const std::vector<glm::vec3>& rest = object_->description.rest;
    is_open_ = find_open_sheets(object_->description.topology.triangles,
                                rest.empty() ? object_->positions : rest);
  }
  if (tree_ == nullptr) {
    tree_ = std::make_unique<base::TriangleTree>(
        pose_, triangles_, std::vector<int32_t>{0, static_cast<int32_t>(triangles_.size())});
  } else {
    tree_->refit(pose_, triangles_);
  }
}

void Presser::move_to(int number, int count) {
  before_ = pose_;
  motion_->pose(static_cast<double>(number) / count, pose_);
  bounds_ = bounds_of(pose_);
  update_tree();
  outline_.set(pose_, triangles_, bounds_);
}

Clearance Presser::clearance(const glm::dvec3& from, const glm::dvec3& direction,
                             double most) const {
  const glm::dvec3 start = from - kBelow * direction;
  // Only a point in the object's box may be inside, however far the first face is.
  const bool may_be_inside = glm::all(glm::greaterThanEqual(start, bounds_.low)) &&
                             glm::all(glm::lessThanEqual(start, bounds_.high));
  const base::TriangleTree::Hit hit =
      tree_->first_along(0, start, direction, 0.0,
                         may_be_inside ? std::numeric_limits<double>::infinity() : most + kBelow);
  Clearance clearance;
  if (hit.triangle < 0) return clearance;
  const auto triangle = static_cast<size_t>(hit.triangle);
  std::array<glm::dvec3, 3> corner;
  for (size_t k = 0; k < 3; ++k) {
    const auto vertex = static_cast<size_t>(triangles_[triangle][k]);
    corner[k] = glm::dvec3(pose_[vertex]);
    clearance.moves += corner[k] - glm::dvec3(before_[vertex]);
  }
  const double way = glm::length(clearance.moves);
  clearance.moves = way > 1e-9 ? clearance.moves / way : glm::dvec3(0.0);
  const glm::dvec3 normal = glm::cross(corner[1] - corner[0], corner[2] - corner[0]);
  const bool leaves = is_open_[triangle] == 0 && glm::dot(normal, direction) > 0.0;
  clearance.metres = leaves ? 0.0 : std::max(hit.distance - kBelow, 0.0);
  return clearance;
}

}  // namespace snowbough::snow
