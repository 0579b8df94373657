#include "render/tree/leaf_passes.h"

#include <algorithm>
#include <bit>
#include <glm/geometric.hpp>
#include <stdexcept>
#include <string>
#include <utility>

#include "render/draw/image_texture.h"
#include "render/draw/posed_bounds.h"
#include "shaders/lib/leaf_vertex.h"
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

void add_leaf(const LeafSource& source, const Leaf& leaf, std::vector<shared::LeafVertex>& made) {
  Box box;
  for (size_t c = 3 * leaf.begin; c < 3 * leaf.end; ++c) box.add(source.positions[c]);
  float radius = 0.0f;
  for (size_t c = 3 * leaf.begin; c < 3 * leaf.end; ++c) {
    radius = std::max(radius, glm::distance(box.centre(), source.positions[c]));
  }
  const vec4 size(radius, shared::patch_number(leaf.number), 0.0f, 0.0f);
  for (size_t i = leaf.begin; i < leaf.end; ++i) {
    const vec3* p = &source.positions[3 * i];
    const vec3 normal = unit(glm::cross(p[1] - p[0], p[2] - p[0]));
    for (size_t k = 0; k < 3; ++k) {
      const glm::vec2 uv = source.uv[3 * i + k];
      made.push_back({vec4(p[k], std::bit_cast<float>(source.bone[i])), vec4(normal, uv.x),
                      vec4(box.centre(), uv.y), size});
    }
  }
}

}  // namespace

LeafBuffers::LeafBuffers(const LeafSource& source, int32_t bone_count) {
  check(source, bone_count);
  const std::vector<Leaf> leaves = find_leaves(source);
  std::vector<shared::LeafVertex> made;
  made.reserve(source.positions.size());
  for (size_t m = 0; m < source.materials.size(); ++m) {
    const auto first = static_cast<int32_t>(made.size());
    for (const Leaf& leaf : leaves) {
      if (source.material[leaf.begin] == static_cast<int32_t>(m)) add_leaf(source, leaf, made);
    }
    const size_t triangles = (made.size() - static_cast<size_t>(first)) / 3;
    if (triangles == 0) continue;
    parts.push_back({first, source.materials[m].color,
                     image_texture(source.materials[m].image, "leaves"), PatchList(triangles),
                     PatchList(triangles)});
  }
  vertices = gpu::Buffer(made);
}

void LeafPasses::classify(LeafBuffers& leaves, List list, const gpu::Buffer& bones,
                          const gpu::Buffer& view) {
  for (LeafBuffers::Part& part : leaves.parts) {
    classify_.use();
    classify_.bind("ViewBlock", view);
    classify_.bind("LeafVertices", leaves.vertices);
    classify_.bind("BoneRows", bones);
    classify_.set("first_vertex", part.first_vertex);
    lists_.run(classify_, part.*list, 3, 1.0f);
  }
}

void LeafPasses::draw(LeafBuffers& leaves, List list, const gpu::Buffer& bones,
                      const gpu::Buffer& view, const DrawStyle& style) {
  for (LeafBuffers::Part& part : leaves.parts) {
    gpu::Program& program = begin_draw(leaves_, style);
    program.bind("ViewBlock", view);
    program.bind("LeafVertices", leaves.vertices);
    program.bind("BoneRows", bones);
    program.bind("PlainPatches", (part.*list).plain);
    program.bind_texture("image", part.image);
    program.set("first_vertex", part.first_vertex);
    if (style.kind == DrawKind::kShaded) program.set("image_color", vec4(part.color, 1.0f));
    program.draw_indirect(GL_TRIANGLES, (part.*list).commands, 0, 1);
  }
}

}  // namespace snowbough::render
