#include "render/shadow_map.h"

#include <algorithm>

namespace snowbough::render {

bool ShadowInputs::matches(const ShadowInputs& before, bool roughly) const {
  const bool same_sun = scene == before.scene && resolution == before.resolution &&
                        shadow_from_world == before.shadow_from_world;
  const bool same_levels = eye == before.eye && level == before.level && drop == before.drop &&
                           max_level == before.max_level && thesis == before.thesis;
  return same_sun && (roughly || same_levels);
}

bool ShadowMap::is_outdated(const ShadowInputs& inputs, Shadows when, bool roughly) const {
  if (when == Shadows::kKeep) return false;
  return when == Shadows::kDraw || !inputs_ || !inputs.matches(*inputs_, roughly);
}

void ShadowMap::begin(const ShadowInputs& inputs) {
  const int32_t size = std::max(inputs.resolution, 1);
  const Target& target = target_.of_size(size, size);
  texture_ = &target.depth;
  target.begin(0.0f, 0.0f, 0.0f);
  inputs_ = inputs;
}

}  // namespace snowbough::render
