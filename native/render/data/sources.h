#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <vector>

#include "shaders/lib/snow_surface.h"

namespace snowbough::render {

/// A section of a limb between two of its rings, as a round cone on an infinite axis. Metres.
struct LimbSection {
  glm::vec3 begin{0.0f};
  /// Unit vector.
  glm::vec3 axis{0.0f, 0.0f, 1.0f};
  float length = 1.0f;
  float begin_radius = 1.0f;
  float end_radius = 1.0f;
  /// True if the section begins at a hole in its parent's side; its cross-section becomes round
  /// over its first width.
  bool from_hole = false;
};

/// Role of a quad.
enum class QuadKind : uint8_t {
  /// Between two rings of a limb: corners 0 and 1 are on the lower ring, 2 and 3 on the upper.
  kWall,
  /// Part of the parent's limb, beside a child's hole.
  kInset,
  /// Closes an end and stays flat.
  kCap,
};

/// The quad mesh of a tree, which is tessellated. Metres, Z up; quads are anticlockwise seen from
/// outside.
struct TreeSource {
  std::vector<glm::vec3> vertices;
  /// Per vertex: up to four bones; unused ones have weight 0.
  std::vector<std::array<int32_t, 4>> bone_indices;
  std::vector<std::array<float, 4>> bone_weights;
  int32_t bone_count = 0;

  std::vector<std::array<int32_t, 4>> quads;
  /// Per corner: u runs once around the limb from 0 to 1, v runs along it in circumferences.
  std::vector<std::array<glm::vec2, 4>> bark_uv;
  /// Per corner: coordinates on the tree's snow map, 0 to 1; empty if the tree carries no snow.
  std::vector<std::array<glm::vec2, 4>> snow_uv;
  /// Per quad: branch level (0 is the trunk), branch, section (any number for caps) and kind.
  std::vector<int32_t> branch_level;
  std::vector<int32_t> branch;
  std::vector<int32_t> section;
  std::vector<QuadKind> kind;

  std::vector<LimbSection> sections;
};

/// Appearance of a tree's bark.
struct TreeLook {
  /// Amplitude of the bark as a fraction of the limb's radius, 0 to 1.
  float bark_depth = 0.06f;
  /// Linear colours of furrows and ridges.
  glm::vec3 bark_dark{0.045f, 0.03f, 0.02f};
  glm::vec3 bark_light{0.24f, 0.18f, 0.13f};
};

/// sRGB and alpha, row 0 at the bottom; an empty image is opaque white.
struct Image {
  int32_t width = 0;
  int32_t height = 0;
  std::vector<uint8_t> rgba;
};

/// `color` is linear and multiplies the image. Pixels with an alpha below one half are holes.
struct Material {
  glm::vec3 color{0.5f};
  Image image;
};

/// Leaves as cards: triangles of three corners each. Metres, Z up, rest pose.
struct LeafSource {
  /// Per corner.
  std::vector<glm::vec3> positions;
  std::vector<glm::vec2> uv;
  /// Per triangle: the bone that moves it, and its material.
  std::vector<int32_t> bone;
  std::vector<int32_t> material;

  std::vector<Material> materials;
};

/// Images of a tree's bark, which replace its own colours, per quad of its base.
struct BarkSource {
  /// Per corner, coordinates of the material's image.
  std::vector<std::array<glm::vec2, 4>> uv;
  std::vector<int32_t> material;

  /// At least one.
  std::vector<Material> materials;
};

/// A mesh that is drawn without tessellation and from both sides. Metres, Z up, in its own space.
struct MeshSource {
  std::vector<glm::vec3> vertices;
  std::vector<std::array<int32_t, 3>> triangles;
  /// Per corner of the triangles: unit vectors; empty: smooth normals, weighted by the triangles'
  /// areas.
  std::vector<glm::vec3> normals;
  /// Per corner: coordinates of the material's image; empty: (0, 0).
  std::vector<glm::vec2> uv;
  /// Per triangle; empty: the first material.
  std::vector<int32_t> material;
  /// At least one.
  std::vector<Material> materials{1};
  /// True if the mesh is a snow surface; it is shaded as snow and its materials are ignored.
  bool is_snow = false;
};

/// A map of the snow on a mesh, see MeshSource.
struct MeshSnow {
  /// Per corner of the triangles: coordinates on the map.
  std::vector<glm::vec2> uv;
  /// Metres along the normal, row 0 at v = 0.
  int32_t width = 0;
  int32_t height = 0;
  std::vector<float> heights;
};

/// The shape of the snow on a tree, besides its map: its depth on open level ground in metres, and
/// the artist's settings.
struct SnowLook {
  /// At the time of the map.
  float open = 0.1f;
  /// At the shot's end. It is the unit of the noise at the snow's border, so that the noise stays
  /// in place while the snow grows.
  float last = 0.1f;
  shared::SnowStyle style = shared::usual_style();
};

struct TreeSnow {
  /// Heights in metres, width x height, row 0 at v = 0, negative on the back of the surface.
  int32_t width = 0;
  int32_t height = 0;
  std::vector<float> values;
  SnowLook look;
};

}  // namespace snowbough::render
