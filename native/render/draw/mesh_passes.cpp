#include "render/draw/mesh_passes.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <stdexcept>
#include <string>
#include <utility>

#include "render/draw/image_texture.h"
#include "render/draw/matrix_rows.h"
#include "shaders/lib/mesh_corner.h"

namespace snowbough::render {
namespace {

using glm::vec2;
using glm::vec3;
using glm::vec4;

/// Most triangles of a piece. Their corners take 48 MiB; storage blocks of software renderers hold
/// 128 MiB.
constexpr size_t kPieceTriangles = size_t{1} << 19;

void require(bool right, const std::string& what) {
  if (!right) throw std::invalid_argument("mesh: " + what);
}

vec3 unit(const vec3& v) {
  const float length = glm::length(v);
  return length > 0.0f ? v / length : vec3(0.0f, 0.0f, 1.0f);
}

void check(const MeshSource& source) {
  const size_t triangles = source.triangles.size();
  require(!source.materials.empty(), "it needs at least one material");
  require((source.normals.empty() || source.normals.size() == 3 * triangles) &&
              (source.uv.empty() || source.uv.size() == 3 * triangles),
          "normals and uv must have three entries per triangle, or be empty");
  require(source.material.empty() || source.material.size() == triangles,
          "material must have one entry per triangle, or be empty");
  for (const auto& triangle : source.triangles) {
    for (const int32_t v : triangle) {
      require(v >= 0 && v < static_cast<int32_t>(source.vertices.size()),
              "vertex index " + std::to_string(v) + " of a triangle must be at least 0 and below " +
                  std::to_string(source.vertices.size()));
    }
  }
  for (const int32_t m : source.material) {
    require(m >= 0 && m < static_cast<int32_t>(source.materials.size()),
            "material index " + std::to_string(m) + " of a triangle must be at least 0 and below " +
                std::to_string(source.materials.size()));
  }
}

/// Normals of the vertices: area-weighted means over their triangles.
std::vector<vec3> smooth_normals(const MeshSource& source) {
  std::vector<vec3> normals(source.vertices.size(), vec3(0.0f));
  for (const auto& triangle : source.triangles) {
    const vec3 a = source.vertices[triangle[0]];
    const vec3 across =
        glm::cross(source.vertices[triangle[1]] - a, source.vertices[triangle[2]] - a);
    for (const int32_t v : triangle) normals[v] += across;
  }
  for (vec3& normal : normals) normal = unit(normal);
  return normals;
}

/// Triangles by material, in groups that fit into a piece.
std::vector<std::pair<int32_t, std::vector<int32_t>>> pieces_of(const MeshSource& source) {
  std::vector<std::vector<int32_t>> by_material(source.materials.size());
  for (size_t i = 0; i < source.triangles.size(); ++i) {
    by_material[source.material.empty() ? 0 : source.material[i]].push_back(
        static_cast<int32_t>(i));
  }
  std::vector<std::pair<int32_t, std::vector<int32_t>>> pieces;
  for (size_t m = 0; m < by_material.size(); ++m) {
    const std::vector<int32_t>& all = by_material[m];
    for (size_t first = 0; first < all.size(); first += kPieceTriangles) {
      const size_t end = std::min(first + kPieceTriangles, all.size());
      pieces.emplace_back(static_cast<int32_t>(m),
                          std::vector<int32_t>(all.begin() + static_cast<int64_t>(first),
                                               all.begin() + static_cast<int64_t>(end)));
    }
  }
  return pieces;
}

}  // namespace

MeshBuffers::MeshBuffers(const MeshSource& source) : is_snow_(source.is_snow) {
  check(source);
  const std::vector<vec3> smooth =
      source.normals.empty() ? smooth_normals(source) : std::vector<vec3>();
  for (auto& [material, triangles] : pieces_of(source)) {
    std::vector<shared::MeshCorner> corners;
    corners.reserve(3 * triangles.size());
    for (const int32_t t : triangles) {
      for (size_t k = 0; k < 3; ++k) {
        const size_t at = 3 * static_cast<size_t>(t) + k;
        const int32_t v = source.triangles[t][k];
        const vec3 normal = source.normals.empty() ? smooth[v] : source.normals[at];
        const vec2 uv = source.uv.empty() ? vec2(0.0f) : source.uv[at];
        corners.push_back({vec4(source.vertices[v], uv.x), vec4(normal, uv.y)});
        own_.add(source.vertices[v]);
      }
    }
    pieces_.push_back({material, std::move(triangles), gpu::Buffer(corners), {}});
  }
  for (const Material& material : source.materials) {
    materials_.push_back({material.color, image_texture(material.image, "mesh")});
  }
  set_instances({glm::mat4(1.0f)});
}

void MeshBuffers::set_instances(const std::vector<glm::mat4>& matrices) {
  matrices_ = gpu::Buffer(matrix_rows(matrices));
  instance_count_ = static_cast<int32_t>(matrices.size());
  bounds_ = Box();
  for (const glm::mat4& matrix : matrices) bounds_.add(own_.moved(matrix));
}

void MeshBuffers::set_snow(const MeshSnow& snow) {
  snow_heights_ = gpu::Texture();
  if (snow.heights.empty()) return;
  require(snow.width > 0 && snow.height > 0 &&
              snow.heights.size() == static_cast<size_t>(snow.width) * snow.height,
          "a snow map must have height x width values");
  size_t triangles = 0;
  for (const Piece& piece : pieces_) triangles += piece.triangles.size();
  require(snow.uv.size() == 3 * triangles, "snow must have three uv entries per triangle");
  for (Piece& piece : pieces_) {
    std::vector<vec2> corners;
    corners.reserve(3 * piece.triangles.size());
    for (const int32_t t : piece.triangles) {
      for (size_t k = 0; k < 3; ++k) corners.push_back(snow.uv[3 * static_cast<size_t>(t) + k]);
    }
    piece.snow_corners = gpu::Buffer(corners);
  }
  gpu::Texture heights(GL_R32F, snow.width, snow.height, 0, GL_LINEAR);
  heights.write(0, GL_RED, GL_FLOAT, snow.heights.data());
  snow_heights_ = std::move(heights);
}

void MeshPasses::draw(MeshBuffers& mesh, const gpu::Buffer& view, const DrawStyle& style) {
  const bool shaded = style.kind == DrawKind::kShaded;
  const bool snow = shaded && mesh.snow_heights_.id() != 0;
  std::vector<std::string> defines;
  if (snow) defines.emplace_back("SNOW");
  if (shaded && mesh.is_snow_) defines.emplace_back("IS_SNOW");
  for (MeshBuffers::Piece& piece : mesh.pieces_) {
    const MeshBuffers::DrawnMaterial& material = mesh.materials_[piece.material];
    gpu::Program& program = begin_draw(mesh_, style, defines);
    program.bind("ViewBlock", view);
    program.bind("MeshCorners", piece.corners);
    program.bind("MeshInstances", mesh.matrices_);
    program.bind_texture("image", material.image);
    if (shaded && !mesh.is_snow_) program.set("image_color", vec4(material.color, 1.0f));
    if (snow) {
      program.bind("SnowCorners", piece.snow_corners);
      program.bind_texture("snow_heights", mesh.snow_heights_);
    }
    program.draw(GL_TRIANGLES, 0, 3 * static_cast<int32_t>(piece.triangles.size()),
                 mesh.instance_count_);
  }
}

}  // namespace snowbough::render
