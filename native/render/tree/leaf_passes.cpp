#include "render/tree/leaf_passes.h"

#include <cstdint>
#include <glm/vec4.hpp>

namespace snowbough::render {
namespace {

void bind_leaves(gpu::Program& program, const TreeChain& chain, const gpu::Buffer& view) {
  program.bind("ViewBlock", view);
  program.bind("TreeInstances", chain.instance_buffer.buffer());
  program.bind("LeafVertices", chain.store->leaf_triangles.buffer());
  program.bind("BoneRows", chain.all->bones.buffer());
}

}  // namespace

void LeafPasses::classify(TreeChain& chain, PatchList& list, const gpu::Buffer& view) {
  if (list.is_empty()) return;
  classify_.use();
  bind_leaves(classify_, chain, view);
  lists_.run(classify_, list, 3, 0.0f);
}

void LeafPasses::draw(const TreeChain& chain, const PatchList& list, const gpu::Buffer& view,
                      const DrawStyle& style) {
  if (list.is_empty()) return;
  gpu::Program& program = begin_draw(leaves_, style);
  bind_leaves(program, chain, view);
  program.bind("PlainPatches", list.plain());
  for (int32_t batch = 0; batch < list.batch_count(); ++batch) {
    const LeafPart& part = *chain.leaf_parts[static_cast<size_t>(batch)];
    program.bind_texture("image", part.image);
    if (style.kind == DrawKind::kShaded) {
      program.set("image_color", glm::vec4(part.color, 1.0f));
    }
    list.draw_plain(program, batch, batch + 1);
  }
}

}  // namespace snowbough::render
