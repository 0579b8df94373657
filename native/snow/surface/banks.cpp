#include "snow/surface/banks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "base/parallel_for.h"
#include "shaders/lib/snow_surface.h"
#include "snow/surface/vectors.h"

namespace snowbough::snow {
namespace {

using shared::eased;

/// Upward components of the normals of slopes, and the least one of level places.
constexpr float kSteepest = 0.12f;
constexpr float kSteep = 0.8f;
constexpr float kFlattest = 0.98f;
constexpr float kIsLevel = 0.85f;
/// By this much a level place is more level than a slope that is not steep.
constexpr float kMoreLevel = 0.02f;
// Lengths are fractions of the depth.
/// Distances down the slope's direction at which a level place is looked for. Slopes that are not
/// steep count fully up to half of the last one, and not at all from the last one on.
constexpr std::array<float, 5> kAway{0.05f, 0.15f, 0.3f, 0.5f, 0.75f};
/// Distance beyond the foot of a slope at which the level place gives the thickness of its snow, in
/// a hollow and elsewhere: over a low side snow is higher, the farther inwards.
constexpr float kOffBank = 0.2f;
constexpr float kOffLowBank = 0.1f;
/// Thickness along the normals is smoothed, which takes from the snow at the foot of a slope: the
/// column over a point there may be higher by this factor, up to the first height above the level
/// place fully, and not at all from the second one on.
constexpr float kColumnAtFoot = 3.0f;
constexpr float kAtFoot = 0.03f;
constexpr float kOnSlope = 0.15f;
/// Ground that falls more steeply than a slope, by this factor and this length, is no foot of it.
constexpr float kSteeper = 1.5f;
constexpr float kUneven = 0.03f;
/// Depth and greatest width of a hollow.
constexpr float kHollow = 0.5f;
constexpr float kAcross = 2.0f;
/// Halvings of the distance between a slope and a level place.
constexpr int kHalvings = 4;
/// Height of the snow over a point at which the point counts as buried.
constexpr float kIsBuried = 0.12f;

}  // namespace

std::vector<Bank> find_banks(const SurfacePoints& points, const SurfaceMesh& receiver,
                             const base::TriangleTree& tree, const NearestPoints& lying,
                             float depth) {
  std::vector<Bank> found(points.count());
  base::for_each_item(found.size(), 256, [&](size_t p) {
    const glm::vec3& normal = points.normal[p];
    if (normal.z < kSteepest || normal.z > kFlattest) return;
    const glm::vec3& at = points.mesh.position[p];
    const glm::vec3 away = unit(glm::vec3(normal.x, normal.y, 0.0f));
    const auto ground = [&](float distance) {
      const glm::vec3 place = at + away * (distance * depth);
      return tree.first_along(0, glm::dvec3(place), {0.0, 0.0, -1.0}, 1e-5, depth);
    };
    const auto up_of = [&](int32_t triangle) {
      return triangle < 0 ? 0.0f : unit(triangle_cross(receiver, static_cast<size_t>(triangle))).z;
    };
    // Smoothed normals at the brink of a slope are less steep than it.
    const auto face =
        std::lower_bound(receiver.base.begin(), receiver.base.end(), points.triangle[p]);
    const float up =
        std::clamp(up_of(static_cast<int32_t>(face - receiver.base.begin())), kSteepest, normal.z);
    // In a hollow, another slope stands opposite, higher than half of the snow.
    const glm::dvec3 over = at + glm::vec3(0.0f, 0.0f, kHollow * depth);
    const bool in_hollow = tree.first_along(0, over, away, 0.0, kAcross * depth).triangle >= 0;
    if (up > kSteep && !in_hollow) return;
    const float wanted = std::max(kIsLevel, up + kMoreLevel);
    const float steepest = kSteeper * std::sqrt(1.0f - up * up) / up;
    float slope = 0.0f, level = 0.0f;
    for (const float distance : kAway) {
      const base::TriangleTree::Hit hit = ground(distance);
      // Over a rim, or over a joint: not the foot of this slope.
      if (hit.triangle >= 0 && hit.distance > (steepest * distance + kUneven) * depth) return;
      if (up_of(hit.triangle) >= wanted) {
        level = distance;
        break;
      }
      slope = distance;
    }
    if (level <= 0.0f) return;
    for (int round = 0; up > kSteep && round < kHalvings; ++round) {
      const float middle = 0.5f * (slope + level);
      (up_of(ground(middle).triangle) >= wanted ? level : slope) = middle;
    }
    const float above = static_cast<float>(ground(level).distance);
    const glm::vec3 foot = at + away * (level * depth) - glm::vec3(0.0f, 0.0f, above);
    const auto own = static_cast<int32_t>(p);
    Bank& bank = found[p];
    bank.level =
        lying.at(foot + away * ((in_hollow ? kOffBank : kOffLowBank) * depth), own, depth, false);
    bank.above = above;
    bank.point = bank.level.point[0] == own ? -1 : own;
    const float steep = eased(up, kFlattest, kSteep);
    bank.share = glm::mix(eased(level, kAway.back(), 0.5f * kAway.back()), 1.0f, steep);
    bank.steep = steep;
    const float at_foot = in_hollow ? eased(above, kOnSlope * depth, kAtFoot * depth) : 0.0f;
    bank.column = glm::mix(1.0f, kColumnAtFoot, at_foot);
  });
  std::erase_if(found, [](const Bank& bank) { return bank.above <= 0.0f || bank.point < 0; });
  return found;
}

void bury_banks(const std::vector<Bank>& banks, const std::vector<float>& thickness,
                const std::vector<float>& shown, const std::vector<float>& up, float depth,
                std::vector<glm::vec3>& offsets) {
  base::for_each_item(banks.size(), 1024, [&](size_t b) {
    const Bank& bank = banks[b];
    const auto p = static_cast<size_t>(bank.point);
    const float over = bank.level.of(shown) - bank.above;
    if (over <= 0.0f || thickness[p] <= 0.0f) return;
    const float own = thickness[p] / std::max(up[p], kSteepest);
    const float most = std::min(over, bank.column * own);
    const glm::vec3 buried(0.0f, 0.0f, glm::mix(std::max(own, most), most, bank.steep));
    offsets[p] = glm::mix(offsets[p], buried, bank.share * eased(over, 0.0f, kIsBuried * depth));
  });
}

}  // namespace snowbough::snow
