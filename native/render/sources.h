#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <vector>

namespace snowbough::render {

/// A stretch of a limb between two of its rings, as a round cone on an infinite line. Metres.
struct LimbSection {
  glm::vec3 begin{0.0f};
  /// Unit vector.
  glm::vec3 axis{0.0f, 0.0f, 1.0f};
  float length = 1.0f;
  float begin_radius = 1.0f;
  float end_radius = 1.0f;
  /// Begins at a hole in its parent's side: becomes round over its first width only.
  bool from_hole = false;
};

/// What a quad is to the renderer.
enum class QuadKind : uint8_t {
  /// Between two rings of a limb: corners 0 and 1 on the lower one, 2 and 3 on the upper.
  kWall,
  /// Beside a child's hole, of the parent's limb.
  kInset,
  /// Closes an end: stays flat.
  kCap,
};

/// The four-sided base of a tree: what is tessellated. Metres, Z up; quads wind anticlockwise seen
/// from outside.
struct TreeSource {
  std::vector<glm::vec3> vertices;
  /// Per vertex: up to four bones, weight 0 where unused.
  std::vector<std::array<int32_t, 4>> bone_indices;
  std::vector<std::array<float, 4>> bone_weights;
  int32_t bone_count = 0;

  std::vector<std::array<int32_t, 4>> quads;
  /// Per corner: u once round a limb from 0 to 1, v along it in circumferences.
  std::vector<std::array<glm::vec2, 4>> bark_uv;
  /// Per corner: its place on the map of the snow on the tree, 0 to 1; empty: it carries none.
  std::vector<std::array<glm::vec2, 4>> snow_uv;
  /// Per quad: branch level (0 the trunk), branch, section (any number for caps) and kind.
  std::vector<int32_t> branch_level;
  std::vector<int32_t> branch;
  std::vector<int32_t> section;
  std::vector<QuadKind> kind;

  std::vector<LimbSection> sections;
};

/// sRGB and alpha, row 0 at the bottom; empty: opaque white.
struct Image {
  int32_t width = 0;
  int32_t height = 0;
  std::vector<uint8_t> rgba;
};

/// `color` is linear and multiplies the image's; where the image is less than half there is a hole.
struct Material {
  glm::vec3 color{0.5f};
  Image image;
};

/// Leaves as cards: triangles of three corners each. Metres, Z up, rest pose.
struct LeafSource {
  /// Per corner.
  std::vector<glm::vec3> positions;
  std::vector<glm::vec2> uv;
  /// Per triangle: the bone it hangs on, and its material.
  std::vector<int32_t> bone;
  std::vector<int32_t> material;

  std::vector<Material> materials;
};

/// What the bark of a tree shows in place of its own colours, by quad of its base.
struct BarkSource {
  /// Per corner, coordinates of the material's image.
  std::vector<std::array<glm::vec2, 4>> uv;
  std::vector<int32_t> material;

  /// At least one.
  std::vector<Material> materials;
};

/// A mesh that is drawn as it is, seen from both sides. Metres, Z up, in a space of its own.
struct MeshSource {
  std::vector<glm::vec3> vertices;
  std::vector<std::array<int32_t, 3>> triangles;
  /// Per corner of the triangles, unit vectors; empty: smooth normals, from the triangles' areas.
  std::vector<glm::vec3> normals;
  /// Per corner, coordinates of the material's image; empty: (0, 0).
  std::vector<glm::vec2> uv;
  /// Per triangle; empty: the first.
  std::vector<int32_t> material;
  /// At least one.
  std::vector<Material> materials{1};
  /// Whether it is the surface of snow: it is shaded as snow, whatever its materials.
  bool is_snow = false;
};

/// Snow that lies on a mesh, see MeshSource: where, and how deep.
struct MeshSnow {
  /// Per corner of the triangles, coordinates of the map.
  std::vector<glm::vec2> uv;
  /// Metres along the normal, row 0 at v = 0.
  int32_t width = 0;
  int32_t height = 0;
  std::vector<float> heights;
};

/// How deep snow lies on open level ground, in metres.
struct SnowDepths {
  /// With the snow of this map.
  float open = 0.1f;
  /// At the shot's end: the unit of the noise by which snow ends raggedly, so that it stays in its
  /// place while snow grows.
  float last = 0.1f;
};

/// The snow on a tree.
struct TreeSnow {
  /// Heights in metres, width x height, row 0 = v 0, below 0 on the back of the surface.
  int32_t width = 0;
  int32_t height = 0;
  std::vector<float> values;
  SnowDepths depths;
};

}  // namespace snowbough::render
