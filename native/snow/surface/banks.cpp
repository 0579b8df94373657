#include "snow/surface/banks.h"

#include <algorithm>
#include <array>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "base/parallel_for.h"
#include "shaders/lib/snow_surface.h"
#include "snow/surface/vectors.h"

namespace snowbough::snow {
namespace {

/// Upward components of the normals of slopes, and the least one of level places.
constexpr float kSteepest = 0.12f;
constexpr float kFlattest = 0.8f;
constexpr float kIsLevel = 0.85f;
/// Distances down the slope's direction at which a level place is looked for, as fractions of the
/// depth, and the distance beyond it that gives its thickness.
constexpr std::array<float, 5> kAway{0.05f, 0.15f, 0.3f, 0.5f, 0.75f};
constexpr float kOffBank = 0.2f;
/// Height of the snow over a point at which the point counts as buried, as a fraction of the depth.
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
    for (const float distance : kAway) {
      const glm::vec3 place = at + away * (distance * depth);
      const base::TriangleTree::Hit hit =
          tree.first_along(0, glm::dvec3(place), {0.0, 0.0, -1.0}, 1e-5, depth);
      if (hit.triangle < 0) continue;
      const glm::vec3 cross = triangle_cross(receiver, static_cast<size_t>(hit.triangle));
      if (unit(cross).z < kIsLevel) continue;
      const glm::vec3 foot = place - glm::vec3(0.0f, 0.0f, static_cast<float>(hit.distance));
      const auto own = static_cast<int32_t>(p);
      Bank& bank = found[p];
      bank.level = lying.at(foot + away * (kOffBank * depth), own, depth, false);
      bank.above = static_cast<float>(hit.distance);
      bank.point = bank.level.point[0] == own ? -1 : own;
      return;
    }
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
    const glm::vec3 buried(0.0f, 0.0f, std::min(over, own));
    offsets[p] = glm::mix(offsets[p], buried, shared::eased(over, 0.0f, kIsBuried * depth));
  });
}

}  // namespace snowbough::snow
