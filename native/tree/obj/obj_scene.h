#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

namespace snowbough::tree {

/// Consecutive faces with the same names, up to the next run's first face.
struct FaceRun {
  int32_t first_face = 0;
  /// Indices into ObjScene::names from the lines `o` and `g`, -1 for none.
  int32_t object = -1;
  int32_t group = -1;
  /// Index into ObjScene::materials, -1 = none.
  int32_t material = -1;
};

/// A Wavefront OBJ file as parsed: in its own units and axes, without welding or interpretation.
struct ObjScene {
  std::vector<glm::vec3> positions;
  std::vector<glm::vec2> uvs;
  /// Of any length, as in the file.
  std::vector<glm::vec3> normals;
  /// Polygon f owns corners [face_begin[f], face_begin[f + 1]): one entry more than polygons.
  std::vector<int32_t> face_begin{0};
  /// Per corner: index into positions, always valid.
  std::vector<int32_t> corner_vertex;
  /// Per corner: index into uvs or -1; empty if no face of the file has texture coordinates.
  std::vector<int32_t> corner_uv;
  /// Per corner: index into normals or -1; empty if no face of the file has normals.
  std::vector<int32_t> corner_normal;
  /// In the order of the file; every polygon belongs to exactly one.
  std::vector<FaceRun> runs;
  /// Names of groups and objects, and of materials, each once.
  std::vector<std::string> names;
  std::vector<std::string> materials;
  /// Material libraries as the file names them.
  std::vector<std::string> material_libraries;
  /// Polygons with fewer than three corners, left out.
  int64_t short_faces = 0;
  /// `l` and `p` elements, left out.
  int64_t loose_elements = 0;

  int32_t face_count() const { return static_cast<int32_t>(face_begin.size()) - 1; }
};

}  // namespace snowbough::tree
