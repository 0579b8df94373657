#include "tree/welded/ends.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>

#include "tree/welded/reeb.h"

namespace snowbough::tree {
namespace {

/// Minimum cosine between the limb's direction and the normals of the faces that close its end.
constexpr double kCapCosine = 0.7;
/// Fewest ends at the ground that are roots, their thickness relative to the trunk, and their reach
/// relative to the crown's.
constexpr int kFewestRoots = 2;
constexpr double kThickRoot = 0.2;
constexpr double kRootReach = 0.6;
/// A first guess that is nearly as thick as the trunk is its base.
constexpr double kThickBase = 0.75;
/// Share of the trunk's length whose vertices count as its end.
constexpr double kEndPart = 0.15;

/// The vertices of the cap that closes a limb around `end`: of the faces there that face along the
/// limb.
std::vector<int32_t> cap_around(const LocalMesh& mesh, const std::vector<LocalTriangle>& triangles,
                                int32_t end, const glm::dvec3& along) {
  std::vector<std::vector<int32_t>> facing(mesh.positions.size());
  for (size_t i = 0; i < triangles.size(); ++i) {
    const LocalTriangle& t = triangles[i];
    const glm::dvec3 a(mesh.positions[t[0]]);
    const glm::dvec3 area =
        glm::cross(glm::dvec3(mesh.positions[t[1]]) - a, glm::dvec3(mesh.positions[t[2]]) - a);
    if (std::abs(glm::dot(area, along)) < kCapCosine * glm::length(area)) continue;
    for (const int32_t v : t) facing[v].push_back(static_cast<int32_t>(i));
  }
  std::vector<char> seen(mesh.positions.size(), 0);
  std::vector<int32_t> cap{end};
  seen[end] = 1;
  for (size_t i = 0; i < cap.size(); ++i) {
    for (const int32_t triangle : facing[cap[i]]) {
      for (const int32_t v : triangles[triangle]) {
        if (seen[v] != 0) continue;
        seen[v] = 1;
        cap.push_back(v);
      }
    }
  }
  std::sort(cap.begin(), cap.end());
  return cap;
}

}  // namespace

std::vector<int32_t> widest_loop(const LocalMesh& mesh, const Topology& topology) {
  const std::vector<int32_t>* widest = nullptr;
  double most = -1.0;
  for (const std::vector<int32_t>& loop : topology.boundary_loops) {
    glm::dvec3 centre(0.0);
    for (const int32_t v : loop) centre += glm::dvec3(mesh.positions[v]);
    centre /= static_cast<double>(loop.size());
    double radius = 0.0;
    for (const int32_t v : loop) radius += glm::distance(glm::dvec3(mesh.positions[v]), centre);
    radius /= static_cast<double>(loop.size());
    if (radius > most) {
      most = radius;
      widest = &loop;
    }
  }
  return *widest;
}

std::vector<int32_t> thickest_end(const LocalMesh& mesh,
                                  const std::vector<LocalTriangle>& triangles,
                                  const base::Progress& progress) {
  const auto farthest = [](const std::vector<double>& distance) {
    int32_t best = 0;
    for (size_t v = 0; v < distance.size(); ++v) {
      if (std::isfinite(distance[v]) && distance[v] > distance[best])
        best = static_cast<int32_t>(v);
    }
    return best;
  };
  const std::vector<int32_t> first{0};
  const int32_t far =
      farthest(geodesic_distances(mesh, triangles, first, base::part_of(progress, 0.0f, 0.4f)));
  const std::vector<double> distance =
      geodesic_distances(mesh, triangles, std::vector{far}, base::part_of(progress, 0.4f, 0.8f));
  const ReebTree tree =
      build_reeb_tree(mesh, triangles, distance, base::part_of(progress, 0.8f, 1.0f));
  // The end at `far` itself, and every arc that ends in a tip.
  size_t thickest = tree.arcs.size() - 1;
  for (size_t a = 0; a < tree.arcs.size(); ++a) {
    if (tree.arcs[a].above.empty() &&
        tree.arcs[a].mean_radius() > tree.arcs[thickest].mean_radius()) {
      thickest = a;
    }
  }
  const ReebArc& arc = tree.arcs[thickest];
  const bool at_far = thickest + 1 == tree.arcs.size() && !arc.above.empty();
  int32_t end = far;
  glm::dvec3 middle(0.0);
  double members = 0.0;
  for (size_t v = 0; v < distance.size(); ++v) {
    if (tree.arc_of[v] != static_cast<int32_t>(thickest)) continue;
    middle += glm::dvec3(mesh.positions[v]);
    members += 1.0;
    const bool bump = std::isfinite(tree.bump_from[v]);
    if (!at_far && !bump && (end == far || distance[v] > distance[end])) {
      end = static_cast<int32_t>(v);
    }
  }
  middle /= std::max(members, 1.0);
  return cap_around(mesh, triangles, end, direction(middle, glm::dvec3(mesh.positions[end])));
}

std::vector<int32_t> above_roots(const LocalMesh& mesh, const std::vector<LocalTriangle>& triangles,
                                 const std::vector<int32_t>& root, const base::Progress& progress) {
  const std::vector<double> distance =
      geodesic_distances(mesh, triangles, root, base::part_of(progress, 0.0f, 0.6f));
  const ReebTree tree =
      build_reeb_tree(mesh, triangles, distance, base::part_of(progress, 0.6f, 1.0f));
  const auto wood = [](const ReebArc& arc) { return arc.area * arc.mean_radius(); };
  int32_t trunk = 0;
  const auto count = static_cast<int32_t>(tree.arcs.size());
  for (int32_t a = 1; a < count; ++a) {
    if (wood(tree.arcs[a]) > wood(tree.arcs[trunk])) trunk = a;
  }
  if (count < 4 || trunk == count - 1 || tree.arcs[trunk].above.empty()) return root;
  const ReebArc& stem = tree.arcs[trunk];
  // An arc below has a larger index.
  std::vector<char> beyond(tree.arcs.size(), 0);
  for (int32_t a = count - 1; a >= 0; --a) {
    const int32_t below = tree.arcs[a].below;
    beyond[a] = below >= 0 && (below == trunk || beyond[below] != 0) ? 1 : 0;
  }
  // Both sides of the trunk: before it, seen from the first guess, and beyond it.
  struct Side {
    std::vector<int32_t> end;
    glm::dvec3 centre{0.0};
    double reach = 0.0;
    int thick_ends = 0;
  };
  Side sides[2];
  const double part = kEndPart * (stem.end - stem.begin);
  for (size_t v = 0; v < distance.size(); ++v) {
    if (tree.arc_of[v] != trunk) continue;
    const auto add = [&](Side& side) {
      side.end.push_back(static_cast<int32_t>(v));
      side.centre += glm::dvec3(mesh.positions[v]);
    };
    if (distance[v] <= stem.begin + part) add(sides[0]);
    if (distance[v] >= stem.end - part) add(sides[1]);
  }
  for (Side& side : sides) {
    if (side.end.empty()) return root;
    side.centre /= static_cast<double>(side.end.size());
  }
  for (size_t v = 0; v < distance.size(); ++v) {
    const int32_t arc = tree.arc_of[v];
    if (arc < 0 || arc == trunk) continue;
    Side& side = sides[beyond[arc] != 0 ? 1 : 0];
    side.reach = std::max(side.reach, glm::distance(side.centre, glm::dvec3(mesh.positions[v])));
  }
  for (int32_t a = 0; a < count; ++a) {
    // An arc that ends in a tip, or at the first guess.
    if (a == trunk || (!tree.arcs[a].above.empty() && a != count - 1)) continue;
    Side& side = sides[beyond[a] != 0 ? 1 : 0];
    const double radius = tree.arcs[a].mean_radius();
    side.thick_ends += radius >= kThickRoot * stem.mean_radius() ? 1 : 0;
  }
  const Side& roots = sides[0].reach < sides[1].reach ? sides[0] : sides[1];
  const Side& crown = sides[0].reach < sides[1].reach ? sides[1] : sides[0];
  const bool begins_at_base =
      &roots == &sides[0] && tree.arcs.back().mean_radius() >= kThickBase * stem.mean_radius();
  const bool are_roots = roots.thick_ends >= kFewestRoots &&
                         roots.reach <= kRootReach * crown.reach && !begins_at_base;
  return are_roots ? roots.end : root;
}

}  // namespace snowbough::tree
