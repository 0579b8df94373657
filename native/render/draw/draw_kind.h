#pragma once

#include <cstdint>
#include <glm/vec4.hpp>
#include <string>
#include <vector>

#include "gpu/program.h"
#include "gpu/program_variants.h"
#include "gpu/resources.h"

namespace snowbough::render {

/// What a draw makes: a picture, its wireframe, depth alone, or positions for transform feedback.
enum class DrawKind : uint8_t { kShaded, kWire, kDepth, kCapture };

/// Defines of a kind's shaders.
std::vector<std::string> defines_of(DrawKind kind);

/// How a draw is made, whatever is drawn.
struct DrawStyle {
  DrawKind kind = DrawKind::kShaded;
  /// For kShaded.
  const gpu::Texture* shadow_map = nullptr;
  /// For kWire.
  glm::vec4 wire_color{0.0f};
};

/// The program of a style, in use, with what that style needs. `more`: further defines.
gpu::Program& begin_draw(gpu::ProgramVariants& programs, const DrawStyle& style,
                         const std::vector<std::string>& more = {});

}  // namespace snowbough::render
