#include "snow/surface/banks.h"

#include <algorithm>
#include <array>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "base/parallel_for.h"
#include "shaders/lib/snow_surface.h"
#include "snow/surface/point_tree.h"
#include "snow/surface/vectors.h"

namespace snowbough::snow {
namespace {

/// Upward components of the normals of slopes, and the least one of level places.
constexpr float kSteepest = 0.12f;
constexpr float kFlattest = 0.8f;
constexpr float kIsLevel = 0.85f;
// Lengths are fractions of the depth.
/// Distances down the slope's direction at which a level place is looked for, and halvings of the
/// distance between two of them.
constexpr std::array<float, 7> kAway{0.05f, 0.15f, 0.3f, 0.5f, 0.75f, 1.05f, 1.4f};
constexpr int kHalvings = 4;
/// Distances of the level place at which a slope belongs to the hollow fully and not at all, and
/// the distance beyond it that gives its snow.
constexpr float kNearLevel = 0.75f;
constexpr float kFarLevel = 1.3f;
constexpr float kOffBank = 0.2f;
/// Distances from slopes at which a level place belongs to the hollow fully and not at all.
constexpr float kNearSlope = 0.5f;
constexpr float kFarSlope = 1.2f;
/// Height of the snow over a point at which the point counts as buried.
constexpr float kIsBuried = 0.12f;

}  // namespace

std::vector<Bank> find_banks(const SurfacePoints& points, const SurfaceMesh& receiver,
                             const base::TriangleTree& tree, const NearestPoints& lying,
                             float depth) {
  std::vector<Bank> found(points.count());
  std::vector<glm::vec3> feet(points.count());
  base::for_each_item(found.size(), 256, [&](size_t p) {
    const glm::vec3& normal = points.normal[p];
    if (normal.z < kSteepest || normal.z > kFlattest) return;
    const glm::vec3& at = points.mesh.position[p];
    const glm::vec3 away = unit(glm::vec3(normal.x, normal.y, 0.0f));
    struct Ground {
      glm::vec3 place;
      bool is_there, is_level;
    };
    const auto ground = [&](float distance) -> Ground {
      const glm::vec3 place = at + away * (distance * depth);
      const base::TriangleTree::Hit hit =
          tree.first_along(0, glm::dvec3(place), {0.0, 0.0, -1.0}, 1e-5, 1.5 * depth);
      if (hit.triangle < 0) return {place, false, false};
      const glm::vec3 cross = triangle_cross(receiver, static_cast<size_t>(hit.triangle));
      return {place - glm::vec3(0.0f, 0.0f, static_cast<float>(hit.distance)), true,
              unit(cross).z >= kIsLevel};
    };
    float slope = 0.0f, level = 0.0f;
    for (const float distance : kAway) {
      if (ground(distance).is_level) {
        level = distance;
        break;
      }
      slope = distance;
    }
    if (level <= 0.0f) return;
    for (int round = 0; round < kHalvings; ++round) {
      const float middle = 0.5f * (slope + level);
      (ground(middle).is_level ? level : slope) = middle;
    }
    const Ground foot = ground(level), halfway = ground(0.5f * level);
    if (!foot.is_there || !halfway.is_there) return;
    const auto own = static_cast<int32_t>(p);
    Bank& bank = found[p];
    bank.point = own;
    bank.level = lying.at(foot.place + away * (kOffBank * depth), own, depth, false);
    bank.halfway = lying.at(halfway.place, own, depth, false);
    bank.above = at.z - halfway.place.z;
    bank.halfway_above = halfway.place.z - foot.place.z;
    if (bank.level.point[0] != own) bank.share = shared::eased(level, kFarLevel, kNearLevel);
    feet[p] = foot.place;
  });
  std::vector<glm::vec3> slopes;
  for (size_t p = 0; p < found.size(); ++p) {
    if (found[p].share > 0.0f) slopes.push_back(feet[p]);
  }
  const PointTree near(std::move(slopes));
  base::for_each_item(found.size(), 256, [&](size_t p) {
    if (points.normal[p].z <= kFlattest) return;
    const PointTree::Found nearest = near.nearest(points.mesh.position[p], kFarSlope * depth)[0];
    if (nearest.point < 0) return;
    Bank& bank = found[p];
    bank.point = static_cast<int32_t>(p);
    bank.share = shared::eased(nearest.distance, kFarSlope * depth, kNearSlope * depth);
    bank.halfway = bank.level = {glm::ivec4(bank.point), {1.0f, 0.0f, 0.0f, 0.0f}};
  });
  std::erase_if(found, [](const Bank& bank) { return bank.share <= 0.0f; });
  return found;
}

void bury_banks(const std::vector<Bank>& banks, const std::vector<float>& column, float depth,
                std::vector<glm::vec3>& offsets) {
  base::for_each_item(banks.size(), 1024, [&](size_t b) {
    const Bank& bank = banks[b];
    const auto p = static_cast<size_t>(bank.point);
    const float over =
        std::min(bank.halfway.of(column) - bank.above, bank.level.of(column) - bank.halfway_above);
    if (over <= 0.0f || column[p] <= 0.0f) return;
    const float buried = bank.share * shared::eased(over, 0.0f, kIsBuried * depth);
    offsets[p] = glm::mix(offsets[p], glm::vec3(0.0f, 0.0f, column[p]), buried);
  });
}

}  // namespace snowbough::snow
