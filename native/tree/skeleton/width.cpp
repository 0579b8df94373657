#include "tree/skeleton/width.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <stdexcept>

#include "tree/skeleton/centreline.h"

namespace snowbough::tree {
namespace {

/// Parameters of the inverse width of one branch.
struct Flare {
  float root = 0.0f;
  float bound = 4.0f;
  std::vector<float> arcs;
};

float flare_at(const Flare& flare, float arc) {
  const float length = flare.arcs.back();
  return inverse_width(flare.root, length > 0.0f ? std::min(arc / length, 1.0f) : 0.0f,
                       flare.bound);
}

void check_bound(float bound) {
  if (!std::isfinite(bound) || bound <= 1.0f) {
    throw std::invalid_argument("the bound X of the inverse width must be more than 1");
  }
}

}  // namespace

float inverse_width(float root, float t, float bound) {
  const double x = bound;
  const double value = root * (1.0 / ((x - 1.0) * t + 1.0) - 1.0 / x) / (1.0 - 1.0 / x);
  return static_cast<float>(std::max(value, 0.0));
}

Widths limb_widths(const Skeleton& skeleton, const WidthOptions& options) {
  check_bound(options.bound);
  check_bound(options.evergreen_bound);
  const float smallest = kSmallestRadius * skeleton.height;
  const float smallest_area = std::numbers::pi_v<float> * smallest * smallest;
  Widths widths;
  std::vector<Flare> flares;
  for (const Branch& branch : skeleton.branches) {
    std::vector<float> radii = branch.radii;
    std::vector<float> areas = branch.areas;
    if (options.mode == WidthMode::kInverse) {
      Flare flare;
      flare.arcs = arc_lengths(branch);
      const bool first_level = branch.level == 1;
      flare.bound = options.species == Species::kEvergreen && first_level ? options.evergreen_bound
                                                                          : options.bound;
      if (branch.parent >= 0) {
        const Branch& parent = skeleton.branches[branch.parent];
        const CentrelinePlace place = nearest_place(parent, branch.attach_point);
        const Flare& parent_flare = flares[branch.parent];
        const float arc = parent_flare.arcs[place.segment] +
                          glm::distance(parent.points[place.segment], place.point);
        flare.root = std::max(flare_at(parent_flare, arc), smallest);
      } else {
        flare.root = branch.radii.front() > 0.0f
                         ? branch.radii.front()
                         : *std::max_element(branch.radii.begin(), branch.radii.end());
      }
      for (size_t i = 0; i < radii.size(); ++i) {
        radii[i] = flare_at(flare, flare.arcs[i]);
        areas[i] = std::numbers::pi_v<float> * radii[i] * radii[i];
      }
      flares.push_back(std::move(flare));
    }
    for (float& radius : radii) radius = std::max(radius, smallest);
    for (float& area : areas) area = std::max(area, smallest_area);
    widths.radii.push_back(std::move(radii));
    widths.areas.push_back(std::move(areas));
  }
  return widths;
}

}  // namespace snowbough::tree
