#include "render/tree/tree_passes.h"

#include <utility>

#include "render/draw/matrix_rows.h"

namespace snowbough::render {
namespace {

constexpr int32_t kLocalSize = 64;

int64_t bytes_of(size_t count, size_t size) {
  return static_cast<int64_t>(count * size);
}

std::vector<std::string> snow_define(const TreeBuffers& tree) {
  return tree.snow != nullptr ? std::vector<std::string>{"SNOW"} : std::vector<std::string>{};
}

void bind_images(gpu::Program& program, const TreeBuffers& tree) {
  if (!tree.images) return;
  program.bind("BarkPlaces", tree.images->places);
  program.bind_texture("bark_images", tree.images->layers);
}

}  // namespace

TreeBuffers::TreeBuffers(const TreePatches& tree)
    : PatchSource(tree.patches.size()),
      vertex_count(static_cast<int32_t>(tree.vertices.size())),
      edge_count(static_cast<int32_t>(tree.edges.size())),
      vertices(tree.vertices),
      sections(tree.sections),
      edges(tree.edges),
      patches(tree.patches),
      vertex_snow(tree.vertex_snow),
      bones(matrix_rows(
          std::vector<glm::mat4>(static_cast<size_t>(tree.bone_count), glm::mat4(1.0f)))),
      posed(bytes_of(tree.vertices.size(), sizeof(shared::PosedVertex))),
      edge_levels(bytes_of(tree.edges.size(), sizeof(float))),
      growths(bytes_of(tree.patches.size(), sizeof(shared::PatchGrowth))) {}

std::vector<std::string> TreeBuffers::defines(DrawKind kind) const {
  std::vector<std::string> defines = snow_define(*this);
  if (kind == DrawKind::kShaded && images) defines.emplace_back("IMAGE");
  return defines;
}

void TreeBuffers::bind_classify(gpu::Program& program) const {
  program.bind("TreeVertices", vertices);
  program.bind("PosedVertices", posed);
  program.bind("TreeSections", sections);
  program.bind("TreeEdges", edges);
  program.bind("TreePatches", patches);
  program.bind("EdgeLevels", edge_levels);
  program.bind("TileDepths", tile_depths);
  program.bind("PatchGrowths", growths);
  program.set("map_size",
              snow != nullptr ? glm::ivec2(snow->width(), snow->height()) : glm::ivec2(0));
}

void TreeBuffers::bind_plain(gpu::Program& program, DrawKind kind) const {
  program.bind("TreeVertices", vertices);
  program.bind("PosedVertices", posed);
  program.bind("TreePatches", patches);
  program.bind("PatchGrowths", growths);
  if (kind != DrawKind::kShaded) return;
  bind_images(program, *this);
  if (snow != nullptr) program.bind_texture("height_map", *snow);
}

void TreeBuffers::bind_tessellated(gpu::Program& program, DrawKind kind) const {
  program.bind("TreeVertices", vertices);
  program.bind("PosedVertices", posed);
  program.bind("TreeSections", sections);
  program.bind("TreeEdges", edges);
  program.bind("TreePatches", patches);
  program.bind("EdgeLevels", edge_levels);
  if (kind == DrawKind::kShaded) bind_images(program, *this);
  if (snow != nullptr) program.bind_texture("height_map", *snow);
}

void TreeBuffers::set_snow(std::shared_ptr<const gpu::Texture> heights, const SnowDepths& depths) {
  snow = std::move(heights);
  snow_depths = depths;
  snow_is_new = true;
  if (snow == nullptr) return;
  const int64_t tiles = MapDepths::tile_bytes(*snow);
  if (tile_depths.bytes() != tiles) tile_depths = gpu::Buffer(tiles);
}

void TreePasses::find_depths(TreeBuffers& tree) {
  if (tree.snow_is_new && tree.snow != nullptr) {
    map_depths_.find_tiles(*tree.snow, tree.tile_depths);
  }
  tree.snow_is_new = false;
}

void TreePasses::pose(TreeBuffers& tree, const gpu::Buffer& view) {
  find_depths(tree);
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
  gpu::Program& program = edges_.with(snow_define(tree));
  program.use();
  program.bind("ViewBlock", view);
  program.bind("TreeVertices", tree.vertices);
  program.bind("PosedVertices", tree.posed);
  program.bind("TreeEdges", tree.edges);
  program.bind("EdgeLevels", tree.edge_levels);
  program.set("count", tree.edge_count);
  program.dispatch_items(tree.edge_count, kLocalSize);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

}  // namespace snowbough::render
