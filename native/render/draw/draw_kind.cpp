#include "render/draw/draw_kind.h"

namespace snowbough::render {

std::vector<std::string> defines_of(DrawKind kind) {
  switch (kind) {
    case DrawKind::kWire:
      return {"WIRE"};
    case DrawKind::kDepth:
      return {"SHADOW"};
    case DrawKind::kCapture:
      return {"CAPTURE"};
    case DrawKind::kShaded:
      break;
  }
  return {};
}

gpu::Program& begin_draw(gpu::ProgramVariants& programs, const DrawStyle& style,
                         const std::vector<std::string>& more) {
  std::vector<std::string> defines = defines_of(style.kind);
  defines.insert(defines.end(), more.begin(), more.end());
  gpu::Program& program = programs.with(defines);
  program.use();
  if (style.kind == DrawKind::kShaded) program.bind_texture("shadow_map", *style.shadow_map);
  if (style.kind == DrawKind::kWire) program.set("wire_color", style.wire_color);
  return program;
}

}  // namespace snowbough::render
