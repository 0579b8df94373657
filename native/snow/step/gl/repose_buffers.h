#pragma once

#include <cstdint>
#include <vector>

#include "gpu/gl_context.h"
#include "gpu/resources.h"
#include "shaders/lib/repose_shared.h"
#include "snow/scene/scene_object.h"
#include "snow/step/gl/scene_buffers.h"

namespace snowbough::snow::gl {

/// Two copies of an array: a sweep reads one and writes the other.
struct TwoCopies {
  gpu::Buffer buffer[2];
  gpu::BufferTexture view[2];
};

/// Data of repose on the GPU for the receivers in some consecutive slots: their maps in blocks
/// (shaders/lib/repose_shared.h), as many as the driver's storage blocks hold.
struct ReposeBuffers {
  int32_t first_slot = 0;
  int32_t end_slot = 0;
  int32_t block_count = 0;
  int32_t end_count = 0;
  /// Whether any triangle takes snow on both sides: then links depend on where the snow lies.
  bool has_two_sided = false;
  /// Blocks [first_block, end_block) have their maps in this group.
  struct Run {
    int32_t group = 0;
    int32_t first_block = 0;
    int32_t end_block = 0;
  };
  std::vector<Run> runs;
  /// By slot from first_slot.
  std::vector<shared::ReposeObject> objects;

  gpu::Buffer object_buffer;
  gpu::Buffer first_blocks;
  gpu::Buffer tables;
  gpu::Buffer blocks;
  gpu::Buffer around;
  gpu::Buffer near_begin;
  gpu::Buffer near;
  gpu::Buffer cell_links;
  gpu::Buffer first_end;
  gpu::Buffer ends;
  /// Of the current pose: see shaders/repose_surface.comp.glsl, repose_links and repose_ends.
  gpu::Buffer points;
  gpu::Buffer slopes;
  gpu::Buffer limits;
  gpu::Buffer end_limits;
  /// Of a step: see shaders/repose_cells.comp.glsl, repose_rounds and repose_bounds.
  gpu::Buffer cells;
  TwoCopies moved;
  TwoCopies flows;
  TwoCopies end_flows;
  TwoCopies bounds;
  gpu::Buffer lost;
  gpu::Buffer block_states;
  gpu::Buffer lists;
  gpu::Buffer heads;

  struct Views {
    gpu::BufferTexture blocks, around, near_begin, near, cell_links, first_end, ends, points,
        slopes, limits, end_limits, cells, lists;
  } views;
};

/// Finds the links of all receivers and allocates their data. `objects`: those of the scene, with
/// positions.
/// GPU thread. @throws std::runtime_error with the figure if a map exceeds the driver's limit.
std::vector<ReposeBuffers> build_repose_buffers(const std::vector<const SceneObject*>& objects,
                                                const SceneBuffers& scene,
                                                const gpu::GpuInfo& info);

}  // namespace snowbough::snow::gl
