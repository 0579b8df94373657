#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "tree/surface/surface.h"
#include "tree/tubes/cuts.h"
#include "tree/tubes/limb_shape.h"

namespace snowbough::tree {

/// A round section of a limb.
struct TubeSection {
  glm::dvec3 centre{0.0};
  /// Unit vectors perpendicular to each other and to the limb: towards corners 0 and 1 of the
  /// square ring.
  glm::dvec3 first{1.0, 0.0, 0.0}, second{0.0, 1.0, 0.0};
  /// Corner radius of a polygon with the limb's number of sides here and the limb's area.
  double radius = 0.0;
  /// Number of sides of that polygon. With four the surface is flat between the corners: a round
  /// one would stick out by two fifths where a smaller limb leaves a side.
  int sides = 4;
  /// Unit vector towards the inside of the limb's bend, and the distance at which the surface would
  /// fold there; zero if the limb is straight.
  glm::dvec3 inside{0.0};
  double room = 0.0;

  /// Point of the section's surface at `quarter` quarter turns from corner 0.
  glm::dvec3 at(double quarter) const;
};

/// A place on a limb's surface, unrolled: arc length along its chain, quarter turns around it.
struct TubePlace {
  double length = 0.0;
  double quarter = 0.0;
};

/// Per branch: its chain. Limbs that continue one another form one chain, identified by its first
/// branch.
std::vector<int32_t> limb_chains(const Surface& surface, const std::vector<int32_t>& parents);

/// All limbs as round sections at the lines where their rows are cut. The surface is linear
/// between two sections and extended straight before the first, for limbs that begin inside their
/// parent.
class LimbTubes {
 public:
  LimbTubes(const Surface& surface, const std::vector<LimbShape>& shapes, const BaseCuts& cuts,
            const std::vector<int32_t>& chains);

  int32_t chain(int32_t limb) const { return chains_[limb]; }

  /// Number of sides of a limb where it leaves its parent.
  int first_sides(int32_t limb) const { return 4 * cuts_.across[limb].front(); }

  /// Arc length along a limb's chain at the fraction `v` of a row.
  double length(int32_t limb, int32_t row, double v) const;

  /// The centreline, and the surface.
  glm::dvec3 centre(int32_t chain, double length) const;
  glm::dvec3 at(int32_t chain, const TubePlace& place) const;
  double radius(int32_t chain, double length) const;

  /// The place on a chain nearest to a point, within `window` metres of another place along it; its
  /// quarter is within two of that place's.
  TubePlace nearest(int32_t chain, const glm::dvec3& p, const TubePlace& near, double window) const;

  /// The sections of a limb, in order; the first of `row` is number first_section(limb, row).
  std::span<const TubeSection> sections(int32_t limb) const;
  size_t first_section(int32_t limb, int32_t row) const { return limbs_[limb].rows[row]; }

 private:
  struct Limb {
    /// Its first section on the chain, and their number.
    size_t first = 0, count = 0;
    /// Per row: its first section, counted from the limb's own; its last one is the next row's
    /// first.
    std::vector<size_t> rows;
  };
  struct Chain {
    std::vector<TubeSection> sections;
    /// Arc length of each; where a limb continues another both have a section at the same place.
    std::vector<double> lengths;
  };
  /// A section's number and the fraction of the distance to the next.
  struct Stretch {
    size_t section = 0;
    double share = 0.0;
  };

  void add_limb(const LimbShape& shape, const LimbSurface& limb, size_t number, bool hole);
  Stretch stretch(const Chain& chain, double length) const;

  std::vector<Limb> limbs_;
  /// Per branch; only filled for the first of a chain.
  std::vector<Chain> tubes_;
  std::vector<int32_t> chains_;
  const BaseCuts& cuts_;
};

}  // namespace snowbough::tree
