#include "tree/welded/welded.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

#include "tree/welded/arcs.h"
#include "tree/welded/ends.h"
#include "tree/welded/geodesic.h"
#include "tree/welded/reeb.h"

namespace snowbough::tree {
namespace {

/// Distance of two rings, in radii of the limb and in mean edge lengths along it; the larger one
/// counts.
constexpr double kRingSpacing = 1.5;
constexpr double kEdgeSpacing = 0.75;
/// Maximum number of rings between two forks.
constexpr double kMaxRings = 1000.0;
/// Progress at which equal positions are welded, the edges are known, an end, and the root; and,
/// from there on, the triangles, the distances, the graph and the contours.
constexpr float kWelded = 0.1f;
constexpr float kTopology = 0.2f;
constexpr float kEnd = 0.4f;
constexpr float kRoot = 0.5f;
constexpr float kDistances = 0.05f;
constexpr float kGraph = 0.5f;
constexpr float kContours = 0.8f;
constexpr float kLimbs = 0.95f;
/// Position of an arc's end rings along its first and last stretch, as a fraction.
constexpr double kEndShare = 0.5;

/// Mean rise of the edges of each arc: the spacing of the surface's own rings.
std::vector<double> edge_rises(const std::vector<LocalTriangle>& triangles,
                               const std::vector<double>& distance, const ReebTree& tree) {
  std::vector<double> sum(tree.arcs.size(), 0.0);
  std::vector<double> square(tree.arcs.size(), 0.0);
  for (const auto& [a, b] : edges_of(triangles)) {
    if (tree.arc_of[a] < 0 || tree.arc_of[a] != tree.arc_of[b]) continue;
    const double rise = std::abs(distance[a] - distance[b]);
    sum[tree.arc_of[a]] += rise;
    square[tree.arc_of[a]] += rise * rise;
  }
  // Weighted by the rise itself: edges around the limb, without rise, do not count.
  for (size_t a = 0; a < sum.size(); ++a) sum[a] = sum[a] > 0.0 ? square[a] / sum[a] : 0.0;
  return sum;
}

std::vector<std::vector<double>> ring_levels(const std::vector<LocalTriangle>& triangles,
                                             const std::vector<double>& distance,
                                             const ReebTree& tree) {
  const std::vector<double> rises = edge_rises(triangles, distance, tree);
  std::vector<std::vector<double>> levels(tree.arcs.size());
  for (size_t a = 0; a < tree.arcs.size(); ++a) {
    const ReebArc& arc = tree.arcs[a];
    const double length = arc.end - arc.begin;
    if (length <= 0.0) continue;
    const double spacing = std::max(kRingSpacing * arc.mean_radius(), kEdgeSpacing * rises[a]);
    const double count =
        std::clamp(std::round(length / spacing), arc.above.empty() ? 2.0 : 1.0, kMaxRings);
    for (double i = 0.0; i < count; ++i) {
      levels[a].push_back(arc.begin + length * (i + kEndShare) / count);
    }
  }
  return levels;
}

double largest_extent(const LocalMesh& mesh) {
  glm::dvec3 low(std::numeric_limits<double>::max());
  glm::dvec3 high(std::numeric_limits<double>::lowest());
  for (const glm::vec3& p : mesh.positions) {
    low = glm::min(low, glm::dvec3(p));
    high = glm::max(high, glm::dvec3(p));
  }
  return std::max({high.x - low.x, high.y - low.y, high.z - low.z});
}

/// Mean radius over the surface, weighted by the arcs' areas.
double mean_thickness(const ReebTree& tree, double& area) {
  double sum = 0.0;
  area = 0.0;
  for (const ReebArc& arc : tree.arcs) {
    sum += arc.area * arc.mean_radius();
    area += arc.area;
  }
  return area > 0.0 ? sum / area : 0.0;
}

}  // namespace

std::optional<WeldedTree> trace_welded_from(const LocalMesh& mesh, const std::vector<int32_t>& root,
                                            const base::Progress& progress) {
  const double extent = largest_extent(mesh);
  if (!(extent > 0.0) || root.empty()) return std::nullopt;
  const std::vector<LocalTriangle> triangles = triangulate(mesh);
  const std::vector<double> distance =
      geodesic_distances(mesh, triangles, root, base::part_of(progress, kDistances, kGraph));
  const ReebTree tree =
      build_reeb_tree(mesh, triangles, distance, base::part_of(progress, kGraph, kContours));
  if (tree.arcs.empty()) return std::nullopt;
  const std::vector<std::vector<double>> levels = ring_levels(triangles, distance, tree);
  base::report_progress(progress, kContours);
  const std::vector<std::vector<Contour>> contours =
      trace_contours(mesh, triangles, distance, tree, levels);
  std::vector<ArcRings> rings(tree.arcs.size());
  for (size_t a = 0; a < rings.size(); ++a) {
    for (size_t i = 0; i < levels[a].size(); ++i) {
      if (!(contours[a][i].length > 0.0)) continue;
      rings[a].levels.push_back(levels[a][i]);
      rings[a].contours.push_back(contours[a][i]);
    }
  }
  base::report_progress(progress, kLimbs);
  WeldedTree welded = assemble_limbs(tree, std::move(rings), mesh, distance, root);
  welded.thickness = mean_thickness(tree, welded.area) / extent;
  return welded;
}

std::optional<WeldedTree> trace_welded(const ObjScene& scene, std::span<const int32_t> faces,
                                       std::span<const int32_t> vertices,
                                       const base::Progress& progress) {
  base::report_progress(progress, 0.0f);
  std::vector<int32_t> number;
  const LocalMesh mesh = weld_equal_positions(extract_component(scene, faces, vertices), &number);
  if (mesh.face_count() == 0) return std::nullopt;
  base::report_progress(progress, kWelded);
  const Topology topology = build_topology(mesh);
  base::report_progress(progress, kTopology);
  const std::vector<LocalTriangle> triangles = triangulate(mesh);
  const std::vector<int32_t> end =
      topology.boundary_loops.empty()
          ? thickest_end(mesh, triangles, base::part_of(progress, kTopology, kEnd))
          : widest_loop(mesh, topology);
  const std::vector<int32_t> root =
      above_roots(mesh, triangles, end, base::part_of(progress, kEnd, kRoot));
  std::optional<WeldedTree> welded =
      trace_welded_from(mesh, root, base::part_of(progress, kRoot, 1.0f));
  if (!welded) return welded;
  std::vector<int32_t> limb;
  for (const int32_t v : number) limb.push_back(welded->vertex_limb[v]);
  welded->vertex_limb = std::move(limb);
  return welded;
}

}  // namespace snowbough::tree
