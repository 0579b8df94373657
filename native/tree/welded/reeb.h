#pragma once

#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "base/progress.h"
#include "tree/rings/local_mesh.h"
#include "tree/welded/geodesic.h"

namespace snowbough::tree {

/// Unit vector from one point to another; zero if they coincide.
inline glm::dvec3 direction(const glm::dvec3& from, const glm::dvec3& to) {
  const double length = glm::distance(from, to);
  return length > 0.0 ? (to - from) / length : glm::dvec3(0.0);
}

/// An arc of the Reeb graph: a stretch of surface between two forks, or from a fork to a tip, on
/// which every level set of the distance is one closed curve.
struct ReebArc {
  /// The arc that it continues, always of a larger index; -1 for the arc at the source.
  int32_t below = -1;
  /// Arcs that continue it, ascending; none at a tip.
  std::vector<int32_t> above;
  /// Distance from the source at its begin and end, in metres.
  double begin = 0.0, end = 0.0;
  /// Area of its surface, including bumps that are too small to be limbs.
  double area = 0.0;

  /// Radius of a tube of the same area and length; 0 without length.
  double mean_radius() const;
};

struct ReebTree {
  /// The arc at the source is last.
  std::vector<ReebArc> arcs;
  /// Per vertex: its arc, or the arc on which its bump sits; -1 if unreachable.
  std::vector<int32_t> arc_of;
  /// Per vertex: the distance at which its bump leaves the arc; infinite outside bumps.
  std::vector<double> bump_from;
};

/// The Reeb graph of a distance over a surface, without its loops: beyond a distance, the rest of
/// the surface separates into components where limbs fork. A component no higher than three times
/// the radius of a tube of its area and height is a bump, not an arc; if all are, the highest one
/// is an arc.
///
/// @param distance per vertex, finite: geodesic_distances.
/// @throws Cancelled when progress says stop.
///
/// Sources: Y. Shinagawa, T. L. Kunii, "Constructing a Reeb graph automatically from cross
/// sections", IEEE Computer Graphics and Applications 11, 1991; the sweep: H. Carr, J. Snoeyink,
/// U. Axen, "Computing contour trees in all dimensions", Computational Geometry 24, 2003 (the merge
/// tree, which equals the graph for a distance with one source).
ReebTree build_reeb_tree(const LocalMesh& mesh, const std::vector<LocalTriangle>& triangles,
                         const std::vector<double>& distance, const base::Progress& progress = {});

/// Centre, radius (mean distance from the centre) and enclosed area of the curve of equal distance
/// in one arc; weighted by length, so that they do not depend on the triangulation.
struct Contour {
  glm::dvec3 centre{0.0};
  double radius = 0.0;
  double area = 0.0;
  /// 0 if it crosses no triangle of the arc.
  double length = 0.0;
};

/// Traces the contours of all arcs.
/// @param levels  per arc: distances inside it, ascending.
/// @return per arc and level.
std::vector<std::vector<Contour>> trace_contours(const LocalMesh& mesh,
                                                 const std::vector<LocalTriangle>& triangles,
                                                 const std::vector<double>& distance,
                                                 const ReebTree& tree,
                                                 const std::vector<std::vector<double>>& levels);

}  // namespace snowbough::tree
