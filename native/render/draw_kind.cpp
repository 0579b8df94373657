#include "render/draw_kind.h"

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

gpu::Program& begin_draw(gpu::ProgramVariants& shading, gpu::ProgramVariants& capture,
                         const DrawStyle& style, const std::vector<std::string>& more) {
  std::vector<std::string> defines = defines_of(style.kind);
  defines.insert(defines.end(), more.begin(), more.end());
  gpu::Program& program = (style.kind == DrawKind::kCapture ? capture : shading).with(defines);
  program.use();
  if (style.kind == DrawKind::kShaded) program.bind_texture("shadow_map", *style.shadow_map);
  if (style.kind == DrawKind::kWire) program.set("wire_color", style.wire_color);
  return program;
}

void draw_indirect(gpu::Program& program, DrawKind kind, GLenum mode, const gpu::Buffer& commands,
                   int64_t offset, int32_t draws) {
  const bool captures = kind == DrawKind::kCapture;
  if (captures) glBeginTransformFeedback(GL_TRIANGLES);
  program.draw_indirect(mode, commands, offset, draws);
  if (captures) glEndTransformFeedback();
}

}  // namespace snowbough::render
