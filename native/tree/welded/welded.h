#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "base/progress.h"
#include "tree/obj/obj_scene.h"
#include "tree/rings/local_mesh.h"
#include "tree/rings/rings.h"

namespace snowbough::tree {

/// A tree imported as one surface.
struct WeldedTree {
  /// The limb at the root comes first, and every limb after its parent.
  std::vector<Limb> limbs;
  /// Per limb: its parent (-1 for the first), and the attach point on the parent's centreline,
  /// which is the limb's first point.
  std::vector<int32_t> parent;
  std::vector<glm::vec3> attach_point;
  /// Per vertex of the surface: the limb on which it lies.
  std::vector<int32_t> vertex_limb;
  /// Area of the surface, and its mean distance from the centrelines relative to the largest
  /// extent.
  double area = 0.0;
  double thickness = 0.0;
};

/// Finds the limbs of a connected surface that forks: the skeleton is its Reeb graph under the
/// geodesic distance from the root. The root is the widest open end or, on a closed surface, the
/// thickest end; if several thick roots end at the ground, the trunk above them. Rings are level
/// sets, spaced by about their thickness. At a fork the limb continues along the thickest and
/// straightest arc. Bumps lower than one and a half times their width are not limbs.
///
/// @param faces, vertices the component's faces and its vertices (ascending).
/// @return no value for a surface without extent.
/// @throws Cancelled when progress says stop.
///
/// Source: A. Verroust, F. Lazarus, "Extracting skeletal curves from 3D scattered data", The Visual
/// Computer 16, 2000: centres of the level sets of the geodesic distance; see reeb.h for the graph.
std::optional<WeldedTree> trace_welded(const ObjScene& scene, std::span<const int32_t> faces,
                                       std::span<const int32_t> vertices,
                                       const base::Progress& progress = {});

/// The same for a surface as LocalMesh, starting from given vertices.
/// @return as above; vertex_limb counts the mesh's vertices.
std::optional<WeldedTree> trace_welded_from(const LocalMesh& mesh, const std::vector<int32_t>& root,
                                            const base::Progress& progress = {});

}  // namespace snowbough::tree
