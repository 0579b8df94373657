#include "tree/detail/limb_tubes.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace snowbough::tree {
namespace {

/// On the inside of a bend the surface keeps this share of the bend's own radius from its centre.
constexpr double kBendRoom = 0.8;

/// Corner radius of a regular polygon, over that of the circle with its area.
double corner_factor(int sides) {
  return std::sqrt(2.0 * M_PI / (sides * std::sin(2.0 * M_PI / sides)));
}

glm::dvec3 unit_or(const glm::dvec3& v, const glm::dvec3& otherwise) {
  const double length = glm::length(v);
  return length > 1e-12 ? v / length : otherwise;
}

/// Makes the section's directions square to `tangent`, turned towards it as little as possible.
void square_to(const glm::dvec3& tangent, TubeSection& section) {
  const glm::dvec3 first = section.first - tangent * glm::dot(section.first, tangent);
  const glm::dvec3 second = section.second - tangent * glm::dot(section.second, tangent);
  // Both share what it takes to make them square to each other.
  const glm::dvec3 u = unit_or(first, glm::dvec3(0.0));
  const glm::dvec3 turned = unit_or(glm::cross(second, tangent), glm::dvec3(0.0));
  const glm::dvec3 some = std::abs(tangent.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  section.first = unit_or(u + turned, unit_or(glm::cross(tangent, some), some));
  section.second = glm::cross(tangent, section.first);
}

}  // namespace

glm::dvec3 TubeSection::at(double quarter) const {
  const double angle = 0.5 * M_PI * quarter;
  glm::dvec3 off = (first * std::cos(angle) + second * std::sin(angle)) * radius;
  const double inwards = glm::dot(off, inside);
  if (inwards > room) {
    off -= inside * (inwards - room);
  }
  return centre + off;
}

LimbTubes::LimbTubes(const Surface& surface, const std::vector<LimbShape>& shapes,
                     const SurfaceCuts& cuts)
    : cuts_(cuts) {
  std::vector<int32_t> hole(surface.limbs.size(), 0);
  for (const Junction& junction : surface.junctions) {
    hole[junction.child] = 1;
  }
  limbs_.resize(surface.limbs.size());
  for (size_t b = 0; b < limbs_.size(); ++b) {
    const LimbShape& shape = shapes[b];
    const LimbSurface& limb = surface.limbs[b];
    Tube& tube = limbs_[b];
    for (size_t row = 0; row < shape.row_count(); ++row) {
      const std::vector<double>& levels = cuts.rows[b][row];
      tube.first.push_back(tube.sections.size());
      const int high = cuts.across[b][row + 1];
      const int low = row == 0 && hole[b] != 0 ? high : cuts.across[b][row];
      const int strips = static_cast<int>(levels.size()) - 1;
      // The last level is the next row's first.
      const bool last_row = row + 1 == shape.row_count();
      for (int level = 0; level < strips + (last_row ? 1 : 0); ++level) {
        TubeSection& section = tube.sections.emplace_back();
        section.centre = shape.centre(row, levels[level]);
        section.radius = shape.radius(row, levels[level]) *
                         corner_factor(4 * quads_across(low, high, strips, level));
        const auto directions = shape.corner_directions(row, levels[level]);
        section.first = directions[0];
        section.second = directions[1];
      }
    }
    const size_t count = tube.sections.size();
    const auto chord = [&](size_t i) {
      return unit_or(tube.sections[i + 1].centre - tube.sections[i].centre, glm::dvec3(0.0));
    };
    std::vector<glm::dvec3> tangents(count);
    for (size_t i = 0; i < count; ++i) {
      const glm::dvec3 in = i > 0 ? chord(i - 1) : chord(i);
      const glm::dvec3 out = i + 1 < count ? chord(i) : in;
      tangents[i] = unit_or(in + out, unit_or(in, limb.rings.front().normal));
    }
    // Both limbs share the ring where one goes on from the other.
    if (limb.continues_parent) tangents.front() = limb.rings.front().normal;
    tangents.back() = limb.rings.back().normal;
    for (size_t i = 0; i < count; ++i) {
      TubeSection& section = tube.sections[i];
      square_to(tangents[i], section);
      if (i > 0 && i + 1 < count) {
        const glm::dvec3 turn = chord(i) - chord(i - 1);
        const double shorter =
            std::min(glm::distance(tube.sections[i].centre, tube.sections[i - 1].centre),
                     glm::distance(tube.sections[i + 1].centre, tube.sections[i].centre));
        const double size = glm::length(turn);
        if (size > 1e-9) {
          section.inside = turn / size;
          section.room = kBendRoom * shorter / size;
        }
      }
    }
  }
}

glm::dvec3 LimbTubes::at(int32_t limb, int32_t row, double v, double quarter) const {
  const Tube& tube = limbs_[limb];
  const std::vector<double>& levels = cuts_.rows[limb][row];
  const auto above = std::upper_bound(levels.begin() + 1, levels.end() - 1, v);
  const auto level = static_cast<size_t>(above - levels.begin()) - 1;
  const size_t i = tube.first[row] + level;
  const double t = std::clamp((v - levels[level]) / (levels[level + 1] - levels[level]), 0.0, 1.0);
  return tube.sections[i].at(quarter) * (1.0 - t) + tube.sections[i + 1].at(quarter) * t;
}

}  // namespace snowbough::tree
