#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <vector>

#include "render/snow/refine.h"
#include "render/sources.h"
#include "shaders/lib/snow_patch.h"

namespace snowbough::render {

/// What of a receiver is uploaded, see shaders/lib/snow_patch.h.
struct SnowPatches {
  std::vector<shared::SnowVertex> vertices;
  std::vector<int32_t> vertex_corners;
  std::vector<shared::SnowEdge> edges;
  /// By edge, see find_bends; w: unused.
  std::vector<glm::vec4> edge_bends;
  std::vector<shared::SnowPatch> patches;
  /// Per corner: the shading normal, unit.
  std::vector<glm::vec4> corner_normals;
  /// Box around the vertices.
  glm::vec3 lowest{0.0f};
  glm::vec3 highest{0.0f};
};

/// A receiver's mesh as the renderer holds it: cuts and records stay, a pose changes what depends
/// on positions.
class SnowMesh {
 public:
  /// @throws std::invalid_argument naming what is wrong: arrays of different length, indices out of
  ///   range, values that are not finite, an edge of more than two triangles.
  explicit SnowMesh(SnowSource source);

  const SnowPatches& patches() const { return patches_; }
  /// Moves the mesh. `normals`: as SnowSource's. @throws as the constructor.
  void set_pose(const std::vector<glm::vec3>& positions,
                const std::vector<std::array<glm::vec3, 3>>& normals);

 private:
  void take_pose(const std::vector<std::array<glm::vec3, 3>>& directions);
  void add_patches();
  void add_edges();
  void list_corners();
  /// Whether the normals of an edge's faces differ.
  bool is_hard(const shared::SnowEdge& edge) const;
  /// How far each vertex is from hard edges and from where the surface ends.
  void measure_rims();

  SnowSource source_;
  RefinedMesh refined_;
  SnowPatches patches_;
};

}  // namespace snowbough::render
