#include "tree/tubes/limb_tubes.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

namespace snowbough::tree {
namespace {

/// Minimum distance of the surface from a bend's centre on its inside, relative to the bend's
/// radius.
constexpr double kBendRoom = 0.8;

/// Ratio of a regular polygon's corner radius to the radius of the circle with its area.
double corner_factor(int sides) {
  return std::sqrt(2.0 * M_PI / (sides * std::sin(2.0 * M_PI / sides)));
}

glm::dvec3 unit_or(const glm::dvec3& v, const glm::dvec3& otherwise) {
  const double length = glm::length(v);
  return length > 1e-12 ? v / length : otherwise;
}

/// Unit directions of a limb at its sections.
std::vector<glm::dvec3> section_tangents(const LimbSurface& limb,
                                         std::span<const TubeSection> sections) {
  const size_t count = sections.size();
  const auto chord = [&](size_t i) {
    return unit_or(sections[i + 1].centre - sections[i].centre, glm::dvec3(0.0));
  };
  std::vector<glm::dvec3> tangents(count);
  for (size_t i = 0; i < count; ++i) {
    const glm::dvec3 in = i > 0 ? chord(i - 1) : chord(i);
    const glm::dvec3 out = i + 1 < count ? chord(i) : in;
    tangents[i] = unit_or(in + out, unit_or(in, limb.rings.front().normal));
  }
  // Limbs that continue one another share a ring.
  if (limb.continues_parent) tangents.front() = limb.rings.front().normal;
  tangents.back() = limb.rings.back().normal;
  return tangents;
}

/// Computes the room of sections inside their limb's bends.
void find_room(std::span<TubeSection> sections) {
  const auto chord = [&](size_t i) {
    return unit_or(sections[i + 1].centre - sections[i].centre, glm::dvec3(0.0));
  };
  for (size_t i = 1; i + 1 < sections.size(); ++i) {
    const glm::dvec3 turn = chord(i) - chord(i - 1);
    const double shorter = std::min(glm::distance(sections[i].centre, sections[i - 1].centre),
                                    glm::distance(sections[i + 1].centre, sections[i].centre));
    const double size = glm::length(turn);
    if (size > 1e-9) {
      sections[i].inside = turn / size;
      sections[i].room = kBendRoom * shorter / size;
    }
  }
}

double mix(double a, double b, double t) {
  return a * (1.0 - t) + b * t;
}

glm::dvec3 mix(const glm::dvec3& a, const glm::dvec3& b, double t) {
  return a * (1.0 - t) + b * t;
}

}  // namespace

glm::dvec3 TubeSection::at(double quarter) const {
  const auto on_circle = [&](double quarters) {
    const double angle = 0.5 * M_PI * quarters;
    return (first * std::cos(angle) + second * std::sin(angle)) * radius;
  };
  const double corner = std::floor(quarter);
  glm::dvec3 off = sides > 4 || quarter == corner
                       ? on_circle(quarter)
                       : mix(on_circle(corner), on_circle(corner + 1.0), quarter - corner);
  const double inwards = glm::dot(off, inside);
  if (inwards > room) {
    off -= inside * (inwards - room);
  }
  return centre + off;
}

std::vector<int32_t> limb_chains(const Surface& surface, const std::vector<int32_t>& parents) {
  std::vector<int32_t> chains;
  for (size_t b = 0; b < surface.limbs.size(); ++b) {
    chains.push_back(surface.limbs[b].continues_parent ? chains[parents[b]]
                                                       : static_cast<int32_t>(b));
  }
  return chains;
}

LimbTubes::LimbTubes(const Surface& surface, const std::vector<LimbShape>& shapes,
                     const BaseCuts& cuts, const std::vector<int32_t>& chains)
    : limbs_(surface.limbs.size()), tubes_(surface.limbs.size()), chains_(chains), cuts_(cuts) {
  std::vector<uint8_t> hole(surface.limbs.size(), 0);
  for (const Junction& junction : surface.junctions) {
    hole[junction.child] = 1;
  }
  for (size_t b = 0; b < limbs_.size(); ++b) {
    add_limb(shapes[b], surface.limbs[b], b, hole[b] != 0);
  }
}

void LimbTubes::add_limb(const LimbShape& shape, const LimbSurface& limb, size_t number,
                         bool hole) {
  Limb& own = limbs_[number];
  Chain& chain = tubes_[chains_[number]];
  own.first = chain.sections.size();
  /// Row and fraction of every section.
  std::vector<std::pair<size_t, double>> places;
  for (size_t row = 0; row < shape.row_count(); ++row) {
    const std::vector<double>& lines = cuts_.along.rows[number][row];
    own.rows.push_back(chain.sections.size() - own.first);
    const int high = cuts_.across[number][row + 1];
    const int low = row == 0 && hole ? high : cuts_.across[number][row];
    const int strips = static_cast<int>(lines.size()) - 1;
    const PatchCuts across{low, strips, high, strips, cuts_.along.plain[number][row]};
    // The last line is the next row's first.
    const bool last_row = row + 1 == shape.row_count();
    for (int line = 0; line < strips + (last_row ? 1 : 0); ++line) {
      TubeSection& section = chain.sections.emplace_back();
      section.centre = shape.centre(row, lines[line]);
      section.sides = 4 * quads_across(across, line);
      section.radius = shape.radius(row, lines[line]) * corner_factor(section.sides);
      places.emplace_back(row, lines[line]);
    }
  }
  own.count = chain.sections.size() - own.first;
  const std::span<TubeSection> sections{chain.sections.data() + own.first, own.count};
  const std::vector<glm::dvec3> tangents = section_tangents(limb, sections);
  for (size_t i = 0; i < own.count; ++i) {
    const Frame frame = shape.frame(places[i].first, places[i].second, tangents[i]);
    sections[i].first = frame.u;
    sections[i].second = frame.v;
  }
  find_room(sections);
  for (size_t i = own.first; i < chain.sections.size(); ++i) {
    const double step =
        i == 0 ? 0.0 : glm::distance(chain.sections[i - 1].centre, chain.sections[i].centre);
    chain.lengths.push_back(i == 0 ? 0.0 : chain.lengths.back() + step);
  }
}

double LimbTubes::length(int32_t limb, int32_t row, double v) const {
  const Limb& own = limbs_[limb];
  const std::vector<double>& lines = cuts_.along.rows[limb][row];
  const auto above = std::upper_bound(lines.begin() + 1, lines.end() - 1, v);
  const auto line = static_cast<size_t>(above - lines.begin()) - 1;
  const double t = std::clamp((v - lines[line]) / (lines[line + 1] - lines[line]), 0.0, 1.0);
  const std::vector<double>& lengths = tubes_[chains_[limb]].lengths;
  const size_t i = own.first + own.rows[row] + line;
  return mix(lengths[i], lengths[i + 1], t);
}

LimbTubes::Stretch LimbTubes::stretch(const Chain& chain, double length) const {
  const std::vector<double>& lengths = chain.lengths;
  const auto above = std::upper_bound(lengths.begin() + 1, lengths.end() - 1, length);
  const auto i = static_cast<size_t>(above - lengths.begin()) - 1;
  const double step = lengths[i + 1] - lengths[i];
  // Before the first section the limb is extended straight.
  const double least = i == 0 ? -1e30 : 0.0;
  return {i, step > 0.0 ? std::clamp((length - lengths[i]) / step, least, 1.0) : 0.0};
}

glm::dvec3 LimbTubes::centre(int32_t chain, double length) const {
  const Chain& tube = tubes_[chain];
  const auto [i, t] = stretch(tube, length);
  return mix(tube.sections[i].centre, tube.sections[i + 1].centre, t);
}

double LimbTubes::radius(int32_t chain, double length) const {
  const Chain& tube = tubes_[chain];
  const auto [i, t] = stretch(tube, length);
  return mix(tube.sections[i].radius, tube.sections[i + 1].radius, std::max(t, 0.0));
}

glm::dvec3 LimbTubes::at(int32_t chain, const TubePlace& place) const {
  const Chain& tube = tubes_[chain];
  const auto [i, t] = stretch(tube, place.length);
  const TubeSection& low = tube.sections[i];
  const TubeSection& high = tube.sections[i + 1];
  if (t < 0.0) {
    return low.at(place.quarter) + (high.centre - low.centre) * t;
  }
  return mix(low.at(place.quarter), high.at(place.quarter), t);
}

TubePlace LimbTubes::nearest(int32_t chain, const glm::dvec3& p, const TubePlace& near,
                             double window) const {
  const Chain& tube = tubes_[chain];
  const size_t first = stretch(tube, near.length - window).section;
  const size_t last = stretch(tube, near.length + window).section;
  double best = 1e300, share = 0.0;
  size_t section = first;
  for (size_t i = first; i <= last; ++i) {
    const glm::dvec3 begin = tube.sections[i].centre;
    const glm::dvec3 along = tube.sections[i + 1].centre - begin;
    const double square = glm::dot(along, along);
    const double t = square > 0.0 ? std::clamp(glm::dot(p - begin, along) / square, 0.0, 1.0) : 0.0;
    const glm::dvec3 off = p - begin - along * t;
    if (glm::dot(off, off) < best) {
      best = glm::dot(off, off);
      section = i;
      share = t;
    }
  }
  const TubeSection& low = tube.sections[section];
  const TubeSection& high = tube.sections[section + 1];
  const glm::dvec3 off = p - mix(low.centre, high.centre, share);
  const double x = glm::dot(off, mix(low.first, high.first, share));
  const double y = glm::dot(off, mix(low.second, high.second, share));
  const double quarter = std::atan2(y, x) / (0.5 * M_PI);
  return {mix(tube.lengths[section], tube.lengths[section + 1], share),
          quarter + 4.0 * std::round((near.quarter - quarter) / 4.0)};
}

std::span<const TubeSection> LimbTubes::sections(int32_t limb) const {
  const Limb& own = limbs_[limb];
  return {tubes_[chains_[limb]].sections.data() + own.first, own.count};
}

}  // namespace snowbough::tree
