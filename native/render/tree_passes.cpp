#include "render/tree_passes.h"

namespace snowbough::render {
namespace {

constexpr int32_t kLocalSize = 64;

int64_t bytes_of(size_t count, size_t size) {
  return static_cast<int64_t>(count * size);
}

std::vector<std::string> snow_define(const TreeBuffers& tree) {
  return tree.snow != nullptr ? std::vector<std::string>{"SNOW"} : std::vector<std::string>{};
}

}  // namespace

std::vector<glm::vec4> bone_rows(std::span<const glm::mat4> matrices) {
  std::vector<glm::vec4> rows;
  rows.reserve(3 * matrices.size());
  for (const glm::mat4& m : matrices) {
    for (int row = 0; row < 3; ++row) {
      rows.emplace_back(m[0][row], m[1][row], m[2][row], m[3][row]);
    }
  }
  return rows;
}

TreeBuffers::TreeBuffers(const TreePatches& tree)
    : vertex_count(static_cast<int32_t>(tree.vertices.size())),
      edge_count(static_cast<int32_t>(tree.edges.size())),
      patch_count(static_cast<int32_t>(tree.patches.size())),
      vertices(tree.vertices),
      sections(tree.sections),
      edges(tree.edges),
      patches(tree.patches),
      vertex_snow(tree.vertex_snow),
      bones(
          bone_rows(std::vector<glm::mat4>(static_cast<size_t>(tree.bone_count), glm::mat4(1.0f)))),
      posed(bytes_of(tree.vertices.size(), sizeof(shared::PosedVertex))),
      edge_levels(bytes_of(tree.edges.size(), sizeof(float))),
      camera(tree.patches.size()),
      sun(tree.patches.size()) {}

void TreePasses::pose(TreeBuffers& tree, const gpu::Buffer& view) {
  gpu::Program& program = pose_.with(snow_define(tree));
  program.use();
  program.bind("ViewBlock", view);
  program.bind("TreeVertices", tree.vertices);
  program.bind("PosedVertices", tree.posed);
  program.bind("BoneRows", tree.bones);
  if (tree.snow != nullptr) {
    program.bind("VertexSnow", tree.vertex_snow);
    program.bind_texture("height_map", *tree.snow);
  }
  program.set("count", tree.vertex_count);
  program.dispatch_items(tree.vertex_count, kLocalSize);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

void TreePasses::edge_levels(TreeBuffers& tree, const gpu::Buffer& view) {
  edges_.use();
  edges_.bind("ViewBlock", view);
  edges_.bind("PosedVertices", tree.posed);
  edges_.bind("TreeEdges", tree.edges);
  edges_.bind("EdgeLevels", tree.edge_levels);
  edges_.set("count", tree.edge_count);
  edges_.dispatch_items(tree.edge_count, kLocalSize);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

void TreePasses::classify(TreeBuffers& tree, PatchList& list, const gpu::Buffer& view,
                          float max_level) {
  classify_.use();
  classify_.bind("ViewBlock", view);
  classify_.bind("PosedVertices", tree.posed);
  classify_.bind("TreePatches", tree.patches);
  classify_.bind("EdgeLevels", tree.edge_levels);
  lists_.run(classify_, list, kPlainVertices, max_level);
}

void TreePasses::draw_plain(TreeBuffers& tree, PatchList& list, const gpu::Buffer& view,
                            const DrawStyle& style) {
  gpu::Program& program = begin_draw(plain_, plain_capture_, style, snow_define(tree));
  if (tree.snow != nullptr && style.kind == DrawKind::kShaded) {
    program.bind("TreeVertices", tree.vertices);
    program.bind_texture("height_map", *tree.snow);
  }
  program.bind("ViewBlock", view);
  program.bind("PosedVertices", tree.posed);
  program.bind("TreePatches", tree.patches);
  program.bind("PlainPatches", list.plain);
  draw_indirect(program, style.kind, GL_TRIANGLES, list.commands, 0, 1);
}

void TreePasses::draw_tessellated(TreeBuffers& tree, PatchList& list, const gpu::Buffer& view,
                                  const DrawStyle& style) {
  gpu::Program& program = begin_draw(tree_, tree_capture_, style, snow_define(tree));
  if (tree.snow != nullptr) program.bind_texture("height_map", *tree.snow);
  program.bind("ViewBlock", view);
  program.bind("TreeVertices", tree.vertices);
  program.bind("PosedVertices", tree.posed);
  program.bind("TreeSections", tree.sections);
  program.bind("TreeEdges", tree.edges);
  program.bind("TreePatches", tree.patches);
  program.bind("EdgeLevels", tree.edge_levels);
  program.bind("TessellatedPatches", list.tessellated);
  glPatchParameteri(GL_PATCH_VERTICES, 1);
  draw_indirect(program, style.kind, GL_PATCHES, list.commands, sizeof(shared::TreeDrawCommand),
                list.draws);
}

}  // namespace snowbough::render
