#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/progress.h"
#include "tree/rings/local_mesh.h"
#include "tree/welded/geodesic.h"

namespace snowbough::tree {

/// A piece of the Reeb graph: a stretch of surface between two forks, or from a fork to a tip, that
/// the level sets of the distance cut into one closed curve each.
struct ReebArc {
  /// The arc it goes on from, always of a larger index; -1 for the one at the source.
  int32_t below = -1;
  /// Arcs that go on from it, ascending; none at a tip.
  std::vector<int32_t> above;
  /// Distance from the source where it begins and ends, in metres.
  double begin = 0.0, end = 0.0;
  /// Area of its surface, with bumps that were too small to be limbs.
  double area = 0.0;

  /// Of a tube of its area and length; 0 where it has no length.
  double mean_radius() const;
};

struct ReebTree {
  /// The arc at the source last.
  std::vector<ReebArc> arcs;
  /// Per vertex: its arc, for a bump the one it sits on; -1 where no way leads.
  std::vector<int32_t> arc_of;
  /// Per vertex: the distance where its bump parts from the arc; infinite where there is none.
  std::vector<double> bump_from;
};

/// The Reeb graph of a distance over a surface, without its loops: what is left of the surface
/// beyond a distance falls into pieces where limbs part. Pieces that rise no higher than three
/// times the radius of a tube of their area and height are bumps and no arcs, but for the highest
/// one where all are.
///
/// @param distance per vertex, finite: geodesic_distances.
/// @throws Cancelled when progress says stop.
///
/// Sources: Y. Shinagawa, T. L. Kunii, "Constructing a Reeb graph automatically from cross
/// sections", IEEE Computer Graphics and Applications 11, 1991; the sweep: H. Carr, J. Snoeyink,
/// U. Axen, "Computing contour trees in all dimensions", Computational Geometry 24, 2003 (the merge
/// tree, which is all of the graph where the distance has one source).
ReebTree build_reeb_tree(const LocalMesh& mesh, const std::vector<LocalTriangle>& triangles,
                         const std::vector<double>& distance, const base::Progress& progress = {});

/// Centre, radius (mean distance from the centre) and enclosed area of the curve on which the
/// distance has one value, in one arc; all weighted by length, so that they do not depend on how
/// the surface is cut into triangles.
struct Contour {
  glm::dvec3 centre{0.0};
  double radius = 0.0;
  double area = 0.0;
  /// 0 where no triangle of the arc is crossed.
  double length = 0.0;
};

/// The contours of all arcs.
/// @param levels  per arc: distances inside it, ascending.
/// @return per arc and level.
std::vector<std::vector<Contour>> trace_contours(const LocalMesh& mesh,
                                                 const std::vector<LocalTriangle>& triangles,
                                                 const std::vector<double>& distance,
                                                 const ReebTree& tree,
                                                 const std::vector<std::vector<double>>& levels);

}  // namespace snowbough::tree
