#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "tree/detail/cuts.h"
#include "tree/detail/limb_shape.h"
#include "tree/surface/surface.h"

namespace snowbough::tree {

/// A round section of a limb.
struct TubeSection {
  glm::dvec3 centre{0.0};
  /// Unit, square to each other and to the limb: towards corners 0 and 1 of the square ring.
  glm::dvec3 first{1.0, 0.0, 0.0}, second{0.0, 1.0, 0.0};
  /// Of the corners of a polygon with as many sides as the limb has here and the limb's area.
  double radius = 0.0;
  /// Unit, towards the inside of the limb's bend, and how far the surface may reach there before it
  /// would fold; zero where the limb is straight.
  glm::dvec3 inside{0.0};
  double room = 0.0;

  /// The point of the section's surface at `quarter`: quarter turns from corner 0.
  glm::dvec3 at(double quarter) const;
};

/// All limbs as round sections at the levels at which their rows are cut.
class LimbTubes {
 public:
  LimbTubes(const Surface& surface, const std::vector<LimbShape>& shapes, const SurfaceCuts& cuts);

  /// A limb's surface at the share `v` of a row: between two levels on the straight way from one to
  /// the other.
  glm::dvec3 at(int32_t limb, int32_t row, double v, double quarter) const;

  /// The sections of a limb, in order; of `row`, the first is number first_section(limb, row).
  const std::vector<TubeSection>& sections(int32_t limb) const { return limbs_[limb].sections; }
  size_t first_section(int32_t limb, int32_t row) const { return limbs_[limb].first[row]; }

 private:
  struct Tube {
    std::vector<TubeSection> sections;
    /// Per row: its first section; its last one is the next row's first.
    std::vector<size_t> first;
  };

  std::vector<Tube> limbs_;
  const SurfaceCuts& cuts_;
};

}  // namespace snowbough::tree
