#pragma once

#include <cstdint>
#include <vector>

#include "gpu/gl_context.h"
#include "gpu/resources.h"
#include "shaders/lib/snow_shared.h"
#include "snow/scene/map_plan.h"
#include "snow/scene/scene_layout.h"

namespace snowbough::snow {

/// Maps of one size in one texture array, shared by objects with consecutive slots.
struct MapGroup {
  int32_t resolution = 0;
  /// Slots of its objects: [first_slot, end_slot); layer = slot - first_slot.
  int32_t first_slot = 0;
  int32_t end_slot = 0;
  /// Snow thickness in metres, R32F.
  gpu::Texture height;

  int32_t layers() const { return end_slot - first_slot; }
  int64_t layer_bytes() const { return int64_t{4} * resolution * resolution; }
  /// Copies one layer's heights out or in. GPU thread.
  void read_height(int32_t layer, std::vector<float>& heights) const;
  void write_height(int32_t layer, const std::vector<float>& heights);
};

/// Allocates a group's maps, empty. GPU thread.
MapGroup make_map_group(const MapPlan::Group& plan);

/// Byte offsets of the dispatch arguments in a list of groups: one invocation per texel, in blocks
/// of 64, or one work group per group, in which each invocation takes every 64th texel.
inline constexpr int64_t kBlocks = 0;
inline constexpr int64_t kWholeGroups = 16;

/// Texels of a batch: its steps, 16 bytes a texel, fit llvmpipe's largest storage buffer (128 MiB).
inline constexpr int32_t kBatchTexels = (1 << 22) - static_cast<int32_t>(shared::kTexelGroup);
/// OpenGL promises dispatches of 65,535 work groups; the smallest work groups take 64 texels.
static_assert(kBatchTexels / 64 <= 65535 && kBatchTexels % shared::kTexelGroup == 0);

/// A run of a map group's texels, with all data that the passes keep per texel.
struct TexelBatch {
  int32_t group = 0;
  /// The batch's texels within the group: [first, first + count); whole work groups.
  int32_t first = 0;
  int32_t count = 0;
  /// Which work groups belong to which object, counted from the batch's beginning.
  std::vector<shared::StatisticsSegment> segments;

  /// layer * resolution^2 + row * resolution + column within the map group; shared::kNowhere pads
  /// the work group behind an object's last texel.
  gpu::Buffer places;
  gpu::Buffer fragment_begin;
  gpu::Buffer fragments;
  /// Per fragment, see snow/scene/fragment_opacity.h; empty if all objects of the group are opaque.
  gpu::Buffer fragment_opacity;
  /// shared::TexelStep of the current step.
  gpu::Buffer steps;
  gpu::Buffer partials;
  /// Per texel, the volume in m3 that stability let slide in this step; empty if not recorded.
  gpu::Buffer slid;
  gpu::Buffer segment_buffer;
  gpu::Buffer group_slots;
  /// Work groups of texels, see shaders/texel_groups.comp.glsl: the triangles that decide whether a
  /// group is active, whether snow lies on it, and the groups active in this step.
  gpu::Buffer group_begin;
  gpu::Buffer group_triangles;
  gpu::Buffer group_states;
  gpu::Buffer active_groups;
  int32_t group_count() const { return count / static_cast<int32_t>(shared::kTexelGroup); }

  /// The buffers above as buffer textures, which llvmpipe reads a whole vector at a time.
  struct Views {
    gpu::BufferTexture places;
    gpu::BufferTexture fragment_begin;
    gpu::BufferTexture fragments;
    gpu::BufferTexture fragment_opacity;
    gpu::BufferTexture steps;
    gpu::BufferTexture group_slots;
    gpu::BufferTexture group_begin;
    gpu::BufferTexture group_triangles;
    gpu::BufferTexture active_groups;
  } views;
};

/// All scene data on the GPU, in one set of buffers for all objects: a thousand small receivers
/// cost a handful of dispatches.
struct SceneBuffers {
  /// Without its arrays of triangles, smooth points and alpha, which are in the buffers.
  SceneLayout layout;
  int32_t triangle_count = 0;

  gpu::Buffer positions;
  gpu::Buffer triangles;
  /// Triangles as seen along the step's fall, see shaders/lib/triangle_setup.h.
  gpu::Buffer triangle_corners;
  gpu::Buffer triangle_surface;
  /// Per triangle: its sheet (snow/texels/sheets.h), numbered across all objects.
  gpu::Buffer triangle_sheets;
  /// See snow/scene/smooth_points.h; empty if everything is shaded flat. The last two are per
  /// point: the normal, and the surface there (shaders/lib/smooth_points.h).
  gpu::Buffer triangle_points;
  gpu::Buffer point_begin;
  gpu::Buffer point_corners;
  gpu::Buffer point_normals;
  gpu::Buffer smooth_points;
  int64_t smooth_point_count = 0;
  /// Whether `point_normals` are those of `positions`.
  bool normals_are_current = false;
  gpu::Buffer map_triangles;
  gpu::Buffer map_offsets;
  /// Only of objects with alpha: shared::AlphaTriangle, shared::AlphaMaskHeader and the masks'
  /// bits.
  gpu::Buffer alpha_triangles;
  gpu::Buffer alpha_headers;
  gpu::Buffer alpha_bits;
  gpu::Buffer back_pixels;
  gpu::Buffer sums;
  std::vector<MapGroup> groups;
  std::vector<TexelBatch> batches;

  struct Views {
    gpu::BufferTexture positions;
    gpu::BufferTexture triangles;
    /// `triangles`, one number per element.
    gpu::BufferTexture triangle_words;
    gpu::BufferTexture triangle_corners;
    gpu::BufferTexture triangle_surface;
    gpu::BufferTexture triangle_sheets;
    gpu::BufferTexture triangle_points;
    gpu::BufferTexture point_begin;
    gpu::BufferTexture point_corners;
    gpu::BufferTexture point_normals;
    gpu::BufferTexture smooth_points;
    gpu::BufferTexture map_triangles;
    gpu::BufferTexture map_offsets;
    gpu::BufferTexture alpha_triangles;
    gpu::BufferTexture alpha_headers;
    gpu::BufferTexture alpha_bits;
  } views;
};

/// Builds and uploads the scene without positions. `objects` are sorted by name and have positions.
/// GPU thread.
/// @throws std::runtime_error with the figure if a buffer would exceed the driver's limit.
SceneBuffers build_scene_buffers(const std::vector<const SceneObject*>& objects,
                                 const gpu::GpuInfo& info);

}  // namespace snowbough::snow
