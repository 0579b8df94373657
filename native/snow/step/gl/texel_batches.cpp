#include "snow/step/gl/texel_batches.h"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

namespace snowbough::snow {
namespace {

using shared::kTexelGroup;

/// Maximum number of fragments per batch: 112 of llvmpipe's 128 MiB.
constexpr size_t kBatchFragments = size_t{7} << 20;

/// All groups, until the first step chooses.
std::vector<uint32_t> list_of_all_groups(int32_t count) {
  const auto all = static_cast<uint32_t>(count);
  const shared::GroupListHeader header{{shared::kBlocksAGroup, all, 1, 0}, {1, all, 1, 0}};
  const auto words = std::bit_cast<std::array<uint32_t, shared::kGroupListBegin>>(header);
  std::vector<uint32_t> list(words.begin(), words.end());
  for (uint32_t group = 0; group < all; ++group) {
    list.push_back(group);
  }
  return list;
}

}  // namespace

void BatchWriter::open_batch(size_t first_fragments) {
  const size_t texels = std::min(texels_left_, static_cast<size_t>(kBatchTexels));
  const size_t fragments = std::max(std::min(fragments_left_, kBatchFragments), first_fragments);
  arrays_.places = gpu::BufferWriter<uint32_t>(texels);
  arrays_.fragment_begin = gpu::BufferWriter<uint32_t>(texels + 1);
  arrays_.fragments = gpu::BufferWriter<shared::Fragment>(fragments + 1);
  if (has_opacity_) arrays_.opacity = gpu::BufferWriter<float>(fragments + 1);
}

void BatchWriter::begin_object(int32_t slot, size_t texel_count, size_t fragment_count) {
  if (static_cast<size_t>(in_batch()) + texel_count > static_cast<size_t>(kBatchTexels) ||
      arrays_.fragments.size() + fragment_count > kBatchFragments) {
    flush();
  }
  slot_ = slot;
  open_segment();
}

void BatchWriter::add_group(const SceneObject& object, std::span<const int32_t> order,
                            uint32_t first_triangle, uint32_t first_place) {
  const TexelTable& table = *object.table;
  size_t own_fragments = 0;
  for (const int32_t index : order) {
    const auto i = static_cast<size_t>(index);
    own_fragments += static_cast<size_t>(table.fragment_begin[i + 1] - table.fragment_begin[i]);
  }
  if (in_batch() == kBatchTexels ||
      (in_batch() > 0 && arrays_.fragments.size() + own_fragments > kBatchFragments)) {
    flush();
    open_segment();
  }
  if (in_batch() == 0) open_batch(own_fragments);
  auto fragment_count = static_cast<uint32_t>(arrays_.fragments.size());
  uint32_t* place = arrays_.places.add(order.size());
  uint32_t* begin = arrays_.fragment_begin.add(order.size());
  shared::Fragment* fragment = arrays_.fragments.add(own_fragments);
  if (has_opacity_) {
    float* opacity = arrays_.opacity.add(own_fragments);
    for (const int32_t index : order) {
      const int32_t* begin_of = &table.fragment_begin[static_cast<size_t>(index)];
      for (int32_t f = begin_of[0]; f < begin_of[1]; ++f) {
        *opacity++ = object.fragment_opacity.empty()
                         ? 1.0f
                         : object.fragment_opacity[static_cast<size_t>(f)];
      }
    }
  }
  texels_left_ -= order.size();
  fragments_left_ -= own_fragments;
  for (const int32_t index : order) {
    const auto i = static_cast<size_t>(index);
    *place++ = static_cast<uint32_t>(table.texel[i]) + first_place;
    *begin++ = fragment_count;
    fragment_count += static_cast<uint32_t>(table.fragment_begin[i + 1] - table.fragment_begin[i]);
  }
  for (const int32_t index : order) {
    const auto i = static_cast<size_t>(index);
    const auto end = static_cast<size_t>(table.fragment_begin[i + 1]);
    for (auto f = static_cast<size_t>(table.fragment_begin[i]); f < end; ++f) {
      const glm::vec2 weights = table.fragment_barycentric[f];
      *fragment++ = {static_cast<uint32_t>(table.fragment_triangle[f]) + first_triangle,
                     table.fragment_share[f], weights.x, weights.y};
    }
  }
}

void BatchWriter::end_object() {
  for (; in_batch() % kTexelGroup != 0; --texels_left_) {
    *arrays_.fragment_begin.add(1) = static_cast<uint32_t>(arrays_.fragments.size());
    *arrays_.places.add(1) = shared::kNowhere;
  }
  close_segment();
  slot_ = -1;
}

void BatchWriter::open_segment() {
  segment_begin_ = in_batch() / static_cast<int32_t>(kTexelGroup);
}

void BatchWriter::close_segment() {
  const int32_t end = in_batch() / static_cast<int32_t>(kTexelGroup);
  if (end > segment_begin_) {
    arrays_.segments.push_back({static_cast<uint32_t>(slot_), static_cast<uint32_t>(segment_begin_),
                                static_cast<uint32_t>(end - segment_begin_), 0});
  }
}

TexelBatch BatchWriter::upload(Arrays&& arrays, int32_t group, int32_t first) {
  TexelBatch batch;
  batch.group = group;
  batch.first = first;
  batch.count = static_cast<int32_t>(arrays.places.size());
  *arrays.fragment_begin.add(1) = static_cast<uint32_t>(arrays.fragments.size());
  // The padding of a work group has no fragments, but shaders/glsl/texel_fragments.glsl reads one.
  *arrays.fragments.add(1) = {0, 0.0f, 0.0f, 0.0f};
  batch.places = arrays.places.into_buffer();
  batch.fragment_begin = arrays.fragment_begin.into_buffer();
  batch.fragments = arrays.fragments.into_buffer();
  if (arrays.opacity.size() > 0) {
    batch.fragment_opacity = arrays.opacity.into_buffer();
    batch.views.fragment_opacity = gpu::BufferTexture(batch.fragment_opacity, GL_R32F);
  }
  batch.segment_buffer = gpu::Buffer(arrays.segments);
  batch.segments = std::move(arrays.segments);
  const int64_t count = batch.count;
  batch.steps = gpu::Buffer(count * static_cast<int64_t>(sizeof(shared::TexelStep)));
  batch.partials = gpu::Buffer(count / kTexelGroup * shared::kMaxLocalSize * 16);
  std::vector<uint32_t> group_slots(static_cast<size_t>(count / kTexelGroup), 0);
  for (const shared::StatisticsSegment& segment : batch.segments) {
    std::fill_n(group_slots.begin() + segment.first_group, segment.group_count, segment.slot);
  }
  batch.group_slots = gpu::Buffer(group_slots);
  batch.group_states = gpu::Buffer(
      std::vector<uint32_t>(static_cast<size_t>(batch.group_count()), shared::kHoldsSnow));
  batch.active_groups = gpu::Buffer(list_of_all_groups(batch.group_count()));
  batch.views.active_groups = gpu::BufferTexture(batch.active_groups, GL_R32UI);
  batch.views.places = gpu::BufferTexture(batch.places, GL_R32UI);
  batch.views.fragment_begin = gpu::BufferTexture(batch.fragment_begin, GL_R32UI);
  batch.views.fragments = gpu::BufferTexture(batch.fragments, GL_RGBA32UI);
  batch.views.steps = gpu::BufferTexture(batch.steps, GL_RGBA32UI);
  batch.views.group_slots = gpu::BufferTexture(batch.group_slots, GL_R32UI);
  return batch;
}

void BatchWriter::flush() {
  if (slot_ >= 0) {
    close_segment();
  }
  if (in_batch() > 0) {
    const int32_t end = first_ + in_batch();
    scene_.batches.push_back(upload(std::move(arrays_), group_, first_));
    arrays_ = {};
    first_ = end;
  }
}

void BatchWriter::upload_group_triangles(TexelBatch& batch) const {
  const auto first = triangles_.begin.begin() + batch.first / static_cast<int32_t>(kTexelGroup);
  std::vector<uint32_t> begin(first, first + batch.group_count() + 1);
  const std::vector<uint32_t> own(triangles_.triangles.begin() + begin.front(),
                                  triangles_.triangles.begin() + begin.back());
  for (uint32_t& place : begin) place -= first[0];
  batch.group_begin = gpu::Buffer(begin);
  batch.group_triangles = gpu::Buffer(own);
  batch.views.group_begin = gpu::BufferTexture(batch.group_begin, GL_R32UI);
  batch.views.group_triangles = gpu::BufferTexture(batch.group_triangles, GL_R32UI);
}

void BatchWriter::finish() {
  flush();
  for (TexelBatch& batch : scene_.batches) {
    if (batch.group == group_) {
      upload_group_triangles(batch);
    }
  }
}

}  // namespace snowbough::snow
