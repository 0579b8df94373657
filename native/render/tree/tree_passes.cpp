#include "render/tree/tree_passes.h"

#include <cstdint>
#include <string>
#include <vector>

namespace snowbough::render {
namespace {

/// A plain patch is two triangles.
constexpr int32_t kPlainVertices = 6;

std::vector<std::string> snow_define(const TreeChain& chain) {
  return chain.has_snow ? std::vector<std::string>{"SNOW"} : std::vector<std::string>{};
}

void bind_vertices(gpu::Program& program, const TreeChain& chain, const gpu::Buffer& view) {
  program.bind("ViewBlock", view);
  program.bind("TreeInstances", chain.instance_buffer.buffer());
  program.bind("TreeVertices", chain.store->vertices.buffer());
  program.bind("PosedVertices", chain.posed);
}

/// Calls draw(begin, end, images) for successive batches with the same images; only kShaded shows
/// them.
template <typename Draw>
void each_images(const TreeChain& chain, DrawKind kind, const Draw& draw) {
  const auto count = static_cast<int32_t>(chain.bark_images.size());
  if (kind != DrawKind::kShaded) return draw(0, count, nullptr);
  for (int32_t batch = 0; batch < count; ++batch) {
    draw(batch, batch + 1, chain.bark_images[static_cast<size_t>(batch)]);
  }
}

template <typename Draw>
void capture_or_draw(DrawKind kind, const Draw& draw) {
  const bool captures = kind == DrawKind::kCapture;
  if (captures) glBeginTransformFeedback(GL_TRIANGLES);
  draw();
  if (captures) glEndTransformFeedback();
}

gpu::Program& begin_bark(gpu::ProgramVariants& programs, const TreeChain& chain,
                         const DrawStyle& style, const gpu::Buffer& view,
                         const gpu::Texture* images) {
  std::vector<std::string> defines = snow_define(chain);
  if (images != nullptr) defines.emplace_back("IMAGE");
  gpu::Program& program = begin_draw(programs, style, defines);
  bind_vertices(program, chain, view);
  program.bind("TreePatches", chain.store->patches.buffer());
  if (images != nullptr) {
    program.bind("BarkUvs", chain.store->bark_uvs.buffer());
    program.bind_texture("bark_images", *images);
  }
  return program;
}

}  // namespace

void TreePasses::pose(TreeChain& chain, const gpu::Buffer& view) {
  gpu::Program& program = pose_.with(snow_define(chain));
  program.use();
  bind_vertices(program, chain, view);
  program.bind("BoneRows", chain.all->bones.buffer());
  if (chain.has_snow) {
    program.bind("VertexSnow", chain.store->vertex_snow.buffer());
    program.bind_texture("snow_pages", chain.all->snow.texture());
  }
  chain.vertices.dispatch(program);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

void TreePasses::edge_levels(TreeChain& chain, const gpu::Buffer& view) {
  gpu::Program& program = edges_.with(snow_define(chain));
  program.use();
  bind_vertices(program, chain, view);
  program.bind("TreeEdges", chain.store->edges.buffer());
  program.bind("EdgeLevels", chain.edge_levels);
  chain.edges.dispatch(program);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

void TreePasses::classify(TreeChain& chain, PatchList& list, const gpu::Buffer& view,
                          float max_level) {
  if (list.is_empty()) return;
  classify_.use();
  bind_vertices(classify_, chain, view);
  classify_.bind("TreeSections", chain.store->sections.buffer());
  classify_.bind("TreeEdges", chain.store->edges.buffer());
  classify_.bind("TreePatches", chain.store->patches.buffer());
  classify_.bind("EdgeLevels", chain.edge_levels);
  classify_.bind("TileDepths", chain.all->snow.tile_depths());
  classify_.bind("PatchGrowths", chain.growths);
  lists_.run(classify_, list, kPlainVertices, max_level);
}

void TreePasses::draw_plain(const TreeChain& chain, const PatchList& list, const gpu::Buffer& view,
                            const DrawStyle& style) {
  if (list.is_empty()) return;
  const bool captures = style.kind == DrawKind::kCapture;
  each_images(chain, style.kind, [&](int32_t begin, int32_t end, const gpu::Texture* images) {
    gpu::Program& program =
        begin_bark(captures ? plain_capture_ : plain_, chain, style, view, images);
    program.bind("PlainPatches", list.plain());
    program.bind("PatchGrowths", chain.growths);
    program.bind("TreeSections", chain.store->sections.buffer());
    if (style.kind == DrawKind::kShaded && chain.has_snow) {
      program.bind_texture("snow_pages", chain.all->snow.texture());
    }
    capture_or_draw(style.kind, [&] { list.draw_plain(program, begin, end); });
  });
}

void TreePasses::draw_tessellated(const TreeChain& chain, const PatchList& list,
                                  const gpu::Buffer& view, const DrawStyle& style) {
  if (list.is_empty()) return;
  const bool captures = style.kind == DrawKind::kCapture;
  each_images(chain, style.kind, [&](int32_t begin, int32_t end, const gpu::Texture* images) {
    gpu::Program& program =
        begin_bark(captures ? tessellated_capture_ : tessellated_, chain, style, view, images);
    program.bind("TessellatedPatches", list.tessellated());
    program.bind("TreeSections", chain.store->sections.buffer());
    program.bind("TreeEdges", chain.store->edges.buffer());
    program.bind("EdgeLevels", chain.edge_levels);
    if (chain.has_snow) program.bind_texture("snow_pages", chain.all->snow.texture());
    capture_or_draw(style.kind, [&] { list.draw_tessellated(program, begin, end); });
  });
}

PatchCounts TreePasses::count(const PatchList& list) {
  return count_patches(list, kPlainVertices);
}

}  // namespace snowbough::render
