#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <utility>
#include <vector>

namespace snowbough::tree {

/// One limb from its root to its tip. Positions and lengths in metres, Z up.
struct Branch {
  /// The export's own name (group or object), made unique within the skeleton.
  std::string name;
  /// 0 is the trunk.
  int32_t level = 0;
  /// Index of the branch it grows from, -1 for a root. Always smaller than the branch's own index.
  int32_t parent = -1;
  /// Attach point on the parent's centreline; points[0] for a root.
  glm::vec3 attach_point{0.0f};
  /// Centres of the rings or squares, root to tip; at least one.
  std::vector<glm::vec3> points;
  /// Mean distance of each ring's vertices from its centre; 0 is common at tips.
  std::vector<float> radii;
  /// Area of each ring's polygon in m2: preserves the limb's volume.
  std::vector<float> areas;
  /// Index into OriginalWood's pieces, -1 for a branch that was not imported.
  int32_t piece = -1;
  /// Number of the limb within its piece: only forking surfaces have several.
  int32_t limb = 0;
};

/// Result of the import, for the operator's report, --json and the collection's custom property.
struct ImportReport {
  /// One of SQUARES_PER_GROUP, TUBES_PER_GROUP, TUBES_PER_LEVEL, MERGED_TUBES, MATERIALS,
  /// MERGED_SQUARES, WELDED (forms 1 to 7), ONE_LIMB (a kept surface without limbs),
  /// SPEEDTREE_BONES, or FROM_BRANCHES.
  std::string form;
  /// "Y" or "Z": the up axis used.
  std::string up_axis;
  /// Number of branches on each level, from the trunk on.
  std::vector<int32_t> branches_per_level;
  /// Skipped parts: name -> reason.
  std::vector<std::pair<std::string, std::string>> skipped_parts;
  /// Names of branches without a parent in reach, kept as roots.
  std::vector<std::string> extra_roots;
  /// Number of foliage parts (leaves, needles, flowers) kept beside the skeleton.
  int32_t foliage_parts = 0;
  /// Name of the group or object with most of the wood; empty without names.
  std::string wood_name;
  /// Fraction of the wood's area that the limbs represent.
  double coverage = 1.0;
  std::vector<std::string> warnings;
};

/// A texture of a material, and its mapping.
struct MaterialTexture {
  /// Absolute path of an existing file, or empty.
  std::string path;
  /// Sampled at uv * scale + offset: the statement's -s and -o.
  glm::vec2 scale{1.0f};
  glm::vec2 offset{0.0f};
};

/// A material of the export's MTL file.
struct ObjMaterial {
  std::string name;
  /// False if no library defines it: only its name is known then.
  bool defined = false;
  /// Kd, d and Tf: the colour of transmitted light, white by default.
  glm::vec3 diffuse{0.8f};
  float opacity = 1.0f;
  glm::vec3 transmission{1.0f};
  /// -bm of map_bump.
  float bump_strength = 1.0f;
  /// map_Kd, map_d, map_Ks, map_bump (a height), norm (a tangent-space normal).
  MaterialTexture diffuse_texture;
  MaterialTexture alpha_texture;
  MaterialTexture specular_texture;
  MaterialTexture bump_texture;
  MaterialTexture normal_texture;
};

/// Polygons of the file with everything at their corners (Z up, metres).
struct PolygonMesh {
  std::vector<glm::vec3> vertices;
  /// Polygons as a flat list of corners; polygon f owns corners [face_begin[f], face_begin[f + 1]).
  std::vector<int32_t> face_begin;
  std::vector<int32_t> corner_vertex;
  /// The export's texture coordinates, per corner; (0, 0) if it has none.
  std::vector<glm::vec2> corner_uv;
  /// The export's unit normals, per corner; zero for a corner without one. Empty if there are none,
  /// or if all are those of the flat polygons.
  std::vector<glm::vec3> corner_normal;
  /// Per polygon: index into materials, -1 = none.
  std::vector<int32_t> face_material;
  std::vector<ObjMaterial> materials;
};

/// Leaves, needles and flowers as in the file.
struct Foliage : PolygonMesh {
  /// Per polygon: number of the leaf it belongs to.
  std::vector<int32_t> face_leaf;
  /// Per leaf: its branch (index into Skeleton::branches) and attach point.
  std::vector<int32_t> leaf_branch;
  std::vector<glm::vec3> leaf_attach_point;
};

/// The wood as in the file, for trees that keep their surface. No polygons: it was not asked for.
struct KeptSurface : PolygonMesh {
  /// Whether any polygon has texture coordinates.
  bool textured = false;
  /// Whether the file's normals are those of flat polygons.
  bool flat = false;
  /// Per vertex: its piece and limb (see Branch); -1 for wood in which no limb was found.
  std::vector<int32_t> vertex_piece;
  std::vector<int32_t> vertex_limb;
  /// Per polygon: number of its index-connected part of the file.
  std::vector<int32_t> face_part;
  /// Per vertex, from attach_kept on: its branch, and its place on that branch's centreline.
  std::vector<int32_t> vertex_branch;
  std::vector<glm::vec3> vertex_place;
};

/// The wood's own polygons, for their texture coordinates and materials (Z up, metres). A piece is
/// an index-connected component: a limb's tube, or a forking surface shared by several limbs.
struct OriginalWood {
  /// Each position once per piece.
  std::vector<glm::vec3> vertices;
  /// Piece p owns triangles [piece_begin[p], piece_begin[p + 1]). There are none if every piece has
  /// one material and the file has no texture coordinates, or if the piece is a row of planes.
  std::vector<std::array<int32_t, 3>> triangles;
  std::vector<int32_t> piece_begin{0};
  /// Per triangle: texture coordinates of its corners, and index into materials (-1 = none).
  std::vector<std::array<glm::vec2, 3>> uvs;
  std::vector<int32_t> triangle_material;
  /// Per piece: 1 if all its corners have texture coordinates; and the first face's material.
  std::vector<uint8_t> piece_textured;
  std::vector<int32_t> piece_material;
  std::vector<ObjMaterial> materials;
  /// Per branch: its points before simplification; empty without triangles.
  std::vector<std::vector<glm::vec3>> centrelines;
};

/// A whole tree: branches sorted so that a parent comes before its children.
struct Skeleton {
  std::vector<Branch> branches;
  Foliage foliage;
  OriginalWood wood;
  KeptSurface kept;
  /// Extent of the wood along Z in metres: all tolerances are relative to it.
  float height = 0.0f;
  /// Origin of all points in the file's space, in metres, Z up: a tree far from the file's origin
  /// has its own origin, since single precision cannot hold both.
  glm::dvec3 origin{0.0};
  ImportReport report;
};

/// Checks a skeleton built by the caller, makes names unique and fills `height` and the report's
/// `branches_per_level`.
/// @throws std::invalid_argument naming the branch and the fault: no points, arrays of different
/// length, non-finite values, negative radii or areas, or a parent that does not come before it.
void complete_skeleton(Skeleton& skeleton);

/// Scales everything by `factor`, including leaves and the wood's own polygons.
/// @throws std::invalid_argument for a factor that is not finite and above zero, or out of range
/// for this tree.
void scale_skeleton(Skeleton& skeleton, double factor);

}  // namespace snowbough::tree
