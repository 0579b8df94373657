#include "render/tree/leaf_triangles.h"

#include <algorithm>
#include <bit>
#include <glm/geometric.hpp>
#include <numeric>
#include <stdexcept>
#include <string>

#include "render/draw/posed_bounds.h"
#include "render/tree/drop_order.h"
#include "shaders/lib/thin_limbs.h"

namespace snowbough::render {
namespace {

using glm::vec3;
using glm::vec4;

void require_leaves(bool right, const std::string& what) {
  if (!right) throw std::invalid_argument(what);
}

vec3 unit(const vec3& v) {
  const float length = glm::length(v);
  return length > 0.0f ? v / length : vec3(0.0f, 0.0f, 1.0f);
}

void check(const LeafSource& source, int32_t bone_count) {
  const size_t triangles = source.bone.size();
  require_leaves(
      source.positions.size() == 3 * triangles && source.uv.size() == 3 * triangles &&
          source.material.size() == triangles,
      "leaves: positions and uv must have three entries per triangle, bone and material one");
  for (size_t i = 0; i < triangles; ++i) {
    require_leaves(source.bone[i] >= 0 && source.bone[i] < bone_count,
                   "leaves: bone index " + std::to_string(source.bone[i]) + " of triangle " +
                       std::to_string(i) + " must be at least 0 and below " +
                       std::to_string(bone_count));
    require_leaves(source.material[i] >= 0 &&
                       source.material[i] < static_cast<int32_t>(source.materials.size()),
                   "leaves: material index " + std::to_string(source.material[i]) +
                       " of triangle " + std::to_string(i) + " must be at least 0 and below " +
                       std::to_string(source.materials.size()));
  }
}

/// Successive triangles of one leaf: [begin, end).
struct Leaf {
  size_t begin = 0;
  size_t end = 0;
  int32_t number = 0;
};

/// Divides triangles into leaves: a triangle belongs to the leaf of the one before it if they have
/// a corner, the bone and the material in common.
std::vector<Leaf> find_leaves(const LeafSource& source) {
  const auto continues = [&](size_t i) {
    const vec3* const own = &source.positions[3 * i];
    return source.bone[i] == source.bone[i - 1] && source.material[i] == source.material[i - 1] &&
           std::any_of(own, own + 3,
                       [&](const vec3& corner) { return std::find(own - 3, own, corner) != own; });
  };
  std::vector<Leaf> leaves;
  for (size_t i = 0; i < source.bone.size(); ++i) {
    if (i == 0 || !continues(i)) leaves.push_back({i, i, static_cast<int32_t>(leaves.size())});
    leaves.back().end = i + 1;
  }
  return leaves;
}

void add_leaf(const LeafSource& source, const Leaf& leaf, LeafTriangles& made) {
  Box box;
  for (size_t c = 3 * leaf.begin; c < 3 * leaf.end; ++c) box.add(source.positions[c]);
  float radius = 0.0f;
  for (size_t c = 3 * leaf.begin; c < 3 * leaf.end; ++c) {
    radius = std::max(radius, glm::distance(box.centre(), source.positions[c]));
  }
  const vec4 size(radius, shared::patch_number(leaf.number), 0.0f, 0.0f);
  made.drop_points.insert(made.drop_points.end(), leaf.end - leaf.begin,
                          leaf_drop_point(size.x, size.y));
  for (size_t i = leaf.begin; i < leaf.end; ++i) {
    const vec3* p = &source.positions[3 * i];
    const vec3 normal = unit(glm::cross(p[1] - p[0], p[2] - p[0]));
    for (size_t k = 0; k < 3; ++k) {
      const glm::vec2 uv = source.uv[3 * i + k];
      made.vertices.push_back({vec4(p[k], std::bit_cast<float>(source.bone[i])), vec4(normal, uv.x),
                               vec4(box.centre(), uv.y), size});
    }
  }
}

/// The leaves' triangles in the order of their drop points.
LeafTriangles in_order(const LeafTriangles& of) {
  std::vector<size_t> order(of.drop_points.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return of.drop_points[a] < of.drop_points[b]; });
  LeafTriangles made;
  for (const size_t i : order) {
    made.drop_points.push_back(of.drop_points[i]);
    for (size_t k = 0; k < 3; ++k) made.vertices.push_back(of.vertices[3 * i + k]);
  }
  return made;
}

}  // namespace

std::vector<LeafTriangles> leaf_triangles(const LeafSource& source, int32_t bone_count) {
  check(source, bone_count);
  std::vector<LeafTriangles> made(source.materials.size());
  for (const Leaf& leaf : find_leaves(source)) {
    add_leaf(source, leaf, made[static_cast<size_t>(source.material[leaf.begin])]);
  }
  for (LeafTriangles& part : made) part = in_order(part);
  return made;
}

}  // namespace snowbough::render
