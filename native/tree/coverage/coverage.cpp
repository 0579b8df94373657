#include "tree/coverage/coverage.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <optional>
#include <span>

#include "base/parallel_for.h"
#include "tree/skeleton/centreline.h"
#include "tree/skeleton/segment_tree.h"

namespace snowbough::tree {
namespace {

/// Farthest covered corner from the centreline, in radii of the limb there; and from the surface of
/// limbs that are not its own.
constexpr float kReach = 1.75f;
constexpr double kReachOfOthers = 0.5;
/// Farthest polygons of a limb's point, in radii and in distances to the next points.
constexpr float kSupport = 2.0f;
/// Radius of the thinnest limb, relative to the whole.
constexpr float kThinnest = 2e-4f;

/// The branches of one part, by limb.
using Limbs = std::map<int32_t, const Branch*>;

/// Length of a branch that has corners near, and its whole length.
struct Support {
  double near = 0.0;
  double length = 0.0;
};

class PartCoverage {
 public:
  /// @param limb_of  per vertex of the part: its limb; null: all are on the first.
  PartCoverage(const ObjScene& scene, std::span<const int32_t> vertices, const Limbs& limbs,
               const std::vector<int32_t>* limb_of, float thinnest)
      : vertices_(vertices), covered_(vertices.size()) {
    for (const auto& [limb, branch] : limbs) nearest_[branch].assign(branch->points.size(), kFar);
    for (size_t i = 0; i < vertices.size(); ++i) {
      const auto own = limbs.find(limb_of != nullptr ? (*limb_of)[i] : limbs.begin()->first);
      const Branch& branch = *(own != limbs.end() ? own : limbs.begin())->second;
      const glm::vec3& at = scene.positions[vertices[i]];
      const CentrelinePlace place = nearest_place(branch, at);
      const float away = glm::distance(at, place.point);
      const float radius = std::max(radius_at(branch, place), thinnest);
      covered_[i] = away <= kReach * radius ? 1 : 0;
      std::vector<float>& nearest = nearest_[&branch];
      for (size_t p = place.segment; p < std::min(place.segment + 2, nearest.size()); ++p) {
        nearest[p] = std::min(nearest[p], glm::distance(at, branch.points[p]));
      }
    }
    for (const auto& [limb, branch] : limbs) add_support(*branch, thinnest);
  }

  bool covers(int32_t vertex) const {
    const auto found = std::lower_bound(vertices_.begin(), vertices_.end(), vertex);
    return covered_[static_cast<size_t>(found - vertices_.begin())] != 0;
  }

  /// Fraction of the limbs' length that has polygons near.
  double supported() const { return support_.length > 0.0 ? support_.near / support_.length : 1.0; }

 private:
  static constexpr float kFar = std::numeric_limits<float>::max();

  void add_support(const Branch& branch, float thinnest) {
    const std::vector<float>& nearest = nearest_[&branch];
    for (size_t i = 0; i + 1 < branch.points.size(); ++i) {
      const double length = glm::distance(branch.points[i], branch.points[i + 1]);
      const float radius = std::max({branch.radii[i], branch.radii[i + 1], thinnest});
      const bool near =
          std::min(nearest[i], nearest[i + 1]) <= kSupport * radius + static_cast<float>(length);
      support_.length += length;
      support_.near += near ? length : 0.0;
    }
  }

  std::span<const int32_t> vertices_;
  std::vector<char> covered_;
  std::map<const Branch*, std::vector<float>> nearest_;
  Support support_;
};

float extent_of(const std::vector<Branch>& branches) {
  glm::vec3 low(std::numeric_limits<float>::max());
  glm::vec3 high = -low;
  for (const Branch& branch : branches) {
    for (const glm::vec3& p : branch.points) {
      low = glm::min(low, p);
      high = glm::max(high, p);
    }
  }
  return glm::distance(low, high);
}

/// Calls with(corner vertices, area) for each triangle of a part.
template <typename With>
void for_each_triangle(const ObjScene& scene, const Parts& parts, int32_t part, const With& with) {
  for (const int32_t f : parts.part_faces(part)) {
    const int32_t first = scene.face_begin[f];
    for (int32_t c = first + 1; c + 1 < scene.face_begin[f + 1]; ++c) {
      const std::array<int32_t, 3> corners{scene.corner_vertex[first], scene.corner_vertex[c],
                                           scene.corner_vertex[c + 1]};
      const glm::dvec3 a(scene.positions[corners[0]]);
      const glm::dvec3 b = glm::dvec3(scene.positions[corners[1]]) - a;
      const glm::dvec3 c2 = glm::dvec3(scene.positions[corners[2]]) - a;
      with(corners, 0.5 * glm::length(glm::cross(b, c2)));
    }
  }
}

}  // namespace

Coverage measure_coverage(const ObjScene& scene, const Parts& parts,
                          const ClassifiedParts& classified, const std::vector<Branch>& branches) {
  std::map<int32_t, Limbs> limbs;
  for (const Branch& branch : branches) limbs[branch.piece][branch.limb] = &branch;
  std::vector<char> wood(classified.role.size(), 0);
  for (size_t p = 0; p < wood.size(); ++p) {
    wood[p] = classified.role[p] != PartRole::kFoliage && classified.role[p] != PartRole::kSkipped;
  }
  for (const SkippedPart& skipped : classified.skipped) wood[skipped.part] = skipped.wood ? 1 : 0;

  const float thinnest = kThinnest * extent_of(branches);
  std::optional<SegmentTree> others;
  Coverage coverage;
  for (int32_t p = 0; p < parts.count(); ++p) {
    if (wood[p] == 0) continue;
    double area = 0.0;
    double covered = 0.0;
    const auto add = [&](const auto& is_covered) {
      for_each_triangle(scene, parts, p, [&](const std::array<int32_t, 3>& corners, double own) {
        area += own;
        for (const int32_t v : corners) covered += is_covered(v) ? own / 3.0 : 0.0;
      });
    };
    const auto found = limbs.find(p);
    if (classified.role[p] == PartRole::kCrossSection) {
      add([](int32_t) { return true; });
    } else if (found != limbs.end()) {
      const auto welded =
          std::lower_bound(classified.welded.begin(), classified.welded.end(), p,
                           [](const auto& entry, int32_t part) { return entry.first < part; });
      const bool forks = welded != classified.welded.end() && welded->first == p;
      const PartCoverage part(scene, parts.part_vertices(p), found->second,
                              forks ? &welded->second.vertex_limb : nullptr, thinnest);
      add([&](int32_t v) { return part.covers(v); });
      covered *= part.supported();
    } else if (!branches.empty()) {
      if (!others) others.emplace(branches, std::vector<int32_t>(branches.size(), 0), 0.0f);
      add([&](int32_t v) {
        const NearestSegment near = others->nearest(scene.positions[v], 1, Measure::kSurface);
        return near.cost <= kReachOfOthers * static_cast<double>(std::max(near.radius, thinnest));
      });
    } else {
      add([](int32_t) { return false; });
    }
    coverage.area += area;
    coverage.covered += covered;
    if (covered < area) coverage.missing.emplace_back(p, area - covered);
  }
  std::stable_sort(coverage.missing.begin(), coverage.missing.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  return coverage;
}

}  // namespace snowbough::tree
