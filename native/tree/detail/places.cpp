#include "tree/detail/places.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

namespace snowbough::tree {
namespace {

/// Corners of a hole stay so far inside their side.
constexpr double kLeastMargin = 0.02;

/// A rim reaches at most this share of the limb's first row along it.
constexpr double kSlant = 0.8;
/// Within this share of a fork's reach a limb becomes round.
constexpr double kForkShare = 0.9;

/// The opening that a limb grows out of: its corners on one side of a row of the parent, as shares
/// of the side and of the row.
struct HolePlace {
  int32_t parent = -1;
  int32_t row = 0, side = 0;
  /// Of the limb's first row, where the fork has a say.
  double share = 1.0;
  /// From the hole to the limb's first own ring.
  glm::dvec3 axis{0.0};
  std::array<glm::dvec2, 4> corners = {glm::dvec2(0, 0), glm::dvec2(1, 0), glm::dvec2(1, 1),
                                       glm::dvec2(0, 1)};
};

HolePlace hole_place(const Surface& surface, const Junction& junction) {
  HolePlace place;
  place.parent = junction.parent;
  place.row = junction.row;
  place.side = junction.side;
  if (!junction.inset) return place;
  const LimbSurface& parent = surface.limbs[junction.parent];
  const Ring& low = parent.rings[junction.row];
  const Ring& high = parent.rings[junction.row + 1];
  const int after = (junction.side + 1) % 4;
  const auto point = [&](int32_t vertex) { return surface.vertices[vertex]; };
  const glm::dvec3 p0 = point(low.vertices[junction.side]), p1 = point(low.vertices[after]);
  const glm::dvec3 p2 = point(high.vertices[after]), p3 = point(high.vertices[junction.side]);
  const glm::dvec3 across = 0.5 * (p1 + p2 - p0 - p3), along = 0.5 * (p2 + p3 - p0 - p1);
  const glm::dvec3 middle = 0.25 * (p0 + p1 + p2 + p3);
  const auto share = [](const glm::dvec3& p, const glm::dvec3& axis, double low_end) {
    return std::clamp(0.5 + glm::dot(p, axis) / glm::dot(axis, axis), low_end, 1.0 - low_end);
  };
  const Ring& hole = surface.limbs[junction.child].rings.front();
  for (int k = 0; k < 4; ++k) {
    const glm::dvec3 p = point(hole.vertices[k]) - middle;
    // On a round side a flat side's middle third lies closer together: by angle, not by length.
    const double x = 2.0 * share(p, across, kLeastMargin) - 1.0;
    place.corners[k] = {0.5 + 2.0 / M_PI * std::atan(x), share(p, along, kLeastMargin)};
  }
  return place;
}

class Placer {
 public:
  Placer(const Surface& surface, const LimbTubes& tubes, const std::vector<Fork>& forks)
      : surface_(surface), tubes_(tubes), holes_(surface.limbs.size()) {
    for (const Junction& junction : surface.junctions) {
      HolePlace& hole = holes_[junction.child] = hole_place(surface, junction);
      const std::vector<Ring>& rings = surface.limbs[junction.child].rings;
      const double reach = forks[&junction - surface.junctions.data()].reach;
      hole.axis = rings[1].centre - rings[0].centre;
      hole.share =
          std::min(1.0, kForkShare * reach / glm::distance(rings[0].centre, rings[1].centre));
    }
    for (const Junction& junction : surface.junctions) {
      if (junction.inset) insets_.push_back(&junction);
    }
  }

  glm::dvec3 at(const FinePlace& place) const {
    const FaceOrigin& origin = surface_.origins[place.face];
    switch (origin.part) {
      case FacePart::kWall:
        return on_wall(origin, place.u, place.v);
      case FacePart::kInset:
        return on_inset(place);
      default:
        return on_cap(origin, place.u, place.v);
    }
  }

 private:
  glm::dvec3 on_side(int32_t limb, int32_t row, int side, double u, double v) const {
    return tubes_.at(limb, row, v, side + u);
  }

  /// On a hole's rim, at the share `u` of the way from its corner `side` to the next.
  glm::dvec3 on_rim(const HolePlace& hole, int side, double u) const {
    const glm::dvec2 p = hole.corners[side] * (1.0 - u) + hole.corners[(side + 1) % 4] * u;
    return on_side(hole.parent, hole.row, hole.side, p.x, p.y);
  }

  glm::dvec3 on_wall(const FaceOrigin& origin, double u, double v) const {
    const HolePlace& hole = holes_[origin.branch];
    if (origin.row > 0 || hole.parent < 0) {
      return on_side(origin.branch, origin.row, origin.side, u, v);
    }
    // The rim lies askew: each side begins where it stands along the limb, and its distance from
    // the limb's own surface fades away.
    const glm::dvec3 rim = on_rim(hole, origin.side, u);
    const std::vector<TubeSection>& sections = tubes_.sections(origin.branch);
    const glm::dvec3 base = sections.front().centre;
    const double begin = std::clamp(
        glm::dot(rim - base, hole.axis) / glm::dot(hole.axis, hole.axis), -kSlant, kSlant);
    const auto on_limb = [&](double share) {
      const double inside = std::min(share, 0.0);
      return on_side(origin.branch, 0, origin.side, u, share - inside) + hole.axis * inside;
    };
    const double t = std::clamp(v / hole.share, 0.0, 1.0);
    return on_limb(begin + (1.0 - begin) * v) +
           (rim - on_limb(begin)) * (1.0 - t * t * (3.0 - 2.0 * t));
  }

  glm::dvec3 on_inset(const FinePlace& place) const {
    const FaceOrigin& origin = surface_.origins[place.face];
    const HolePlace& hole = holes_[child_of(place.face)];
    constexpr std::array<glm::dvec2, 4> kCell = {glm::dvec2(0, 0), glm::dvec2(1, 0),
                                                 glm::dvec2(1, 1), glm::dvec2(0, 1)};
    const int k = origin.inset, after = (k + 1) % 4;
    const glm::dvec2 p =
        (kCell[k] * (1.0 - place.u) + kCell[after] * place.u) * (1.0 - place.v) +
        (hole.corners[k] * (1.0 - place.u) + hole.corners[after] * place.u) * place.v;
    return on_side(origin.branch, origin.row, origin.side, p.x, p.y);
  }

  /// The child whose hole an inset lies around: its corners 2 and 3 are on the rim.
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

  /// A square laid onto the disc of the limb's end, ring by ring.
  glm::dvec3 on_cap(const FaceOrigin& origin, double u, double v) const {
    const bool tip = origin.part == FacePart::kTipCap;
    const double x = 2.0 * u - 1.0, y = 2.0 * v - 1.0;
    const double size = std::max(std::abs(x), std::abs(y));
    const auto& sections = tubes_.sections(origin.branch);
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
  std::vector<HolePlace> holes_;
  /// By parent, row and side.
  std::vector<const Junction*> insets_;
};

}  // namespace

std::vector<glm::dvec3> limb_positions(const Surface& surface, const LimbTubes& tubes,
                                       const std::vector<Fork>& forks,
                                       const std::vector<FinePlace>& places) {
  const Placer placer(surface, tubes, forks);
  std::vector<glm::dvec3> positions;
  positions.reserve(places.size());
  for (const FinePlace& place : places) {
    positions.push_back(placer.at(place));
  }
  return positions;
}

}  // namespace snowbough::tree
