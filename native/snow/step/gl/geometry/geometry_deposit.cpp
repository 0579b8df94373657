#include "snow/step/gl/geometry/geometry_deposit.h"

#include <cstdint>
#include <span>

#include "snow/texels/texel_order.h"

namespace snowbough::snow {
namespace {

/// Enables additive drawing of points on `framebuffer` within its scope.
class AdditivePoints {
 public:
  AdditivePoints(const gpu::Framebuffer& framebuffer, const gpu::VertexArray& vertices,
                 glm::ivec2 size) {
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer.id());
    glBindVertexArray(vertices.id());
    glViewport(0, 0, size.x, size.y);
    glDisable(GL_DEPTH_TEST);
    glEnable(GL_PROGRAM_POINT_SIZE);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE);
    glBlendEquation(GL_FUNC_ADD);
  }
  ~AdditivePoints() {
    glDisable(GL_BLEND);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
  }
  AdditivePoints(const AdditivePoints&) = delete;
  AdditivePoints& operator=(const AdditivePoints&) = delete;
};

/// Fills a receiver's layer of the maps, and the main_texels of its triangles. `first_owner`: the
/// owner of its first texel.
void add_receiver(const TexelTable& table, uint32_t first_owner, int32_t layer,
                  gpu::Texture& owners, gpu::Texture& charts, std::span<glm::uvec2> main_texels) {
  const size_t texels =
      static_cast<size_t>(table.resolution) * static_cast<size_t>(table.resolution);
  std::vector<uint32_t> owner_map(texels, 0);
  std::vector<uint32_t> chart_map(texels, 0);
  std::vector<float> main_share(main_texels.size(), 0.0f);
  uint32_t owner = first_owner;
  for (const int32_t index : texel_order(table)) {
    const auto i = static_cast<size_t>(index);
    const auto texel = static_cast<size_t>(table.texel[i]);
    owner_map[texel] = owner;
    chart_map[texel] = static_cast<uint32_t>(table.chart[i]);
    const auto end = static_cast<size_t>(table.fragment_begin[i + 1]);
    for (auto f = static_cast<size_t>(table.fragment_begin[i]); f < end; ++f) {
      const auto triangle = static_cast<size_t>(table.fragment_triangle[f]);
      if (table.fragment_share[f] > main_share[triangle]) {
        main_share[triangle] = table.fragment_share[f];
        main_texels[triangle] = {owner, chart_map[texel]};
      }
    }
    ++owner;
  }
  owners.write(layer, GL_RED_INTEGER, GL_UNSIGNED_INT, owner_map.data());
  charts.write(layer, GL_RED_INTEGER, GL_UNSIGNED_INT, chart_map.data());
}

}  // namespace

GeometryDeposit::Maps::Maps(int32_t resolution, int32_t layers)
    : owners(GL_R32UI, resolution, resolution, layers),
      charts(GL_R32UI, resolution, resolution, layers),
      deposit(GL_R32F, resolution, resolution, layers),
      target({&deposit}) {}

GeometryDeposit::GeometryDeposit(const std::vector<const SceneObject*>& objects,
                                 const SceneBuffers& scene) {
  std::vector<glm::uvec2> main_texels(static_cast<size_t>(scene.map_triangles.bytes()) /
                                      sizeof(shared::MapTriangle));
  const SceneLayout& layout = scene.layout;
  const std::vector<size_t> numbers = objects_by_slot(layout.plan);
  for (const MapGroup& group : scene.groups) {
    Maps& maps = maps_.emplace_back(group.resolution, group.layers());
    uint32_t owner = 1;
    for (int32_t slot = group.first_slot; slot < group.end_slot; ++slot) {
      const auto at = static_cast<size_t>(slot);
      const SceneObject& object = *objects[numbers[at]];
      const auto first =
          static_cast<size_t>(layout.first_triangle[numbers[at]] + layout.map_offsets[at]);
      add_receiver(
          *object.table, owner, slot - group.first_slot, maps.owners, maps.charts,
          std::span(main_texels).subspan(first, static_cast<size_t>(object.triangle_count())));
      // Texels are in whole groups per object, see BatchWriter.
      const auto texels = static_cast<uint32_t>(object.table->texel.size());
      owner += (texels + shared::kTexelGroup - 1) / shared::kTexelGroup * shared::kTexelGroup;
    }
  }
  main_texels_ = gpu::Buffer(main_texels);
  main_texels_view_ = gpu::BufferTexture(main_texels_, GL_RG32UI);
}

void GeometryDeposit::begin() {
  for (Maps& maps : maps_) maps.deposit.clear();
}

void GeometryDeposit::run(const SceneBuffers& scene, const gpu::Buffer& projection,
                          const Tile& tile, const OcclusionTarget& occlusion) {
  const PixelRect shown = tile.with_margin();
  for (const TexelBatch& batch : scene.batches) {
    const MapGroup& group = scene.groups[static_cast<size_t>(batch.group)];
    const Maps& maps = maps_[static_cast<size_t>(batch.group)];
    const AdditivePoints drawing(maps.target, vertices_, glm::ivec2(group.resolution));
    points_.use();
    points_.bind("Projection", projection);
    points_.bind_texture("triangle_corners", scene.views.triangle_corners);
    points_.bind_texture("triangle_words", scene.views.triangle_words);
    points_.bind_texture("map_triangles", scene.views.map_triangles);
    points_.bind_texture("map_offsets", scene.views.map_offsets);
    points_.bind_texture("places", batch.views.places);
    points_.bind_texture("texel_steps", batch.views.steps);
    points_.bind_texture("occlusion", occlusion.views.visible);
    points_.bind_texture("owners", maps.owners);
    points_.bind_texture("charts", maps.charts);
    points_.bind_texture("main_texels", main_texels_view_);
    points_.set("group_objects", glm::uvec2(group.first_slot, group.end_slot));
    points_.set("batch_texels", glm::uvec2(batch.first, batch.first + batch.count));
    points_.set("tile_origin", shown.low);
    points_.set("tile_size", shown.size());
    points_.set("map_size", static_cast<float>(group.resolution));
    points_.draw(GL_POINTS, 0, shown.size().x * shown.size().y);
  }
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
}

void GeometryDeposit::write_gains(SceneBuffers& scene) {
  for (TexelBatch& batch : scene.batches) {
    gains_.use();
    gains_.bind_texture("groups", batch.views.active_groups);
    gains_.bind_texture("places", batch.views.places);
    gains_.bind_texture("deposit_map", maps_[static_cast<size_t>(batch.group)].deposit);
    gains_.bind("TexelSteps", batch.steps);
    gains_.dispatch_indirect(batch.active_groups, kBlocks);
  }
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT);
}

int64_t GeometryDeposit::memory(const std::vector<const SceneObject*>& objects) {
  int64_t bytes = 0;
  for (const SceneObject* object : objects) {
    if (!object->description.receive) continue;
    const int64_t side = object->description.topology.resolution;
    bytes += side * side * (4 + 4 + 4) + int64_t{8} * object->triangle_count();
  }
  return bytes;
}

}  // namespace snowbough::snow
