#include "tree/welded/reeb.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "base/union_find.h"

namespace snowbough::tree {
namespace {

/// Vertices between two progress reports.
constexpr size_t kVerticesPerCheck = 16384;

/// Minimum height of a limb, in radii. A cone of slope one in a plane, as from an uneven distance,
/// has two.
constexpr double kLimbHeight = 3.0;

/// An arc during the sweep: from a tip or several arcs down to the current position.
struct Growing {
  std::vector<int32_t> above;
  /// Its highest tip, and where it meets others or the source.
  double tip = 0.0;
  double end = 0.0;
  double begin = 0.0;
  /// Area of the arc, and including everything above.
  double area = 0.0;
  double all_area = 0.0;
  bool limb = false;
  /// The arc on which it is a bump, from `begin` on.
  int32_t bump_on = -1;
};

std::vector<double> vertex_areas(const LocalMesh& mesh,
                                 const std::vector<LocalTriangle>& triangles) {
  std::vector<double> areas(mesh.positions.size(), 0.0);
  for (const LocalTriangle& t : triangles) {
    const glm::dvec3 a(mesh.positions[t[0]]);
    const glm::dvec3 ab = glm::dvec3(mesh.positions[t[1]]) - a;
    const glm::dvec3 ac = glm::dvec3(mesh.positions[t[2]]) - a;
    const double third = glm::length(glm::cross(ab, ac)) / 6.0;
    for (const int32_t v : t) areas[v] += third;
  }
  return areas;
}

bool is_limb(const Growing& arc, double base) {
  const double height = arc.tip - base;
  return height > 0.0 && height * height >= kLimbHeight * arc.all_area / (2.0 * M_PI);
}

/// Sweeps from the farthest vertex to the source.
class Sweep {
 public:
  Sweep(const LocalMesh& mesh, const std::vector<LocalTriangle>& triangles,
        const std::vector<double>& distance)
      : distance_(distance),
        areas_(vertex_areas(mesh, triangles)),
        sets_(mesh.positions.size()),
        arc_at_(mesh.positions.size(), -1),
        arc_of_(mesh.positions.size(), -1) {
    for (const auto& [a, b] : edges_of(triangles)) {
      const bool a_first = comes_first(a, b);
      higher_.push_back(a_first ? std::pair(b, a) : std::pair(a, b));
    }
    std::sort(higher_.begin(), higher_.end());
  }

  ReebTree run(const base::Progress& progress) {
    std::vector<int32_t> order(distance_.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](int32_t a, int32_t b) { return comes_first(a, b); });
    for (size_t i = 0; i < order.size(); ++i) {
      if (i % kVerticesPerCheck == 0) {
        base::report_progress(progress, static_cast<float>(i) / static_cast<float>(order.size()));
      }
      if (std::isfinite(distance_[order[i]])) meet(order[i]);
    }
    return finish();
  }

 private:
  bool comes_first(int32_t a, int32_t b) const {
    return distance_[a] != distance_[b] ? distance_[a] > distance_[b] : a > b;
  }

  void meet(int32_t v) {
    std::vector<int32_t> met;
    const auto first = std::lower_bound(higher_.begin(), higher_.end(), std::pair(v, -1));
    for (auto edge = first; edge != higher_.end() && edge->first == v; ++edge) {
      met.push_back(arc_at_[sets_.find(edge->second)]);
    }
    std::sort(met.begin(), met.end());
    met.erase(std::unique(met.begin(), met.end()), met.end());
    const int32_t arc = met.empty() ? add_tip(v) : met.size() == 1 ? met[0] : merge(met, v);
    arcs_[arc].area += areas_[v];
    arcs_[arc].all_area += areas_[v];
    arcs_[arc].begin = distance_[v];
    arc_of_[v] = arc;
    for (auto edge = first; edge != higher_.end() && edge->first == v; ++edge) {
      sets_.join(v, edge->second);
    }
    arc_at_[sets_.find(v)] = arc;
  }

  int32_t add_tip(int32_t v) {
    Growing arc;
    arc.tip = arc.end = arc.begin = distance_[v];
    arcs_.push_back(std::move(arc));
    return static_cast<int32_t>(arcs_.size()) - 1;
  }

  /// Merges the arcs that meet at v: bumps are dropped; a single limb keeps its arc.
  int32_t merge(const std::vector<int32_t>& met, int32_t v) {
    const double base = distance_[v];
    std::vector<int32_t> limbs;
    int32_t highest = met.front();
    double area = 0.0;
    for (const int32_t m : met) {
      Growing& arc = arcs_[m];
      arc.limb = arc.limb || is_limb(arc, base);
      if (arc.limb) limbs.push_back(m);
      if (arc.tip > arcs_[highest].tip) highest = m;
      area += arc.all_area;
    }
    if (limbs.size() < 2) {
      const int32_t kept = limbs.empty() ? highest : limbs.front();
      for (const int32_t m : met) {
        if (m == kept) continue;
        arcs_[m].bump_on = kept;
        arcs_[m].begin = base;
        arcs_[kept].area += arcs_[m].all_area;
      }
      arcs_[kept].all_area = area;
      return kept;
    }
    Growing joined;
    joined.tip = arcs_[highest].tip;
    joined.end = joined.begin = base;
    joined.all_area = area;
    joined.limb = true;
    joined.above = limbs;
    for (const int32_t m : met) {
      arcs_[m].begin = base;
      if (!arcs_[m].limb) {
        arcs_[m].bump_on = static_cast<int32_t>(arcs_.size());
        joined.area += arcs_[m].all_area;
      }
    }
    arcs_.push_back(std::move(joined));
    return static_cast<int32_t>(arcs_.size()) - 1;
  }

  /// Renumbers the remaining arcs.
  ReebTree finish() {
    ReebTree tree;
    std::vector<int32_t> number(arcs_.size(), -1);
    for (size_t a = 0; a < arcs_.size(); ++a) {
      if (arcs_[a].bump_on >= 0) continue;
      number[a] = static_cast<int32_t>(tree.arcs.size());
      ReebArc arc;
      arc.begin = arcs_[a].begin;
      arc.end = arcs_[a].end;
      arc.area = arcs_[a].area;
      for (const int32_t up : arcs_[a].above) arc.above.push_back(number[up]);
      for (const int32_t up : arc.above) tree.arcs[up].below = number[a];
      tree.arcs.push_back(std::move(arc));
    }
    // An arc with a bump may have become a bump itself, further down.
    std::vector<int32_t> base(arcs_.size());
    std::vector<double> from(arcs_.size(), std::numeric_limits<double>::infinity());
    for (size_t a = 0; a < arcs_.size(); ++a) {
      int32_t at = static_cast<int32_t>(a);
      while (arcs_[at].bump_on >= 0) {
        from[a] = arcs_[at].begin;
        at = arcs_[at].bump_on;
      }
      base[a] = number[at];
    }
    for (const int32_t a : arc_of_) {
      tree.arc_of.push_back(a >= 0 ? base[a] : -1);
      tree.bump_from.push_back(a >= 0 ? from[a] : 0.0);
    }
    return tree;
  }

  const std::vector<double>& distance_;
  std::vector<double> areas_;
  /// Lower and higher end of each edge.
  std::vector<std::pair<int32_t, int32_t>> higher_;
  base::UnionFind sets_;
  /// Per set's representative: the arc at its lower end.
  std::vector<int32_t> arc_at_;
  std::vector<int32_t> arc_of_;
  std::vector<Growing> arcs_;
};

/// Sums over a contour.
struct Sums {
  glm::dvec3 centre{0.0};
  double length = 0.0;
  double radius = 0.0;
  glm::dvec3 area{0.0};
};

/// Calls `visit(arc, level, p, q)` for every piece p to q of a contour inside a triangle.
template <typename Visit>
void for_each_piece(const LocalMesh& mesh, const std::vector<LocalTriangle>& triangles,
                    const std::vector<double>& distance, const ReebTree& tree,
                    const std::vector<std::vector<double>>& levels, const Visit& visit) {
  for (const LocalTriangle& t : triangles) {
    int top = 0;
    double low = distance[t[0]];
    for (int k = 1; k < 3; ++k) {
      if (distance[t[k]] > distance[t[top]]) top = k;
      low = std::min(low, distance[t[k]]);
    }
    const double high = distance[t[top]];
    if (!(low < high) || !std::isfinite(high)) continue;
    const double most = std::min(high, tree.bump_from[t[top]]);
    for (int32_t arc = tree.arc_of[t[top]]; arc >= 0; arc = tree.arcs[arc].below) {
      const std::vector<double>& own = levels[arc];
      const auto first = std::upper_bound(own.begin(), own.end(), low);
      for (auto level = first; level != own.end() && *level <= most; ++level) {
        // The two crossings, in the triangle's winding order.
        std::array<glm::dvec3, 2> ends;
        std::array<bool, 2> found{};
        for (int k = 0; k < 3; ++k) {
          const double a = distance[t[k]];
          const double b = distance[t[(k + 1) % 3]];
          if ((a < *level) == (b < *level)) continue;
          const double share = (*level - a) / (b - a);
          const glm::dvec3 pa(mesh.positions[t[k]]);
          const glm::dvec3 pb(mesh.positions[t[(k + 1) % 3]]);
          const size_t which = a < *level ? 0 : 1;
          ends[which] = pa + (pb - pa) * share;
          found[which] = true;
        }
        if (found[0] && found[1]) {
          visit(arc, static_cast<size_t>(level - own.begin()), ends[0], ends[1]);
        }
      }
      if (tree.arcs[arc].begin <= low) break;
    }
  }
}

}  // namespace

double ReebArc::mean_radius() const {
  const double length = end - begin;
  return length > 0.0 ? area / (2.0 * M_PI * length) : 0.0;
}

ReebTree build_reeb_tree(const LocalMesh& mesh, const std::vector<LocalTriangle>& triangles,
                         const std::vector<double>& distance, const base::Progress& progress) {
  return Sweep(mesh, triangles, distance).run(progress);
}

std::vector<std::vector<Contour>> trace_contours(const LocalMesh& mesh,
                                                 const std::vector<LocalTriangle>& triangles,
                                                 const std::vector<double>& distance,
                                                 const ReebTree& tree,
                                                 const std::vector<std::vector<double>>& levels) {
  std::vector<std::vector<Sums>> sums(levels.size());
  for (size_t a = 0; a < levels.size(); ++a) sums[a].resize(levels[a].size());
  for_each_piece(mesh, triangles, distance, tree, levels,
                 [&](int32_t arc, size_t level, const glm::dvec3& p, const glm::dvec3& q) {
                   Sums& sum = sums[arc][level];
                   const double length = glm::distance(p, q);
                   sum.centre += 0.5 * length * (p + q);
                   sum.length += length;
                 });
  for (std::vector<Sums>& arc : sums) {
    for (Sums& sum : arc) {
      if (sum.length > 0.0) sum.centre /= sum.length;
    }
  }
  for_each_piece(mesh, triangles, distance, tree, levels,
                 [&](int32_t arc, size_t level, const glm::dvec3& p, const glm::dvec3& q) {
                   Sums& sum = sums[arc][level];
                   sum.radius += glm::distance(p, q) * glm::distance(0.5 * (p + q), sum.centre);
                   sum.area += 0.5 * glm::cross(p - sum.centre, q - sum.centre);
                 });
  std::vector<std::vector<Contour>> contours(levels.size());
  for (size_t a = 0; a < levels.size(); ++a) {
    for (const Sums& sum : sums[a]) {
      Contour contour;
      contour.centre = sum.centre;
      contour.length = sum.length;
      contour.radius = sum.length > 0.0 ? sum.radius / sum.length : 0.0;
      contour.area = glm::length(sum.area);
      contours[a].push_back(contour);
    }
  }
  return contours;
}

}  // namespace snowbough::tree
