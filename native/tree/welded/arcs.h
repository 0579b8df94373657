#pragma once

#include <cstdint>
#include <vector>

#include "tree/rings/local_mesh.h"
#include "tree/welded/reeb.h"
#include "tree/welded/welded.h"

namespace snowbough::tree {

/// Rings of one arc of a Reeb graph from below, and where they are.
struct ArcRings {
  std::vector<double> levels;
  std::vector<Contour> contours;

  bool empty() const { return contours.empty(); }
};

/// Puts arcs together to limbs: at a fork one goes on where it is thickest and straightest, the
/// others begin at the place on its centreline to which they lead. Pieces that end at their
/// parent's side are left out.
///
/// @param rings  per arc of `tree`.
/// @param distance  per vertex, from which the tree was built.
/// @param root  the vertices at which the tree begins.
WeldedTree assemble_limbs(const ReebTree& tree, std::vector<ArcRings> rings, const LocalMesh& mesh,
                          const std::vector<double>& distance, const std::vector<int32_t>& root);

}  // namespace snowbough::tree
