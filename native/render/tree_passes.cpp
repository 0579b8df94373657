#include "render/tree_passes.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "gpu/egl_context.h"

namespace snowbough::render {
namespace {

constexpr int32_t kLocalSize = 64;
/// Work groups that OpenGL promises a dimension.
constexpr size_t kMostGroups = 65535;

/// Mesa's software renderers number the vertices that a draw's tessellation makes with 16 bits.
constexpr int32_t kSoftwareVertices = 65535;
/// Highest level that OpenGL promises.
constexpr float kHighestLevel = 64.0f;

/// Most patches of a level that a draw may have on a software renderer. Fractional odd spacing
/// takes the next odd number of parts.
int32_t software_patches(float max_level) {
  const auto parts = static_cast<int32_t>(std::ceil(max_level)) | 1;
  return kSoftwareVertices / ((parts + 1) * (parts + 1));
}

int64_t bytes_of(size_t count, size_t size) {
  return static_cast<int64_t>(count * size);
}

size_t patch_groups(size_t patches) {
  return (patches + shared::kPatchGroup - 1) / shared::kPatchGroup;
}

/// The program of a kind of draw, in use, with what that kind needs.
gpu::Program& begin(gpu::ProgramVariants& shading, gpu::ProgramVariants& capture,
                    TreePasses::Kind kind, const gpu::Texture& shadow_map,
                    const glm::vec4& wire_color) {
  gpu::Program& program =
      (kind == TreePasses::Kind::kCapture ? capture : shading).with(defines_of(kind));
  program.use();
  if (kind == TreePasses::Kind::kShaded) program.bind_texture("shadow_map", shadow_map);
  if (kind == TreePasses::Kind::kWire) program.set("wire_color", wire_color);
  return program;
}

/// Draws, with transform feedback around it where that is what the draw is for.
void draw(gpu::Program& program, TreePasses::Kind kind, GLenum mode, const gpu::Buffer& commands,
          int64_t offset, int32_t draws) {
  const bool captures = kind == TreePasses::Kind::kCapture;
  if (captures) glBeginTransformFeedback(GL_TRIANGLES);
  program.draw_indirect(mode, commands, offset, draws);
  if (captures) glEndTransformFeedback();
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

std::vector<std::string> defines_of(TreePasses::Kind kind) {
  switch (kind) {
    case TreePasses::Kind::kWire:
      return {"WIRE"};
    case TreePasses::Kind::kDepth:
      return {"SHADOW"};
    case TreePasses::Kind::kCapture:
      return {"CAPTURE"};
    case TreePasses::Kind::kShaded:
      break;
  }
  return {};
}

TreeDrawList::TreeDrawList(size_t patches)
    : classes(bytes_of(patches, sizeof(uint32_t))),
      group_counts(bytes_of(patch_groups(patches), 2 * sizeof(uint32_t))),
      plain(bytes_of(patches, sizeof(uint32_t))),
      tessellated(bytes_of(patches, sizeof(uint32_t))),
      commands(bytes_of(2 + patches / software_patches(kHighestLevel),
                        sizeof(shared::TreeDrawCommand))) {}

TreeBuffers::TreeBuffers(const TreePatches& tree)
    : vertex_count(static_cast<int32_t>(tree.vertices.size())),
      edge_count(static_cast<int32_t>(tree.edges.size())),
      patch_count(static_cast<int32_t>(tree.patches.size())),
      vertices(tree.vertices),
      sections(tree.sections),
      edges(tree.edges),
      patches(tree.patches),
      bones(
          bone_rows(std::vector<glm::mat4>(static_cast<size_t>(tree.bone_count), glm::mat4(1.0f)))),
      posed(bytes_of(tree.vertices.size(), sizeof(shared::PosedVertex))),
      edge_levels(bytes_of(tree.edges.size(), sizeof(float))),
      camera(tree.patches.size()),
      sun(tree.patches.size()) {
  if (patch_groups(tree.patches.size()) > kMostGroups) {
    throw std::invalid_argument("a tree of " + std::to_string(tree.patches.size()) +
                                " patches is more than one draw holds: add it in parts");
  }
}

void TreePasses::pose(TreeBuffers& tree, const gpu::Buffer& view) {
  pose_.use();
  pose_.bind("ViewBlock", view);
  pose_.bind("TreeVertices", tree.vertices);
  pose_.bind("PosedVertices", tree.posed);
  pose_.bind("BoneRows", tree.bones);
  pose_.set("count", tree.vertex_count);
  pose_.dispatch_items(tree.vertex_count, kLocalSize);
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

void TreePasses::classify(TreeBuffers& tree, TreeDrawList& list, const gpu::Buffer& view,
                          float max_level) {
  const auto groups = static_cast<int32_t>(patch_groups(static_cast<size_t>(tree.patch_count)));
  classify_.use();
  classify_.bind("ViewBlock", view);
  classify_.bind("PosedVertices", tree.posed);
  classify_.bind("TreePatches", tree.patches);
  classify_.bind("EdgeLevels", tree.edge_levels);
  classify_.bind("PatchClasses", list.classes);
  classify_.bind("GroupCounts", list.group_counts);
  classify_.set("count", tree.patch_count);
  classify_.dispatch(groups);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);

  const int32_t patches_a_draw = gpu::renders_in_software()
                                     ? std::min(tree.patch_count, software_patches(max_level))
                                     : tree.patch_count;
  list.draws = gpu::group_count(tree.patch_count, patches_a_draw);
  offsets_.use();
  offsets_.bind("GroupCounts", list.group_counts);
  offsets_.bind("DrawCommands", list.commands);
  offsets_.set("count", groups);
  offsets_.set("draws", list.draws);
  offsets_.set("patches_a_draw", patches_a_draw);
  offsets_.dispatch(1);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);

  lists_.use();
  lists_.bind("PatchClasses", list.classes);
  lists_.bind("GroupCounts", list.group_counts);
  lists_.bind("PlainPatches", list.plain);
  lists_.bind("TessellatedPatches", list.tessellated);
  lists_.set("count", tree.patch_count);
  lists_.dispatch(groups);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_COMMAND_BARRIER_BIT |
                  GL_BUFFER_UPDATE_BARRIER_BIT);
}

void TreePasses::draw_plain(TreeBuffers& tree, TreeDrawList& list, const gpu::Buffer& view,
                            Kind kind, const gpu::Texture& shadow_map,
                            const glm::vec4& wire_color) {
  gpu::Program& program = begin(plain_, plain_capture_, kind, shadow_map, wire_color);
  program.bind("ViewBlock", view);
  program.bind("PosedVertices", tree.posed);
  program.bind("TreePatches", tree.patches);
  program.bind("PlainPatches", list.plain);
  draw(program, kind, GL_TRIANGLES, list.commands, 0, 1);
}

void TreePasses::draw_tessellated(TreeBuffers& tree, TreeDrawList& list, const gpu::Buffer& view,
                                  Kind kind, const gpu::Texture& shadow_map,
                                  const glm::vec4& wire_color) {
  gpu::Program& program = begin(tree_, tree_capture_, kind, shadow_map, wire_color);
  program.bind("ViewBlock", view);
  program.bind("TreeVertices", tree.vertices);
  program.bind("PosedVertices", tree.posed);
  program.bind("TreeSections", tree.sections);
  program.bind("TreeEdges", tree.edges);
  program.bind("TreePatches", tree.patches);
  program.bind("EdgeLevels", tree.edge_levels);
  program.bind("TessellatedPatches", list.tessellated);
  glPatchParameteri(GL_PATCH_VERTICES, 1);
  draw(program, kind, GL_PATCHES, list.commands, sizeof(shared::TreeDrawCommand), list.draws);
}

}  // namespace snowbough::render
