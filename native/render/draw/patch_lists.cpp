#include "render/draw/patch_lists.h"

#include <algorithm>
#include <cmath>

#include "gpu/gl_context.h"

namespace snowbough::render {
namespace {

using shared::TreeDrawCommand;

/// Mesa's software renderers use 16-bit indices for the tessellated vertices of a draw.
constexpr int32_t kSoftwareVertices = 65535;

/// Most patches per draw on a software renderer at this tessellation level. Fractional odd spacing
/// rounds the number of segments up to an odd number.
int32_t software_patches(float max_level) {
  const auto parts = static_cast<int32_t>(std::ceil(max_level)) | 1;
  return kSoftwareVertices / ((parts + 1) * (parts + 1));
}

constexpr auto kCommandBytes = static_cast<int64_t>(sizeof(TreeDrawCommand));

}  // namespace

void PatchList::clear() {
  work_.clear();
  batches_.clear();
  batch_patches_.clear();
  begun_ = 0;
}

void PatchList::add(int32_t instance, int32_t first_item, int32_t count) {
  work_.add(instance, first_item, count);
  begun_ += count;
}

void PatchList::end_batch() {
  const int32_t first = batches_.empty() ? 0 : batches_.back().end_group;
  batches_.push_back({first, work_.groups(), 0, 0});
  batch_patches_.push_back(begun_);
  begun_ = 0;
}

void PatchList::draw_plain(gpu::Program& program, int32_t begin, int32_t end) const {
  program.draw_indirect(GL_TRIANGLES, commands_, begin * kCommandBytes, end - begin);
}

void PatchList::draw_tessellated(gpu::Program& program, int32_t begin, int32_t end) const {
  const shared::DrawBatch& last = batches_[static_cast<size_t>(end) - 1];
  const int32_t first = batches_[static_cast<size_t>(begin)].first_draw;
  glPatchParameteri(GL_PATCH_VERTICES, 1);
  program.draw_indirect(GL_PATCHES, commands_, first * kCommandBytes,
                        last.first_draw + last.draws - first);
}

void PatchListPasses::run(gpu::Program& classify, PatchList& list, int32_t plain_vertices,
                          float max_level) {
  const int32_t groups = list.work_.groups();
  const auto pairs = static_cast<int64_t>(sizeof(glm::ivec2));
  const bool in_parts = max_level > 0.0f && gpu::renders_in_software();
  const int32_t patches_a_draw = in_parts ? software_patches(max_level) : int32_t{1} << 30;
  int32_t commands = list.batch_count();
  for (size_t b = 0; b < list.batches_.size(); ++b) {
    shared::DrawBatch& batch = list.batches_[b];
    batch.first_draw = commands;
    batch.draws = max_level > 0.0f ? gpu::group_count(list.batch_patches_[b], patches_a_draw) : 0;
    commands += batch.draws;
  }
  make_room(list.classes_, list.work_.slots() * static_cast<int64_t>(sizeof(uint32_t)));
  make_room(list.group_counts_, (groups + 1) * pairs);
  make_room(list.plain_, list.work_.slots() * pairs);
  if (max_level > 0.0f) make_room(list.tessellated_, list.work_.slots() * pairs);
  make_room(list.commands_, commands * kCommandBytes);
  list.batch_buffer_.update(list.batches_);

  classify.bind("PatchClasses", list.classes_);
  classify.bind("GroupCounts", list.group_counts_);
  classify.set("groups", groups);
  list.work_.dispatch(classify);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);

  offsets_.use();
  offsets_.bind("GroupCounts", list.group_counts_);
  offsets_.bind("DrawBatches", list.batch_buffer_.buffer());
  offsets_.bind("DrawCommands", list.commands_);
  offsets_.set("count", groups);
  offsets_.set("batch_count", list.batch_count());
  offsets_.set("plain_vertices", plain_vertices);
  offsets_.set("patches_a_draw", patches_a_draw);
  offsets_.dispatch(1);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);

  lists_.use();
  lists_.bind("PatchClasses", list.classes_);
  lists_.bind("GroupCounts", list.group_counts_);
  lists_.bind("PlainPatches", list.plain_);
  lists_.bind("TessellatedPatches", list.tessellated_);
  list.work_.dispatch(lists_);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_COMMAND_BARRIER_BIT |
                  GL_BUFFER_UPDATE_BARRIER_BIT);
}

PatchCounts count_patches(const PatchList& list, int32_t plain_vertices) {
  PatchCounts counts;
  if (list.is_empty()) return counts;
  const auto commands = list.commands().read_all<TreeDrawCommand>();
  const auto batches = static_cast<size_t>(list.batch_count());
  for (size_t b = 0; b < batches; ++b) counts.plain += commands[b].count / plain_vertices;
  for (size_t i = batches; i < static_cast<size_t>(list.command_count()); ++i) {
    counts.tessellated += commands[i].count;
  }
  return counts;
}

}  // namespace snowbough::render
