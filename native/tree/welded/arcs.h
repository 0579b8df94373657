#pragma once

#include <cstdint>
#include <vector>

#include "tree/rings/local_mesh.h"
#include "tree/welded/reeb.h"
#include "tree/welded/welded.h"

namespace snowbough::tree {

/// The rings of one arc of a Reeb graph from below, and their distances.
struct ArcRings {
  std::vector<double> levels;
  std::vector<Contour> contours;

  bool empty() const { return contours.empty(); }
};

/// Joins arcs to limbs: at a fork the limb continues along the thickest and straightest arc; the
/// others begin at their attach point on its centreline. Arcs that end within their parent's radius
/// are left out.
///
/// @param rings  per arc of `tree`.
/// @param distance  per vertex, as used for the tree.
/// @param root  the vertices where the tree begins.
WeldedTree assemble_limbs(const ReebTree& tree, std::vector<ArcRings> rings, const LocalMesh& mesh,
                          const std::vector<double>& distance, const std::vector<int32_t>& root);

}  // namespace snowbough::tree
