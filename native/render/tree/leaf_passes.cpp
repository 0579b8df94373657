#include "render/tree/leaf_passes.h"

#include <algorithm>
#include <bit>
#include <glm/geometric.hpp>
#include <stdexcept>
#include <string>
#include <utility>

#include "render/draw/image_texture.h"
#include "shaders/lib/leaf_vertex.h"

namespace snowbough::render {
namespace {

using glm::vec3;
using glm::vec4;

void require(bool right, const std::string& what) {
  if (!right) throw std::invalid_argument(what);
}

vec3 unit(const vec3& v) {
  const float length = glm::length(v);
  return length > 0.0f ? v / length : vec3(0.0f, 0.0f, 1.0f);
}

void check(const LeafSource& source, int32_t bone_count) {
  const size_t triangles = source.bone.size();
  require(source.positions.size() == 3 * triangles && source.uv.size() == 3 * triangles &&
              source.material.size() == triangles,
          "leaves: positions and uv must have three entries per triangle, bone and material one");
  for (size_t i = 0; i < triangles; ++i) {
    require(source.bone[i] >= 0 && source.bone[i] < bone_count,
            "leaves: bone index " + std::to_string(source.bone[i]) + " of triangle " +
                std::to_string(i) + " must be at least 0 and below " + std::to_string(bone_count));
    require(source.material[i] >= 0 &&
                source.material[i] < static_cast<int32_t>(source.materials.size()),
            "leaves: material index " + std::to_string(source.material[i]) + " of triangle " +
                std::to_string(i) + " must be at least 0 and below " +
                std::to_string(source.materials.size()));
  }
}

}  // namespace

LeafBuffers::LeafBuffers(const LeafSource& source, int32_t bone_count) {
  check(source, bone_count);
  std::vector<shared::LeafVertex> made;
  made.reserve(source.positions.size());
  for (size_t m = 0; m < source.materials.size(); ++m) {
    Part part;
    part.first_vertex = static_cast<int32_t>(made.size());
    part.color = source.materials[m].color;
    part.image = image_texture(source.materials[m].image, "leaves");
    for (size_t i = 0; i < source.bone.size(); ++i) {
      if (source.material[i] != static_cast<int32_t>(m)) continue;
      const vec3* p = &source.positions[3 * i];
      const vec3 normal = unit(glm::cross(p[1] - p[0], p[2] - p[0]));
      for (size_t k = 0; k < 3; ++k) {
        const glm::vec2 uv = source.uv[3 * i + k];
        made.push_back({vec4(p[k], std::bit_cast<float>(source.bone[i])), vec4(normal, uv.x),
                        vec4(uv.y, 0.0f, 0.0f, 0.0f)});
      }
    }
    part.vertex_count = static_cast<int32_t>(made.size()) - part.first_vertex;
    parts.push_back(std::move(part));
  }
  vertices = gpu::Buffer(made);
}

void LeafPasses::draw(LeafBuffers& leaves, const gpu::Buffer& bones, const gpu::Buffer& view,
                      const DrawStyle& style) {
  for (LeafBuffers::Part& part : leaves.parts) {
    gpu::Program& program = begin_draw(leaves_, style);
    program.bind("ViewBlock", view);
    program.bind("LeafVertices", leaves.vertices);
    program.bind("BoneRows", bones);
    program.bind_texture("image", part.image);
    program.set("first_vertex", part.first_vertex);
    if (style.kind == DrawKind::kShaded) program.set("image_color", vec4(part.color, 1.0f));
    program.draw(GL_TRIANGLES, 0, part.vertex_count);
  }
}

}  // namespace snowbough::render
