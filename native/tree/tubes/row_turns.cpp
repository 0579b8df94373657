#include "tree/tubes/row_turns.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>

namespace snowbough::tree {
namespace {

/// The curve turns beside its joints, for stretches of any length: the first and last sample of a
/// stretch have this fraction of its length, and each further inwards is twice as long: so many.
constexpr double kFirstSample = 1.0 / 512.0;
constexpr size_t kSamples = 19;
/// Samples between which a limb turns by more radians than this are halved, at most this often, but
/// none shorter than this fraction of the limb's radius.
constexpr double kFineTurn = 0.05;
constexpr int kHalvings = 7;
constexpr double kShortestSample = 0.02;
/// Fraction of the pieces that are evenly distributed along a row in any case.
constexpr double kEven = 0.25;

double angle_between(const glm::dvec3& a, const glm::dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

/// A place of a row: the limb's centreline and thickness there.
struct Place {
  double at = 0.0;
  glm::dvec3 centre{0.0};
  double radius = 0.0;
  /// Length of the stretch to the next place, and the angle of its taper.
  double length = 0.0, taper = 0.0;
  /// Turn between the stretches before and after the place.
  double turn = 0.0;
  /// The stretch is to be halved; or has not been measured.
  bool is_split = false, is_new = true;

  Place(const LimbShape& shape, size_t row, double v)
      : at(v), centre(shape.centre(row, v)), radius(shape.radius(row, v)) {}
};

/// Measures the new stretches of a row, and the turns beside them.
void measure(std::vector<Place>& places) {
  for (size_t i = 0; i + 1 < places.size(); ++i) {
    Place &here = places[i], &next = places[i + 1];
    if (here.is_new) {
      here.length = glm::distance(here.centre, next.centre);
      here.taper = std::atan2(next.radius - here.radius, here.length);
    }
    if (i == 0 || (!here.is_new && !places[i - 1].is_new)) continue;
    const Place& before = places[i - 1];
    const double bend = angle_between(here.centre - before.centre, next.centre - here.centre);
    here.turn = std::isfinite(bend) ? bend + std::abs(here.taper - before.taper) : 0.0;
  }
  for (Place& place : places) place.is_new = false;
}

/// Halves the stretches beside places with large turns. False if there are none.
bool halve(const LimbShape& shape, size_t row, std::vector<Place>& places) {
  size_t more = 0;
  for (size_t i = 1; i + 1 < places.size(); ++i) {
    if (places[i].turn <= kFineTurn) continue;
    const double longer = std::max(places[i - 1].length, places[i].length);
    for (const size_t s : {i - 1, i}) {
      const double length = places[s].length;
      if (!(length >= 0.5 * longer && length > kShortestSample * places[i].radius)) continue;
      more += places[s].is_split ? 0 : 1;
      places[s].is_split = true;
    }
  }
  if (more == 0) return false;
  std::vector<Place> finer;
  finer.reserve(places.size() + more);
  for (size_t i = 0; i < places.size(); ++i) {
    finer.push_back(places[i]);
    if (!places[i].is_split) continue;
    finer.back().is_split = false;
    finer.back().is_new = true;
    finer.emplace_back(shape, row, 0.5 * (places[i].at + places[i + 1].at));
  }
  places = std::move(finer);
  measure(places);
  return true;
}

}  // namespace

double RowSamples::total() const {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

RowSamples row_turns(const LimbShape& shape, size_t row) {
  std::vector<Place> places;
  std::vector<double> joints = shape.joints(row);
  joints.insert(joints.begin(), 0.0);
  joints.push_back(1.0);
  places.reserve(kSamples * joints.size());
  for (size_t i = 0; i + 1 < joints.size(); ++i) {
    const double length = joints[i + 1] - joints[i];
    places.emplace_back(shape, row, joints[i]);
    for (double t = kFirstSample; t <= 0.5; t *= 2.0) {
      places.emplace_back(shape, row, joints[i] + length * t);
    }
    for (double t = 0.25; t >= kFirstSample; t *= 0.5) {
      places.emplace_back(shape, row, joints[i + 1] - length * t);
    }
  }
  places.emplace_back(shape, row, 1.0);
  measure(places);
  for (int pass = 0; pass < kHalvings && halve(shape, row, places); ++pass) {
  }
  const size_t count = places.size() - 1;
  RowSamples turns{{}, std::vector<double>(count, 0.0)};
  turns.at.reserve(count + 1);
  for (const Place& place : places) turns.at.push_back(place.at);
  for (size_t i = 0; i + 1 < count; ++i) {
    const double turn = places[i + 1].turn;
    turns.values[i] += 0.5 * turn;
    turns.values[i + 1] += 0.5 * turn;
  }
  // The first sample has already turned away from the ring by about as much as the next.
  turns.values[0] += 0.5 * turns.values[1];
  turns.values[count - 1] += 0.5 * turns.values[count - 2];
  return turns;
}

std::vector<double> even_pieces(int count) {
  std::vector<double> at;
  at.reserve(static_cast<size_t>(count) + 1);
  for (int i = 0; i <= count; ++i) {
    at.push_back(static_cast<double>(i) / count);
  }
  return at;
}

std::vector<double> spread_pieces(const RowSamples& wanted, int count) {
  const double even = kEven * wanted.total() + 1e-6;
  const double all = wanted.total() + even;
  std::vector<double> at;
  at.reserve(static_cast<size_t>(count) + 1);
  at.push_back(0.0);
  double sum = 0.0;
  for (size_t i = 0; i < wanted.values.size(); ++i) {
    const double length = wanted.at[i + 1] - wanted.at[i];
    const double here = wanted.values[i] + even * length;
    while (static_cast<int>(at.size()) < count &&
           sum + here >= all * static_cast<double>(at.size()) / count) {
      const double t = (all * static_cast<double>(at.size()) / count - sum) / here;
      at.push_back(wanted.at[i] + length * t);
    }
    sum += here;
  }
  at.push_back(1.0);
  return at;
}

}  // namespace snowbough::tree
