#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "gpu/buffer_writer.h"
#include "snow/scene/group_triangles.h"
#include "snow/step/gl/scene_buffers.h"

namespace snowbough::snow {

/// Splits a map group's texels into batches, object by object, and uploads them. GPU thread.
class BatchWriter {
 public:
  /// The data that will follow.
  struct Plan {
    int32_t group = 0;
    /// Whole work groups of texels per object.
    size_t texel_count = 0;
    size_t fragment_count = 0;
    /// Whether one of the objects has a fragment_opacity.
    bool has_opacity = false;
  };

  BatchWriter(SceneBuffers& scene, const Plan& plan)
      : scene_(scene),
        group_(plan.group),
        has_opacity_(plan.has_opacity),
        texels_left_(plan.texel_count),
        fragments_left_(plan.fragment_count) {}

  /// An object's texels share a batch unless they fill one alone: batch ends, and so the results of
  /// the passes, then depend on the object only.
  void begin_object(int32_t slot, size_t texel_count, size_t fragment_count);
  /// Adds the object's next texels: those of its table that `order` lists, one work group of them,
  /// or fewer at the end. Their triangles and places on the map group begin at these numbers.
  void add_group(const SceneObject& object, std::span<const int32_t> order, uint32_t first_triangle,
                 uint32_t first_place);
  void end_object();

  /// The triangles of the work groups, in the order of the groups.
  GroupTriangles& triangles() { return triangles_; }

  /// Uploads the rest, and the triangles of the groups.
  void finish();

 private:
  /// A batch's texels before their upload.
  struct Arrays {
    gpu::BufferWriter<uint32_t> places;
    gpu::BufferWriter<uint32_t> fragment_begin;
    gpu::BufferWriter<shared::Fragment> fragments;
    gpu::BufferWriter<float> opacity;
    std::vector<shared::StatisticsSegment> segments;
  };

  /// `first_fragments`: of the first work group, which may exceed a batch's limit.
  void open_batch(size_t first_fragments);
  void flush();
  static TexelBatch upload(Arrays&& arrays, int32_t group, int32_t first);
  void upload_group_triangles(TexelBatch& batch) const;
  int32_t in_batch() const { return static_cast<int32_t>(arrays_.places.size()); }
  void open_segment();
  void close_segment();

  SceneBuffers& scene_;
  int32_t group_;
  bool has_opacity_;
  int32_t first_ = 0;
  int32_t slot_ = -1;
  int32_t segment_begin_ = 0;
  /// Still to be added.
  size_t texels_left_;
  size_t fragments_left_;
  Arrays arrays_;
  GroupTriangles triangles_;
};

}  // namespace snowbough::snow
