#include "snow/scene_buffers.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <stdexcept>
#include <string>

#include "snow/sheets.h"
#include "snow/surface_order.h"
#include "snow/texel_batches.h"

namespace snowbough::snow {
namespace {

using shared::kTexelGroup;

void require_room(int64_t bytes, const gpu::GpuInfo& info, const char* what) {
  if (bytes > info.max_storage_buffer_bytes) {
    throw std::runtime_error(
        std::string("the scene's ") + what + " take " + std::to_string(bytes >> 20) +
        " MiB, the driver (" + info.renderer + ") takes " +
        std::to_string(info.max_storage_buffer_bytes >> 20) +
        " MiB: leave out or simplify objects that snow does not need, or use another GPU");
  }
}

/// Writes a layer of a group's `owners`: per texel of the map its owner, 1 + index in the group,
/// and its chart << 8 with its coverage in 255ths. In bands of rows, which take little memory.
void upload_owners(const TexelTable& table, const std::vector<uint32_t>& owners, int32_t layer,
                   gpu::Texture& texture) {
  constexpr int32_t kBandRows = 64;
  const int32_t resolution = table.resolution;
  std::vector<glm::uvec2> band;
  size_t i = 0;  // the table's texels are in the order of the map's
  for (int32_t row = 0; row < resolution; row += kBandRows) {
    const int32_t rows = std::min(kBandRows, resolution - row);
    const int32_t first = row * resolution;
    const int32_t count = rows * resolution;
    band.assign(static_cast<size_t>(count), glm::uvec2(0));
    for (; i < table.texel.size() && table.texel[i] < first + count; ++i) {
      const auto texel = static_cast<size_t>(table.texel[i]);
      const auto chart = static_cast<uint32_t>(table.chart[i]);
      const auto coverage =
          static_cast<uint32_t>(std::lround(std::clamp(table.coverage[i], 0.0f, 1.0f) * 255.0f));
      band[texel - static_cast<size_t>(first)] = {owners[texel], chart << 8 | coverage};
    }
    texture.write_rows(layer, row, rows, GL_RG_INTEGER, GL_UNSIGNED_INT, band.data());
  }
}

/// Fills in where GEOMETRY finds texels: a layer of the group's `owners`, and per map triangle the
/// texel that holds most of it. `order`: the receiver's texels as they lie in the group, from
/// `first_owner` on.
void add_owners(const TexelTable& table, const std::vector<int32_t>& order, uint32_t first_owner,
                int32_t layer, MapGroup& group, std::span<shared::MapTriangle> map_triangles) {
  std::vector<uint32_t> owners(
      static_cast<size_t>(table.resolution) * static_cast<size_t>(table.resolution), 0);
  std::vector<float> home_share(map_triangles.size(), 0.0f);
  for (size_t at = 0; at < order.size(); ++at) {
    const auto i = static_cast<size_t>(order[at]);
    const auto owner = first_owner + static_cast<uint32_t>(at);
    owners[static_cast<size_t>(table.texel[i])] = owner;
    const auto end = static_cast<size_t>(table.fragment_begin[i + 1]);
    for (auto f = static_cast<size_t>(table.fragment_begin[i]); f < end; ++f) {
      const auto triangle = static_cast<size_t>(table.fragment_triangle[f]);
      if (table.fragment_share[f] > home_share[triangle]) {
        home_share[triangle] = table.fragment_share[f];
        map_triangles[triangle].home = owner;
        map_triangles[triangle].chart = static_cast<uint32_t>(table.chart[i]);
      }
    }
  }
  upload_owners(table, owners, layer, group.owners);
}

/// Adds one receiver's texels to its group, and its map triangles.
void add_receiver(const SceneObject& object, int32_t first_triangle, int32_t layer, bool has_owners,
                  BatchWriter& writer, MapGroup& group,
                  std::vector<shared::MapTriangle>& map_triangles) {
  const TexelTable& table = object.table;
  const auto map_texels =
      static_cast<uint32_t>(table.resolution) * static_cast<uint32_t>(table.resolution);
  const size_t first_map = map_triangles.size();
  const MapTopology& topology = object.description.topology;
  for (int32_t t = 0; t < object.triangle_count(); ++t) {
    const glm::vec2* uv = &topology.corner_uv[3 * static_cast<size_t>(t)];
    map_triangles.push_back({uv[0], uv[1], uv[2], 0, 0});
  }

  const std::vector<int32_t> order = surface_order(table);
  const auto first_owner = static_cast<uint32_t>(writer.next()) + 1;
  for (size_t begin = 0; begin < order.size(); begin += kTexelGroup) {
    const size_t count = std::min<size_t>(kTexelGroup, order.size() - begin);
    writer.add_group(object, std::span(order).subspan(begin, count),
                     static_cast<uint32_t>(first_triangle),
                     static_cast<uint32_t>(layer) * map_texels);
  }
  add_group_triangles(table, order, static_cast<uint32_t>(first_triangle), writer.triangles());
  if (has_owners) {
    add_owners(table, order, first_owner, layer, group,
               std::span(map_triangles).subspan(first_map));
  }
}

/// Uploads the objects' alpha; masks that several objects share lie there once.
void add_alpha(const std::vector<const SceneObject*>& objects, const gpu::GpuInfo& info,
               SceneBuffers& scene) {
  std::vector<shared::AlphaTriangle> triangles;
  std::vector<shared::AlphaMaskPlace> places;
  std::vector<uint32_t> bits;
  std::map<const AlphaMask*, uint32_t> numbers;  // never iterated over
  for (const SceneObject* object : objects) {
    const ObjectAlpha& alpha = object->description.alpha;
    scene.first_alpha.push_back(alpha.empty() ? -1 : static_cast<int32_t>(triangles.size()));
    std::vector<uint32_t> number_of;
    for (const std::shared_ptr<const AlphaMask>& mask : alpha.masks) {
      const auto number = static_cast<uint32_t>(places.size() + 1);
      const auto [known, is_new] = numbers.emplace(mask.get(), number);
      if (is_new) {
        places.push_back({static_cast<uint32_t>(bits.size()), static_cast<uint32_t>(mask->width),
                          static_cast<uint32_t>(mask->height), mask->extension});
        bits.insert(bits.end(), mask->bits.begin(), mask->bits.end());
      }
      number_of.push_back(known->second);
    }
    for (size_t t = 0; t < alpha.mask.size(); ++t) {
      const glm::vec2* uv = &alpha.corner_uv[3 * t];
      const int32_t mask = alpha.mask[t];
      triangles.push_back(
          {uv[0], uv[1], uv[2], mask < 0 ? 0u : number_of[static_cast<size_t>(mask)], 0u});
    }
  }
  require_room(static_cast<int64_t>(triangles.size() * sizeof(shared::AlphaTriangle)), info,
               "triangles with alpha");
  require_room(static_cast<int64_t>(bits.size()) * 4, info, "alpha images");
  scene.alpha_triangles = gpu::Buffer(triangles);
  scene.alpha_places = gpu::Buffer(places);
  scene.alpha_bits = gpu::Buffer(bits);
  scene.views.alpha_triangles = gpu::BufferTexture(scene.alpha_triangles, GL_RGBA32UI);
  scene.views.alpha_places = gpu::BufferTexture(scene.alpha_places, GL_RGBA32UI);
  scene.views.alpha_bits = gpu::BufferTexture(scene.alpha_bits, GL_R32UI);
}

}  // namespace

SceneBuffers build_scene_buffers(const std::vector<const SceneObject*>& objects,
                                 const gpu::GpuInfo& info, SceneLayout layout) {
  SceneBuffers scene;
  scene.on_processor = layout.on_processor;
  scene.has_owners = layout.with_owners;
  const MapPlan plan = plan_maps(objects, info.max_array_layers);
  scene.slot = plan.slot;
  scene.group = plan.group;

  std::vector<shared::SceneTriangle> triangles;
  std::vector<uint32_t> triangle_sheets;
  uint32_t first_sheet = 0;
  int32_t vertex_count = 0;
  for (size_t i = 0; i < objects.size(); ++i) {
    const MapTopology& topology = objects[i]->description.topology;
    scene.first_vertex.push_back(vertex_count);
    scene.first_triangle.push_back(static_cast<int32_t>(triangles.size()));
    const auto base = static_cast<uint32_t>(vertex_count);
    const uint32_t slot = static_cast<uint32_t>(plan.slot[i]) |
                          (objects[i]->description.receive ? shared::kReceives : 0u);
    for (size_t t = 0; t + 2 < topology.triangles.size(); t += 3) {
      triangles.push_back({base + static_cast<uint32_t>(topology.triangles[t]),
                           base + static_cast<uint32_t>(topology.triangles[t + 1]),
                           base + static_cast<uint32_t>(topology.triangles[t + 2]), slot});
    }
    vertex_count += static_cast<int32_t>(objects[i]->positions.size());
    const Sheets sheets = find_sheets(topology.triangles, topology.vertex_count);
    for (const int32_t sheet : sheets.sheet) {
      triangle_sheets.push_back(first_sheet + static_cast<uint32_t>(sheet));
    }
    first_sheet += static_cast<uint32_t>(sheets.count);
  }
  scene.triangle_count = static_cast<int32_t>(triangles.size());
  require_room(static_cast<int64_t>(triangles.size()) * 16, info, "triangles");
  require_room(static_cast<int64_t>(vertex_count) * 12, info, "vertices");
  scene.positions = gpu::Buffer(static_cast<int64_t>(vertex_count) * 12);
  scene.triangles = gpu::Buffer(triangles);
  scene.triangle_sheets = gpu::Buffer(triangle_sheets);
  scene.triangle_corners = gpu::Buffer(static_cast<int64_t>(triangles.size()) * 48);
  scene.triangle_surface = gpu::Buffer(static_cast<int64_t>(triangles.size()) * 16);

  std::vector<size_t> by_slot(objects.size());
  for (size_t i = 0; i < objects.size(); ++i) {
    by_slot[static_cast<size_t>(plan.slot[i])] = i;
  }
  std::vector<shared::MapTriangle> map_triangles;
  std::vector<int32_t> map_offsets(objects.size(), 0);
  for (size_t g = 0; g < plan.groups.size(); ++g) {
    scene.groups.push_back(make_map_group(plan.groups[g], layout.on_processor, layout.with_owners));
    MapGroup& group = scene.groups.back();
    size_t texel_count = 0;
    size_t fragment_count = 0;
    bool has_opacity = false;
    for (int32_t slot = group.first_slot; slot < group.end_slot; ++slot) {
      const TexelTable& table = objects[by_slot[static_cast<size_t>(slot)]]->table;
      texel_count += (table.texel.size() + kTexelGroup - 1) / kTexelGroup * kTexelGroup;
      fragment_count += table.fragment_share.size();
      has_opacity |= !objects[by_slot[static_cast<size_t>(slot)]]->fragment_opacity.empty();
    }
    BatchWriter writer(scene, {static_cast<int32_t>(g), texel_count, fragment_count, has_opacity});
    for (int32_t slot = group.first_slot; slot < group.end_slot; ++slot) {
      const size_t i = by_slot[static_cast<size_t>(slot)];
      map_offsets[static_cast<size_t>(slot)] =
          static_cast<int32_t>(map_triangles.size()) - scene.first_triangle[i];
      const TexelTable& table = objects[i]->table;
      writer.begin_object(slot, table.texel.size(), table.fragment_share.size());
      add_receiver(*objects[i], scene.first_triangle[i], slot - group.first_slot, scene.has_owners,
                   writer, group, map_triangles);
      writer.end_object();
    }
    writer.finish();
  }
  require_room(static_cast<int64_t>(map_triangles.size() * sizeof(shared::MapTriangle)), info,
               "receivers' triangles");
  scene.map_triangles = gpu::Buffer(map_triangles);
  scene.map_offsets = gpu::Buffer(map_offsets);
  scene.back_pixels = gpu::Buffer(static_cast<int64_t>(objects.size() * sizeof(uint32_t)));
  scene.sums = gpu::Buffer(static_cast<int64_t>(objects.size() * sizeof(shared::ObjectSums)));
  scene.views.positions = gpu::BufferTexture(scene.positions, GL_RGB32F);
  scene.views.triangles = gpu::BufferTexture(scene.triangles, GL_RGBA32UI);
  scene.views.triangle_words = gpu::BufferTexture(scene.triangles, GL_R32UI);
  scene.views.triangle_corners = gpu::BufferTexture(scene.triangle_corners, GL_RGBA32F);
  scene.views.triangle_surface = gpu::BufferTexture(scene.triangle_surface, GL_RGBA32F);
  scene.views.triangle_sheets = gpu::BufferTexture(scene.triangle_sheets, GL_R32UI);
  scene.views.map_triangles = gpu::BufferTexture(scene.map_triangles, GL_RGBA32F);
  scene.views.map_offsets = gpu::BufferTexture(scene.map_offsets, GL_R32I);
  add_alpha(objects, info, scene);
  return scene;
}

}  // namespace snowbough::snow
