#include "tree/skeleton/centreline.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

namespace snowbough::tree {
namespace {

size_t segment_end(const Branch& branch, const CentrelinePlace& place) {
  return std::min(place.segment + 1, branch.points.size() - 1);
}

}  // namespace

CentrelinePlace nearest_place(const Branch& branch, const glm::vec3& point) {
  CentrelinePlace best;
  best.point = branch.points.front();
  double best_squared = std::numeric_limits<double>::max();
  const glm::dvec3 p(point);
  for (size_t i = 0; i + 1 < branch.points.size(); ++i) {
    const glm::dvec3 a(branch.points[i]);
    const glm::dvec3 along = glm::dvec3(branch.points[i + 1]) - a;
    const double squared = glm::dot(along, along);
    const double t = squared > 0.0 ? std::clamp(glm::dot(p - a, along) / squared, 0.0, 1.0) : 0.0;
    const glm::dvec3 foot = a + t * along;
    const double distance = glm::dot(p - foot, p - foot);
    if (distance < best_squared) {
      best_squared = distance;
      best = {i, static_cast<float>(t), glm::vec3(foot)};
    }
  }
  return best;
}

std::vector<float> arc_lengths(const Branch& branch) {
  std::vector<float> lengths;
  lengths.reserve(branch.points.size());
  double length = 0.0;
  for (size_t i = 0; i < branch.points.size(); ++i) {
    if (i > 0) {
      length += glm::distance(glm::dvec3(branch.points[i - 1]), glm::dvec3(branch.points[i]));
    }
    lengths.push_back(static_cast<float>(length));
  }
  return lengths;
}

float polyline_length(const std::vector<glm::vec3>& points) {
  float length = 0.0f;
  for (size_t i = 1; i < points.size(); ++i) {
    length += glm::distance(points[i - 1], points[i]);
  }
  return length;
}

float radius_at(const Branch& branch, const CentrelinePlace& place) {
  const float a = branch.radii[place.segment];
  const float b = branch.radii[segment_end(branch, place)];
  return a + place.t * (b - a);
}

float area_at(const Branch& branch, const CentrelinePlace& place) {
  const float a = std::sqrt(branch.areas[place.segment]);
  const float b = std::sqrt(branch.areas[segment_end(branch, place)]);
  const float root = a + place.t * (b - a);
  return root * root;
}

}  // namespace snowbough::tree
