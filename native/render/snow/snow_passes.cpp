#include "render/snow/snow_passes.h"

#include <utility>

#include "shaders/lib/snow_patch.h"

namespace snowbough::render {
namespace {

constexpr int32_t kLocalSize = 64;

int64_t bytes_of(int64_t count, size_t size) {
  return count * static_cast<int64_t>(size);
}

template <typename Element>
void overwrite(gpu::Buffer& buffer, const std::vector<Element>& elements) {
  buffer.write(0, bytes_of(static_cast<int64_t>(elements.size()), sizeof(Element)),
               elements.data());
}

/// What points between vertices, and pixels, are computed from.
void bind_shading(gpu::Program& program, const SnowBuffers& mesh) {
  program.bind("SnowVertices", mesh.vertices);
  program.bind("CornerNormals", mesh.corner_normals);
  program.bind_texture("height_map", *mesh.map);
}

}  // namespace

SnowBuffers::SnowBuffers(const SnowPatches& mesh, const glm::vec4& base_color)
    : PatchSource(mesh.patches.size()),
      vertex_count(static_cast<int32_t>(mesh.vertices.size())),
      edge_count(static_cast<int32_t>(mesh.edges.size())),
      patch_count(static_cast<int32_t>(mesh.patches.size())),
      color(base_color),
      vertices(mesh.vertices),
      vertex_corners(mesh.vertex_corners),
      corner_normals(mesh.corner_normals),
      edges(mesh.edges),
      edge_bends(mesh.edge_bends),
      patches(mesh.patches),
      points(bytes_of(vertex_count, sizeof(shared::SnowPoint))),
      patch_depths(bytes_of(patch_count, sizeof(float))),
      edge_levels(bytes_of(edge_count, sizeof(float))) {
  set_map(std::make_shared<gpu::Texture>(GL_R32F, 1, 1));
}

void SnowBuffers::set_pose(const SnowPatches& mesh) {
  overwrite(vertices, mesh.vertices);
  overwrite(corner_normals, mesh.corner_normals);
  overwrite(edge_bends, mesh.edge_bends);
  pose_is_new = true;
}

void SnowBuffers::set_map(std::shared_ptr<const gpu::Texture> heights) {
  const int64_t tiles = MapDepths::tile_bytes(*heights);
  if (tile_depths.bytes() != tiles) tile_depths = gpu::Buffer(tiles);
  map = std::move(heights);
  map_is_new = true;
}

std::vector<std::string> SnowBuffers::defines(DrawKind /*kind*/) const {
  return {};
}

void SnowBuffers::bind_classify(gpu::Program& program) const {
  program.bind("SnowVertices", vertices);
  program.bind("SnowPatches", patches);
  program.bind("PatchDepths", patch_depths);
  program.bind("EdgeLevels", edge_levels);
}

void SnowBuffers::bind_plain(gpu::Program& program, DrawKind kind) const {
  program.bind("SnowPatches", patches);
  program.bind("SnowPoints", points);
  if (kind != DrawKind::kShaded) return;
  bind_shading(program, *this);
  program.set("base_color", color);
}

void SnowBuffers::bind_tessellated(gpu::Program& program, DrawKind kind) const {
  program.bind("SnowPatches", patches);
  program.bind("SnowPoints", points);
  program.bind("SnowEdges", edges);
  program.bind("EdgeBends", edge_bends);
  program.bind("EdgeLevels", edge_levels);
  bind_shading(program, *this);
  if (kind == DrawKind::kShaded) program.set("base_color", color);
}

void SnowPasses::find_depths(SnowBuffers& mesh) {
  map_depths_.find_tiles(*mesh.map, mesh.tile_depths);
  depths_.use();
  depths_.bind("SnowPatches", mesh.patches);
  depths_.bind("TileDepths", mesh.tile_depths);
  depths_.bind("PatchDepths", mesh.patch_depths);
  depths_.set("count", mesh.patch_count);
  depths_.set("map_size", glm::ivec2(mesh.map->width(), mesh.map->height()));
  depths_.dispatch_items(mesh.patch_count, kLocalSize);
  mesh.map_is_new = false;
}

void SnowPasses::lay(SnowBuffers& mesh) {
  if (!mesh.map_is_new && !mesh.pose_is_new) return;
  if (mesh.map_is_new) find_depths(mesh);
  vertices_.use();
  vertices_.bind_texture("height_map", *mesh.map);
  vertices_.bind("SnowVertices", mesh.vertices);
  vertices_.bind("VertexCorners", mesh.vertex_corners);
  vertices_.bind("SnowEdges", mesh.edges);
  vertices_.bind("SnowPatches", mesh.patches);
  vertices_.bind("CornerNormals", mesh.corner_normals);
  vertices_.bind("SnowPoints", mesh.points);
  vertices_.set("count", mesh.vertex_count);
  vertices_.dispatch_items(mesh.vertex_count, kLocalSize);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  mesh.pose_is_new = false;
}

void SnowPasses::edge_levels(SnowBuffers& mesh, const gpu::Buffer& view) {
  edges_.use();
  edges_.bind("ViewBlock", view);
  edges_.bind("SnowVertices", mesh.vertices);
  edges_.bind("SnowEdges", mesh.edges);
  edges_.bind("SnowPatches", mesh.patches);
  edges_.bind("PatchDepths", mesh.patch_depths);
  edges_.bind("EdgeLevels", mesh.edge_levels);
  edges_.set("count", mesh.edge_count);
  edges_.dispatch_items(mesh.edge_count, kLocalSize);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

}  // namespace snowbough::render
