#include "render/draw/patch_passes.h"

#include "shaders/lib/tree_shared.h"

namespace snowbough::render {
namespace {

std::vector<std::string> files(const std::string& name, const std::vector<std::string>& stages) {
  std::vector<std::string> named;
  for (const std::string& stage : stages) named.push_back(name + "." + stage + ".glsl");
  return named;
}

void draw(gpu::Program& program, DrawKind kind, GLenum mode, const PatchList& list, int64_t offset,
          int32_t draws) {
  const bool captures = kind == DrawKind::kCapture;
  if (captures) glBeginTransformFeedback(GL_TRIANGLES);
  program.draw_indirect(mode, list.commands, offset, draws);
  if (captures) glEndTransformFeedback();
}

}  // namespace

PatchPasses::PatchPasses(const std::string& name, int32_t plain_vertices)
    : plain_vertices_(plain_vertices),
      classify_(files(name + "_classify", {"comp"})),
      plain_(files(name + "_plain", {"vert", "frag"})),
      plain_capture_(files(name + "_plain", {"vert"})),
      tessellated_(files(name, {"vert", "tesc", "tese", "frag"})),
      tessellated_capture_(files(name, {"vert", "tesc", "tese"})) {}

void PatchPasses::classify(const PatchSource& of, PatchList& list, const gpu::Buffer& view,
                           float max_level) {
  classify_.use();
  classify_.bind("ViewBlock", view);
  of.bind_classify(classify_);
  lists_.run(classify_, list, plain_vertices_, max_level);
}

void PatchPasses::draw_plain(const PatchSource& of, const PatchList& list, const gpu::Buffer& view,
                             const DrawStyle& style) {
  const bool captures = style.kind == DrawKind::kCapture;
  gpu::Program& program =
      begin_draw(captures ? plain_capture_ : plain_, style, of.defines(style.kind));
  program.bind("ViewBlock", view);
  program.bind("PlainPatches", list.plain);
  of.bind_plain(program, style.kind);
  draw(program, style.kind, GL_TRIANGLES, list, 0, 1);
}

void PatchPasses::draw_tessellated(const PatchSource& of, const PatchList& list,
                                   const gpu::Buffer& view, const DrawStyle& style) {
  const bool captures = style.kind == DrawKind::kCapture;
  gpu::Program& program =
      begin_draw(captures ? tessellated_capture_ : tessellated_, style, of.defines(style.kind));
  program.bind("ViewBlock", view);
  program.bind("TessellatedPatches", list.tessellated);
  of.bind_tessellated(program, style.kind);
  glPatchParameteri(GL_PATCH_VERTICES, 1);
  draw(program, style.kind, GL_PATCHES, list, sizeof(shared::TreeDrawCommand), list.draws);
}

PatchCounts PatchPasses::count(const PatchList& list) const {
  return count_patches(list, plain_vertices_);
}

}  // namespace snowbough::render
