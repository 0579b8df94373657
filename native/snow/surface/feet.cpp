#include "snow/surface/feet.h"

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "base/parallel_for.h"
#include "shaders/lib/snow_surface.h"

namespace snowbough::snow {
namespace {

/// Greatest distance of a foot outwards from the rim and inwards below it, and the distance at
/// which the snow is not lower because of the step, as fractions of the depth.
constexpr float kFootOut = 0.45f;
constexpr float kFootUnder = 0.3f;
constexpr float kOffFoot = 0.5f;
/// Faces need points up to this distance inwards below the rim, as a fraction of the depth.
constexpr float kSeenUnder = 0.06f;
/// Thickness of snow that leaves a step bare and that hides it, as fractions of the step.
constexpr float kBareStep = 0.7f;
constexpr float kHiddenStep = 1.3f;
/// Least upward component of the normal of a face at a foot.
constexpr float kFootCarries = 0.3f;
/// Distance behind the rim at which the thickness on the step is taken, as a fraction of the depth.
constexpr float kOnStep = 0.35f;
/// Rise of the snow at the foot of a hidden step, as a fraction of the step.
constexpr float kRise = 0.3f;

}  // namespace

bool is_at_foot(const Rims& rims, const glm::vec3& point, const glm::vec3& normal, float depth) {
  if (normal.z < kFootCarries) return false;
  const Rims::Step step = rims.step_above(point, normal, kFootOut * depth, depth);
  return step.height > 0.0f && step.out > -kSeenUnder * depth;
}

std::vector<Foot> find_feet(const SurfacePoints& points, const Rims& rims,
                            const NearestPoints& lying, float depth) {
  using shared::eased;
  const std::vector<int32_t>& all = lying.chosen();
  std::vector<Foot> found(all.size());
  base::for_each_item(all.size(), 64, [&](size_t i) {
    const int32_t p = all[i];
    const glm::vec3& at = points.mesh.position[p];
    const glm::vec3& normal = points.normal[p];
    const Rims::Step step = rims.step_above(at, normal, kFootOut * depth, depth);
    if (step.height <= 0.0f || step.out < -kFootUnder * depth) return;
    const glm::vec3 off = step.foot + step.level_out * (kOffFoot * depth);
    const glm::vec3 place = off - normal * glm::dot(off - at, normal);
    Foot& foot = found[i];
    foot.point = p;
    foot.off = lying.at(place, p, kOffFoot * depth, false);
    const glm::vec3 behind = step.foot - step.level_out * (kOnStep * depth);
    foot.upper = lying.at(behind, p, kOffFoot * depth, false);
    foot.step = step.height;
    if (foot.off.point[0] == p) return;
    foot.share = eased(step.out, kFootOut * depth, 0.6f * kFootOut * depth) *
                 eased(step.out, -kFootUnder * depth, -0.5f * kFootUnder * depth);
  });
  std::erase_if(found, [](const Foot& foot) { return foot.share <= 0.0f; });
  return found;
}

void fill_feet(const std::vector<Foot>& feet, std::vector<float>& thickness) {
  std::vector<float> filled(feet.size());
  for (size_t i = 0; i < feet.size(); ++i) {
    const Foot& foot = feet[i];
    const float off = foot.off.of(thickness);
    const float hides = shared::eased(off, kBareStep * foot.step, kHiddenStep * foot.step);
    const float own = thickness[foot.point];
    // A furrow is no deeper than the snow on its lower side: a heap beside a bare ledge has none.
    const float level =
        std::min(off + kRise * foot.step * hides, foot.step + foot.upper.of(thickness));
    filled[i] = std::max(own, glm::mix(own, level, foot.share * hides));
  }
  for (size_t i = 0; i < feet.size(); ++i) thickness[feet[i].point] = filled[i];
}

}  // namespace snowbough::snow
