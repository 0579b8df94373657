#include "snow/step/gl/scene_buffers.h"

#include <algorithm>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

#include "snow/step/gl/texel_batches.h"
#include "snow/texels/texel_order.h"

namespace snowbough::snow {
namespace {

using shared::kTexelGroup;

void require_room(int64_t bytes, const gpu::GpuInfo& info, const char* what) {
  if (bytes > info.max_storage_buffer_bytes) {
    throw std::runtime_error(
        std::string("the scene's ") + what + " need " + std::to_string(bytes >> 20) +
        " MiB, the limit of the driver (" + info.renderer + ") is " +
        std::to_string(info.max_storage_buffer_bytes >> 20) +
        " MiB: remove or simplify objects that snow does not need, or use another GPU");
  }
}

/// Adds one receiver's texels to its group.
void add_receiver(const SceneObject& object, int32_t first_triangle, int32_t layer,
                  BatchWriter& writer) {
  const TexelTable& table = *object.table;
  const auto map_texels =
      static_cast<uint32_t>(table.resolution) * static_cast<uint32_t>(table.resolution);
  const std::vector<int32_t> order = texel_order(table);
  for (size_t begin = 0; begin < order.size(); begin += kTexelGroup) {
    const size_t count = std::min<size_t>(kTexelGroup, order.size() - begin);
    writer.add_group(object, std::span(order).subspan(begin, count),
                     static_cast<uint32_t>(first_triangle),
                     static_cast<uint32_t>(layer) * map_texels);
  }
  add_group_triangles(table, order, static_cast<uint32_t>(first_triangle), writer.triangles());
}

/// Adds the texels of a map group's receivers, in batches, and creates its maps.
void add_group(const std::vector<const SceneObject*>& by_slot, const MapPlan::Group& plan,
               SceneBuffers& scene) {
  BatchWriter::Plan batches{static_cast<int32_t>(scene.groups.size()), 0, 0, false};
  scene.groups.push_back(make_map_group(plan));
  for (int32_t slot = plan.first_slot; slot < plan.end_slot; ++slot) {
    const SceneObject& object = *by_slot[static_cast<size_t>(slot)];
    batches.texel_count +=
        (object.table->texel.size() + kTexelGroup - 1) / kTexelGroup * kTexelGroup;
    batches.fragment_count += object.table->fragment_share.size();
    batches.has_opacity |= !object.fragment_opacity.empty();
  }
  BatchWriter writer(scene, batches);
  const std::vector<size_t> number = objects_by_slot(scene.layout.plan);
  for (int32_t slot = plan.first_slot; slot < plan.end_slot; ++slot) {
    const auto at = static_cast<size_t>(slot);
    const SceneObject& object = *by_slot[at];
    const int32_t first = scene.layout.first_triangle[number[at]];
    writer.begin_object(slot, object.table->texel.size(), object.table->fragment_share.size());
    add_receiver(object, first, slot - plan.first_slot, writer);
    writer.end_object();
  }
  writer.finish();
}

void add_alpha(const SceneLayout& layout, const gpu::GpuInfo& info, SceneBuffers& scene) {
  require_room(static_cast<int64_t>(layout.alpha_triangles.size() * sizeof(shared::AlphaTriangle)),
               info, "triangles with alpha");
  require_room(static_cast<int64_t>(layout.alpha_bits.size()) * 4, info, "alpha images");
  scene.alpha_triangles = gpu::Buffer(layout.alpha_triangles);
  scene.alpha_headers = gpu::Buffer(layout.alpha_headers);
  scene.alpha_bits = gpu::Buffer(layout.alpha_bits);
  scene.views.alpha_triangles = gpu::BufferTexture(scene.alpha_triangles, GL_RGBA32UI);
  scene.views.alpha_headers = gpu::BufferTexture(scene.alpha_headers, GL_RGBA32UI);
  scene.views.alpha_bits = gpu::BufferTexture(scene.alpha_bits, GL_R32UI);
}

/// Uploads triangles, and allocates vertices and the results of the triangle set-up.
void add_triangles(const SceneLayout& layout, const gpu::GpuInfo& info, SceneBuffers& scene) {
  const auto triangles = static_cast<int64_t>(layout.triangles.size());
  scene.triangle_count = static_cast<int32_t>(triangles);
  require_room(triangles * 16, info, "triangles");
  require_room(int64_t{12} * layout.vertex_count, info, "vertices");
  scene.positions = gpu::Buffer(int64_t{12} * layout.vertex_count);
  scene.triangles = gpu::Buffer(layout.triangles);
  scene.triangle_sheets = gpu::Buffer(layout.triangle_sheets);
  scene.triangle_corners = gpu::Buffer(triangles * 48);
  scene.triangle_surface = gpu::Buffer(triangles * 16);
  scene.views.positions = gpu::BufferTexture(scene.positions, GL_RGB32F);
  scene.views.triangles = gpu::BufferTexture(scene.triangles, GL_RGBA32UI);
  scene.views.triangle_words = gpu::BufferTexture(scene.triangles, GL_R32UI);
  scene.views.triangle_corners = gpu::BufferTexture(scene.triangle_corners, GL_RGBA32F);
  scene.views.triangle_surface = gpu::BufferTexture(scene.triangle_surface, GL_RGBA32F);
  scene.views.triangle_sheets = gpu::BufferTexture(scene.triangle_sheets, GL_R32UI);
}

/// Uploads the smooth points, if any, and allocates their results.
void add_smooth_points(const SmoothPoints& points, const gpu::GpuInfo& info, SceneBuffers& scene) {
  scene.smooth_point_count = static_cast<int64_t>(points.count());
  if (points.count() == 0) return;
  require_room(int64_t{16} * scene.smooth_point_count, info, "smooth points");
  scene.triangle_points = gpu::Buffer(points.of_triangle);
  scene.point_begin = gpu::Buffer(points.begin);
  scene.point_corners = gpu::Buffer(points.corners);
  scene.point_normals = gpu::Buffer(int64_t{16} * scene.smooth_point_count);
  scene.smooth_points = gpu::Buffer(int64_t{16} * scene.smooth_point_count);
  scene.views.triangle_points = gpu::BufferTexture(scene.triangle_points, GL_RGBA32UI);
  scene.views.point_begin = gpu::BufferTexture(scene.point_begin, GL_R32UI);
  scene.views.point_corners = gpu::BufferTexture(scene.point_corners, GL_R32UI);
  scene.views.point_normals = gpu::BufferTexture(scene.point_normals, GL_RGBA32F);
  scene.views.smooth_points = gpu::BufferTexture(scene.smooth_points, GL_RGBA32F);
}

}  // namespace

SceneBuffers build_scene_buffers(const std::vector<const SceneObject*>& objects,
                                 const gpu::GpuInfo& info) {
  SceneBuffers scene;
  SceneLayout layout = lay_out_scene(objects, info.max_array_layers);
  add_triangles(layout, info, scene);
  add_alpha(layout, info, scene);
  add_smooth_points(layout.smooth_points, info, scene);
  require_room(static_cast<int64_t>(layout.map_triangles.size() * sizeof(shared::MapTriangle)),
               info, "receivers' triangles");
  scene.map_triangles = gpu::Buffer(layout.map_triangles);
  for (auto* done : {&layout.triangle_sheets, &layout.alpha_bits}) *done = {};
  layout.map_triangles = {};
  layout.triangles = {};
  layout.smooth_points = {};
  layout.alpha_triangles = {};
  scene.layout = std::move(layout);

  std::vector<const SceneObject*> by_slot;
  for (const size_t object : objects_by_slot(scene.layout.plan)) by_slot.push_back(objects[object]);
  for (const MapPlan::Group& group : scene.layout.plan.groups) {
    add_group(by_slot, group, scene);
  }
  scene.map_offsets = gpu::Buffer(scene.layout.map_offsets);
  scene.back_pixels = gpu::Buffer(static_cast<int64_t>(objects.size() * sizeof(uint32_t)));
  scene.sums = gpu::Buffer(static_cast<int64_t>(objects.size() * sizeof(shared::ObjectSums)));
  scene.views.map_triangles = gpu::BufferTexture(scene.map_triangles, GL_RGBA32F);
  scene.views.map_offsets = gpu::BufferTexture(scene.map_offsets, GL_R32I);
  return scene;
}

void MapGroup::read_height(int32_t layer, std::vector<float>& heights) const {
  heights.resize(static_cast<size_t>(layer_bytes()) / sizeof(float));
  height.read(layer, GL_RED, GL_FLOAT, layer_bytes(), heights.data());
}

void MapGroup::write_height(int32_t layer, const std::vector<float>& heights) {
  height.write(layer, GL_RED, GL_FLOAT, heights.data());
}

MapGroup make_map_group(const MapPlan::Group& plan) {
  MapGroup group;
  group.resolution = plan.resolution;
  group.first_slot = plan.first_slot;
  group.end_slot = plan.end_slot;
  group.height = gpu::Texture(GL_R32F, plan.resolution, plan.resolution, group.layers());
  return group;
}

}  // namespace snowbough::snow
