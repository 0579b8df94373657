#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <optional>

#include "render/targets.h"

namespace snowbough::render {

/// When a frame draws the shadow map.
enum class Shadows : uint8_t {
  kDraw,
  /// Draws it only if its inputs have changed since the last frame.
  kIfOther,
  kKeep,
};

/// Inputs of the shadow map.
struct ShadowInputs {
  uint64_t scene = 0;
  int32_t resolution = 0;
  glm::mat4 shadow_from_world{0.0f};
  /// The shadow map uses the tessellation levels of the camera's picture.
  glm::vec3 eye{0.0f};
  float level = 0.0f;
  float drop = 0.0f;
  float max_level = 0.0f;
  glm::vec4 thesis{0.0f};

  /// True if the shadow map for `before` can be reused. `roughly`: also if only the camera has
  /// moved.
  bool matches(const ShadowInputs& before, bool roughly) const;
};

/// The shadow map, kept as long as its inputs stay. GPU thread.
class ShadowMap {
 public:
  /// Whether a frame must draw it. `roughly`: see ShadowInputs::matches.
  bool is_outdated(const ShadowInputs& inputs, Shadows when, bool roughly) const;
  /// Clears it and makes it the target of the following draws.
  void begin(const ShadowInputs& inputs);
  /// Null before the first begin().
  const gpu::Texture* texture() const { return texture_; }

 private:
  ReusedTarget target_{GL_NONE};
  const gpu::Texture* texture_ = nullptr;
  std::optional<ShadowInputs> inputs_;
};

}  // namespace snowbough::render
