#include "tree/tubes/row_turns.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>

namespace snowbough::tree {
namespace {

/// The curve turns beside its joints, for stretches of any length: the first and last sample of a
/// stretch have this fraction of its length, and each further inwards is twice as long.
constexpr double kFirstSample = 1.0 / 512.0;
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

/// A limb's centreline and thickness at some places of a row.
struct Profile {
  std::vector<double> at;
  std::vector<glm::dvec3> centre;
  std::vector<double> radius;

  void add(const LimbShape& shape, size_t row, double v) {
    at.push_back(v);
    centre.push_back(shape.centre(row, v));
    radius.push_back(shape.radius(row, v));
  }
  double length(size_t i) const { return glm::distance(centre[i], centre[i + 1]); }
  double taper(size_t i) const { return std::atan2(radius[i + 1] - radius[i], length(i)); }
  /// Turn between the stretches before and after place i.
  double turn(size_t i) const {
    const double bend = angle_between(centre[i] - centre[i - 1], centre[i + 1] - centre[i]);
    return std::isfinite(bend) ? bend + std::abs(taper(i) - taper(i - 1)) : 0.0;
  }
};

/// Halves the stretches of a profile beside places with large turns. False if there are none.
bool halve(const LimbShape& shape, size_t row, Profile& profile) {
  const size_t stretches = profile.at.size() - 1;
  std::vector<uint8_t> split(stretches, 0);
  bool any = false;
  for (size_t i = 1; i < stretches; ++i) {
    if (profile.turn(i) <= kFineTurn) continue;
    const double longer = std::max(profile.length(i - 1), profile.length(i));
    for (const size_t s : {i - 1, i}) {
      const double length = profile.length(s);
      if (length >= 0.5 * longer && length > kShortestSample * profile.radius[i]) {
        split[s] = 1;
        any = true;
      }
    }
  }
  if (!any) return false;
  Profile finer;
  for (size_t s = 0; s < stretches; ++s) {
    finer.at.push_back(profile.at[s]);
    finer.centre.push_back(profile.centre[s]);
    finer.radius.push_back(profile.radius[s]);
    if (split[s] != 0) finer.add(shape, row, 0.5 * (profile.at[s] + profile.at[s + 1]));
  }
  finer.at.push_back(profile.at.back());
  finer.centre.push_back(profile.centre.back());
  finer.radius.push_back(profile.radius.back());
  profile = std::move(finer);
  return true;
}

}  // namespace

double RowSamples::total() const {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

RowSamples row_turns(const LimbShape& shape, size_t row) {
  Profile profile;
  std::vector<double> joints = shape.joints(row);
  joints.insert(joints.begin(), 0.0);
  joints.push_back(1.0);
  for (size_t i = 0; i + 1 < joints.size(); ++i) {
    const double length = joints[i + 1] - joints[i];
    profile.add(shape, row, joints[i]);
    for (double t = kFirstSample; t <= 0.5; t *= 2.0) {
      profile.add(shape, row, joints[i] + length * t);
    }
    for (double t = 0.25; t >= kFirstSample; t *= 0.5) {
      profile.add(shape, row, joints[i + 1] - length * t);
    }
  }
  profile.add(shape, row, 1.0);
  for (int pass = 0; pass < kHalvings && halve(shape, row, profile); ++pass) {
  }
  const size_t count = profile.at.size() - 1;
  RowSamples turns{std::move(profile.at), std::vector<double>(count, 0.0)};
  for (size_t i = 0; i + 1 < count; ++i) {
    const double turn = profile.turn(i + 1);
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
  std::vector<double> at = {0.0};
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
