#include "tree/collars/places.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <utility>

#include "base/parallel_for.h"
#include "tree/collars/collars.h"
#include "tree/collars/unrolled_limbs.h"

namespace snowbough::tree {
namespace {

/// Around a hole, vertices are drawn to the limb's own edges by kDrawn, as long as no piece becomes
/// narrower than kNarrowest of an even one. Otherwise the middle of a row's sides would lie inside
/// them, and where a hole nearly fills its row they would make a step. Only if more than
/// kWideMargin of the row's side lies beside the hole: the fillet covers the closer vertices.
constexpr double kDrawn = 0.9;
constexpr double kNarrowest = 0.4;
constexpr double kWideMargin = 0.375;
/// Maximum extent of a collar along the limb's first row.
constexpr double kSlant = 0.85;
/// Fraction of a fork's reach within which a limb becomes round.
constexpr double kForkShare = 0.9;

/// Where a child's side begins on the finished collar.
struct SideBegin {
  double quarter = 0.0;
  /// Rotation of its beginning around the child, arc length along it, and offset from its own
  /// surface there to the collar.
  double turned = 0.0;
  double length = 0.0;
  glm::dvec3 off{0.0};
};

double mix(double a, double b, double t) {
  return a * (1.0 - t) + b * t;
}

class Placer {
 public:
  Placer(const Surface& surface, const LimbTubes& tubes, const std::vector<Fork>& forks,
         const FineMesh& fine, int threads)
      : surface_(surface),
        tubes_(tubes),
        forks_(forks),
        fine_(fine),
        threads_(threads),
        hole_of_(surface.limbs.size(), -1),
        positions_(fine.vertices.size()) {
    for (size_t j = 0; j < surface.junctions.size(); ++j) {
      const Junction& junction = surface.junctions[j];
      hole_of_[junction.child] = static_cast<int32_t>(j);
      holes_.push_back(hole_place(surface, junction));
      if (junction.inset) insets_.push_back(&junction);
    }
  }

  std::vector<glm::dvec3> place() {
    unroll();
    base::parallel_for(collars_.size(), kForkBlock, {threads_, {}}, [&](size_t begin, size_t end) {
      for (size_t j = begin; j < end; ++j) {
        if (forks_[j].blends) meet_limbs(forks_[j], tubes_, kSlant * first_row(j), collars_[j]);
      }
    });
    move_collars(collars_, forks_, tubes_, threads_, unrolled_);
    place_collars();
    place_others();
    return std::move(positions_);
  }

 private:
  static constexpr size_t kForkBlock = 16;
  static constexpr size_t kBlock = 4096;

  /// Length of a child's row next to its hole.
  double first_row(size_t junction) const {
    return tubes_.length(surface_.junctions[junction].child, 0, 1.0);
  }

  static bool is_cap(const FaceOrigin& origin) {
    return origin.part == FacePart::kTipCap || origin.part == FacePart::kRootCap;
  }

  /// Whether a face lies between a hole and the limb's first own ring.
  bool leaves_hole(const FaceOrigin& origin) const {
    return origin.part == FacePart::kWall && origin.row == 0 && hole_of_[origin.branch] >= 0;
  }

  /// Computes the collars, and every vertex' place on its limb.
  void unroll() {
    const size_t count = fine_.vertices.size();
    unrolled_.chain.assign(count, -1);
    unrolled_.places.resize(count);
    unrolled_.fixed.assign(count, 0);
    collars_.resize(surface_.junctions.size());
    for (size_t f = 0; f < fine_.quads.size(); ++f) {
      const int32_t face = fine_.face[f];
      const FaceOrigin& origin = surface_.origins[face];
      const Quad& quad = fine_.quads[f];
      if (is_cap(origin)) {
        for (const int32_t v : quad) unrolled_.fixed[v] = 1;
        continue;
      }
      const bool leaves = leaves_hole(origin);
      bool at_collar = false;
      for (int k = 0; k < 4; ++k) {
        const glm::dvec2& at = fine_.corners[f][k];
        if (leaves && at.y <= 0.0) {
          at_collar = true;
          add_to_collar(hole_of_[origin.branch], quad[k], origin.side, at.x);
        } else {
          unrolled_.chain[quad[k]] = tubes_.chain(origin.branch);
          unrolled_.places[quad[k]] = place_of(face, at.x, at.y);
        }
      }
      if (at_collar) {
        for (int k = 0; k < 4; ++k) {
          if (fine_.corners[f][k].y > 0.0) unrolled_.fixed[quad[k]] = 1;
        }
      } else {
        unrolled_.quads.push_back(quad);
      }
    }
    for (Collar& collar : collars_) {
      const auto by_quarter = [](const CollarPoint& a, const CollarPoint& b) {
        return a.quarter != b.quarter ? a.quarter < b.quarter : a.vertex < b.vertex;
      };
      std::sort(collar.begin(), collar.end(), by_quarter);
      const auto same = [](const CollarPoint& a, const CollarPoint& b) {
        return a.vertex == b.vertex;
      };
      collar.erase(std::unique(collar.begin(), collar.end(), same), collar.end());
      for (const CollarPoint& point : collar) unrolled_.places[point.vertex] = point.base;
    }
  }

  void add_to_collar(int32_t junction, int32_t vertex, int side, double u) {
    const HolePlace& hole = holes_[junction];
    const glm::dvec2 p = hole.corners[side] * (1.0 - u) + hole.corners[(side + 1) % 4] * u;
    CollarPoint point;
    point.vertex = vertex;
    point.base = on_side(hole.parent, hole.row, hole.side, p);
    // The last point of a collar is the first.
    point.quarter = side + u >= 4.0 ? 0.0 : side + u;
    unrolled_.chain[vertex] = tubes_.chain(hole.parent);
    collars_[junction].push_back(point);
  }

  TubePlace on_side(int32_t limb, int32_t row, int side, const glm::dvec2& p) const {
    return {tubes_.length(limb, row, p.y), side + p.x};
  }

  TubePlace place_of(int32_t face, double u, double v) const {
    const FaceOrigin& origin = surface_.origins[face];
    if (origin.part == FacePart::kWall) {
      return on_side(origin.branch, origin.row, origin.side, {u, v});
    }
    const HolePlace& hole = holes_[hole_of_[child_of(face)]];
    constexpr std::array<glm::dvec2, 4> kCell = {glm::dvec2(0, 0), glm::dvec2(1, 0),
                                                 glm::dvec2(1, 1), glm::dvec2(0, 1)};
    const int k = origin.inset, after = (k + 1) % 4;
    const glm::dvec2 low = kCell[k] * (1.0 - u) + kCell[after] * u;
    glm::dvec2 p = low * (1.0 - v) + (hole.corners[k] * (1.0 - u) + hole.corners[after] * u) * v;
    const size_t section = tubes_.first_section(origin.branch, origin.row);
    const double sides = tubes_.sections(origin.branch)[section].sides / 4.0;
    const double left = std::min(hole.corners[0].x, hole.corners[3].x);
    const double right = 1.0 - std::max(hole.corners[1].x, hole.corners[2].x);
    if (std::max(left, right) > kWideMargin) {
      const auto corner_x = [&](int c) {
        const bool at_left = kCell[c].x < 0.5;
        const double margin = at_left ? hole.corners[c].x : 1.0 - hole.corners[c].x;
        const double x = towards_edges(margin * v * sides, margin * sides) / sides;
        return at_left ? x : 1.0 - x;
      };
      const double a = corner_x(k), b = corner_x(after);
      p.x = a * (1.0 - u) + b * u;
      if (k % 2 == 0) {
        // Above the vertices of the row's own ring, as far as allowed.
        const double least = std::abs(b - a) * kNarrowest;
        p.x = std::clamp(low.x, std::min(a, b) + least * low.x,
                         std::max(a, b) - least * (1.0 - low.x));
      }
    }
    return on_side(origin.branch, origin.row, origin.side, p);
  }

  /// Position around the limb, drawn towards integers, where the limb has its edges; `end`, and
  /// positions beyond its last integer, stay.
  static double towards_edges(double at, double end) {
    return at < std::floor(end) ? at - kDrawn * std::sin(2.0 * M_PI * at) / (2.0 * M_PI) : at;
  }

  void place_collars() {
    begins_.resize(collars_.size());
    for (size_t j = 0; j < collars_.size(); ++j) {
      const Fork& fork = forks_[j];
      const double farthest = kSlant * first_row(j);
      for (const CollarPoint& point : collars_[j]) {
        const TubePlace& place = unrolled_.places[point.vertex];
        const double share = unrolled_.shares[point.vertex];
        const glm::dvec3 met = point.position - tubes_.at(fork.parent_chain, point.target);
        const glm::dvec3 p = tubes_.at(fork.parent_chain, place) + met * share;
        positions_[point.vertex] = p;
        const glm::dvec3 start = tubes_.centre(fork.child_chain, 0.0);
        const glm::dvec3 axis = tubes_.centre(fork.child_chain, farthest) - start;
        const double along =
            std::clamp(glm::dot(p - start, axis) / glm::dot(axis, axis), -1.0, 1.0) * farthest;
        const double length = mix(along, point.length, share);
        const double turned = point.turned * share;
        const TubePlace begin{length, point.quarter + turned};
        begins_[j].push_back(
            {point.quarter, turned, length, p - tubes_.at(fork.child_chain, begin)});
      }
    }
  }

  /// The beginning of a child's side, between two of its collar's vertices.
  SideBegin side_begin(size_t junction, double quarter) const {
    const std::vector<SideBegin>& begins = begins_[junction];
    const auto above =
        std::upper_bound(begins.begin(), begins.end(), quarter,
                         [](double q, const SideBegin& begin) { return q < begin.quarter; });
    const bool wraps = above == begins.end();
    const SideBegin& high = wraps ? begins.front() : *above;
    const SideBegin& low = above == begins.begin() ? begins.back() : *(above - 1);
    const double gap = high.quarter - low.quarter + (wraps ? 4.0 : 0.0);
    const double t = gap > 0.0 ? std::clamp((quarter - low.quarter) / gap, 0.0, 1.0) : 0.0;
    return {quarter, mix(low.turned, high.turned, t), mix(low.length, high.length, t),
            low.off * (1.0 - t) + high.off * t};
  }

  void place_others() {
    // A vertex may belong to several faces: its place is the same for all.
    std::vector<uint8_t> is_collar(positions_.size(), 0);
    for (const Collar& collar : collars_) {
      for (const CollarPoint& point : collar) is_collar[point.vertex] = 1;
    }
    base::parallel_for(positions_.size(), kBlock, {threads_, {}}, [&](size_t begin, size_t end) {
      for (size_t v = begin; v < end; ++v) {
        if (is_collar[v] != 0) continue;
        const FinePlace& at = fine_.vertices[v];
        const FaceOrigin& origin = surface_.origins[at.face];
        if (unrolled_.chain[v] < 0) {
          positions_[v] = on_cap(origin, at.u, at.v);
        } else if (leaves_hole(origin)) {
          positions_[v] = beside_hole(hole_of_[origin.branch], unrolled_.places[v]);
        } else {
          positions_[v] = tubes_.at(unrolled_.chain[v], unrolled_.places[v]);
        }
      }
    });
  }

  /// Between a collar and the child's first own ring.
  glm::dvec3 beside_hole(size_t junction, const TubePlace& place) const {
    const Fork& fork = forks_[junction];
    const double row = first_row(junction);
    const double quarter = place.quarter - 4.0 * std::floor(place.quarter / 4.0);
    const SideBegin begin = side_begin(junction, quarter);
    const double length = begin.length + (row - begin.length) * (place.length / row);
    const double fade = std::min(kForkShare * fork.reach, row - begin.length);
    const double t = std::clamp((length - begin.length) / fade, 0.0, 1.0);
    const double left = 1.0 - t * t * (3.0 - 2.0 * t);
    return tubes_.at(fork.child_chain, {length, place.quarter + begin.turned * left}) +
           begin.off * left;
  }

  /// The child of an inset's hole: its corners 2 and 3 are on the collar.
  int32_t child_of(int32_t face) const {
    const FaceOrigin& origin = surface_.origins[face];
    const std::array<int32_t, 3> at = {origin.branch, origin.row, origin.side};
    const auto found = std::lower_bound(
        insets_.begin(), insets_.end(), at,
        [](const Junction* junction, const std::array<int32_t, 3>& place) {
          return std::array{junction->parent, junction->row, junction->side} < place;
        });
    return (*found)->child;
  }

  /// Maps a square to the disc of the limb's end, ring by ring.
  glm::dvec3 on_cap(const FaceOrigin& origin, double u, double v) const {
    const bool tip = origin.part == FacePart::kTipCap;
    const double x = 2.0 * u - 1.0, y = 2.0 * v - 1.0;
    const double size = std::max(std::abs(x), std::abs(y));
    const auto sections = tubes_.sections(origin.branch);
    const TubeSection& end = tip ? sections.back() : sections.front();
    if (size < 1e-12) return end.centre;
    // Quarters from corner 0 along the square's edge through this point.
    const double a = x / size, b = y / size;
    double quarter = b <= -1.0 + 1e-12  ? 0.5 * (a + 1.0)
                     : a >= 1.0 - 1e-12 ? 1.0 + 0.5 * (b + 1.0)
                     : b >= 1.0 - 1e-12 ? 2.0 + 0.5 * (1.0 - a)
                                        : 3.0 + 0.5 * (1.0 - b);
    if (!tip) quarter = 4.0 - quarter;
    return end.centre + (end.at(quarter) - end.centre) * size;
  }

  const Surface& surface_;
  const LimbTubes& tubes_;
  const std::vector<Fork>& forks_;
  const FineMesh& fine_;
  int threads_;
  /// Per branch: its junction, or -1.
  std::vector<int32_t> hole_of_;
  /// Per junction: its hole, the collar around it, and the beginnings of the child's sides.
  std::vector<HolePlace> holes_;
  std::vector<Collar> collars_;
  std::vector<std::vector<SideBegin>> begins_;
  /// By parent, row and side.
  std::vector<const Junction*> insets_;
  UnrolledLimbs unrolled_;
  std::vector<glm::dvec3> positions_;
};

}  // namespace

std::vector<glm::dvec3> limb_positions(const Surface& surface, const LimbTubes& tubes,
                                       const std::vector<Fork>& forks, const FineMesh& fine,
                                       int threads) {
  return Placer(surface, tubes, forks, fine, threads).place();
}

}  // namespace snowbough::tree
