#pragma once

#include <cstdint>
#include <glm/vec4.hpp>
#include <string>
#include <vector>

#include "gpu/program.h"
#include "gpu/program_variants.h"
#include "gpu/resources.h"

namespace snowbough::render {

/// The output of a draw: a shaded picture, a wireframe, depth only, or positions for transform
/// feedback.
enum class DrawKind : uint8_t { kShaded, kWire, kDepth, kCapture };

/// Shader defines of a kind.
std::vector<std::string> defines_of(DrawKind kind);

/// Settings of a draw, independent of the object.
struct DrawStyle {
  DrawKind kind = DrawKind::kShaded;
  /// Used by kShaded.
  const gpu::Texture* shadow_map = nullptr;
  /// Used by kWire.
  glm::vec4 wire_color{0.0f};
};

/// Activates the program of a style, binds the style's inputs, and returns the program. `more`:
/// additional shader defines.
gpu::Program& begin_draw(gpu::ProgramVariants& programs, const DrawStyle& style,
                         const std::vector<std::string>& more = {});

}  // namespace snowbough::render
