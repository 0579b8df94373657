#include "tree/read/plausible.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>

#include "tree/skeleton/centreline.h"

namespace snowbough::tree {
namespace {

constexpr size_t kFewBranches = 4;
/// Ends whose radii differ by less than this factor are equally thick.
constexpr float kEqual = 0.95f;
/// Fraction of branches without taper at which they are bars.
constexpr double kBars = 0.75;
/// A limb is thinner than its parent if its radius is below this fraction of the parent's.
constexpr float kThinner = 0.8f;
/// Fraction of branches on thicker ones below which they are not limbs.
constexpr double kStandOnThicker = 0.5;
/// Limbs shorter than this many of their radii are blocks; and the fraction of blocks at which
/// pieces are not limbs.
constexpr float kBlock = 4.0f;
constexpr double kBlocks = 0.5;

/// Fraction of straight bars, along three perpendicular directions, at which they are a frame; sine
/// of the allowed angle; and maximum length of a straight bar relative to the distance of its ends.
constexpr double kFramed = 0.75;
constexpr float kOffAngle = 0.05f;
constexpr float kBend = 0.01f;

bool tapers(const Branch& branch) {
  const auto [thin, thick] = std::minmax_element(branch.radii.begin(), branch.radii.end());
  return *thin < kEqual * *thick;
}

bool is_block(const Branch& branch) {
  return polyline_length(branch.points) <
         kBlock * *std::max_element(branch.radii.begin(), branch.radii.end());
}

/// Vector from end to end of a straight branch; else zero.
glm::vec3 straight_vector(const Branch& branch) {
  const glm::vec3 vector = branch.points.back() - branch.points.front();
  return polyline_length(branch.points) <= (1.0f + kBend) * glm::length(vector) ? vector
                                                                                : glm::vec3(0.0f);
}

/// Number of branches that are straight along the longest one, the longest perpendicular to it, or
/// perpendicular to both.
size_t count_framed(const std::vector<Branch>& branches) {
  std::vector<glm::vec3> vectors;
  for (const Branch& branch : branches) {
    const glm::vec3 vector = straight_vector(branch);
    if (glm::length(vector) > 0.0f) vectors.push_back(vector);
  }
  std::sort(vectors.begin(), vectors.end(),
            [](const glm::vec3& a, const glm::vec3& b) { return glm::length(a) > glm::length(b); });
  std::vector<glm::vec3> axes;
  size_t framed = 0;
  for (const glm::vec3& vector : vectors) {
    const glm::vec3 direction = glm::normalize(vector);
    const auto along = [&](const glm::vec3& axis) {
      return glm::length(glm::cross(axis, direction)) <= kOffAngle;
    };
    const auto square = [&](const glm::vec3& axis) {
      return std::abs(glm::dot(axis, direction)) <= kOffAngle;
    };
    if (std::any_of(axes.begin(), axes.end(), along)) {
      ++framed;
    } else if (std::all_of(axes.begin(), axes.end(), square)) {
      axes.push_back(direction);
      ++framed;
    }
  }
  return framed;
}

std::string of(size_t count, size_t all) {
  return std::to_string(count) + " of its " + std::to_string(all);
}

}  // namespace

std::string why_no_tree(const std::vector<Branch>& branches) {
  if (branches.size() < kFewBranches) return "";
  size_t bars = 0;
  size_t standing = 0;
  size_t on_thicker = 0;
  size_t blocks = 0;
  for (const Branch& branch : branches) {
    bars += tapers(branch) ? 0 : 1;
    blocks += is_block(branch) ? 1 : 0;
    if (branch.parent < 0) continue;
    ++standing;
    const Branch& parent = branches[branch.parent];
    const float there = radius_at(parent, nearest_place(parent, branch.attach_point));
    on_thicker += branch.radii.front() < kThinner * there ? 1 : 0;
  }
  const auto count = static_cast<double>(branches.size());
  if (static_cast<double>(bars) < kBars * count) return "";
  const std::string bars_text =
      of(bars, branches.size()) + " pieces are bars, as thick at one end as at the other, and ";
  if (static_cast<double>(on_thicker) < kStandOnThicker * (count - 1.0)) {
    return bars_text + "only " + of(on_thicker, standing) +
           " that stand on others are thinner than those";
  }
  if (static_cast<double>(blocks) >= kBlocks * count) {
    return bars_text + std::to_string(blocks) + " are less than twice as long as they are thick";
  }
  if (const size_t framed = count_framed(branches);
      static_cast<double>(framed) >= kFramed * count) {
    return bars_text + std::to_string(framed) + " are parallel or at right angles to each other";
  }
  return "";
}

}  // namespace snowbough::tree
