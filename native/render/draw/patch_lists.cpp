#include "render/draw/patch_lists.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "gpu/gl_context.h"
#include "shaders/lib/tree_shared.h"

namespace snowbough::render {
namespace {

/// Number of work groups per dimension that OpenGL guarantees.
constexpr size_t kMostGroups = 65535;
/// Mesa's software renderers use 16-bit indices for the tessellated vertices of a draw.
constexpr int32_t kSoftwareVertices = 65535;
/// Highest tessellation level that OpenGL guarantees.
constexpr float kHighestLevel = 64.0f;

/// Most patches per draw on a software renderer at this tessellation level. Fractional odd spacing
/// rounds the number of segments up to an odd number.
int32_t software_patches(float max_level) {
  const auto parts = static_cast<int32_t>(std::ceil(max_level)) | 1;
  return kSoftwareVertices / ((parts + 1) * (parts + 1));
}

int64_t bytes_of(size_t count, size_t size) {
  return static_cast<int64_t>(count * size);
}

size_t patch_groups(size_t patches) {
  return (patches + shared::kPatchGroup - 1) / shared::kPatchGroup;
}

}  // namespace

PatchList::PatchList(size_t patches)
    : patch_count(static_cast<int32_t>(patches)),
      classes(bytes_of(patches, sizeof(uint32_t))),
      group_counts(bytes_of(patch_groups(patches), 2 * sizeof(uint32_t))),
      plain(bytes_of(patches, sizeof(uint32_t))),
      tessellated(bytes_of(patches, sizeof(uint32_t))),
      commands(bytes_of(2 + patches / software_patches(kHighestLevel),
                        sizeof(shared::TreeDrawCommand))) {
  if (patch_groups(patches) > kMostGroups) {
    throw std::invalid_argument("an object has " + std::to_string(patches) +
                                " patches, more than one draw can hold: add it in parts");
  }
}

void PatchListPasses::run(gpu::Program& classify, PatchList& list, int32_t plain_vertices,
                          float max_level) {
  const auto groups = static_cast<int32_t>(patch_groups(static_cast<size_t>(list.patch_count)));
  classify.bind("PatchClasses", list.classes);
  classify.bind("GroupCounts", list.group_counts);
  classify.set("count", list.patch_count);
  classify.dispatch(groups);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);

  const int32_t patches_a_draw = gpu::renders_in_software()
                                     ? std::min(list.patch_count, software_patches(max_level))
                                     : list.patch_count;
  list.draws = gpu::group_count(list.patch_count, patches_a_draw);
  offsets_.use();
  offsets_.bind("GroupCounts", list.group_counts);
  offsets_.bind("DrawCommands", list.commands);
  offsets_.set("count", groups);
  offsets_.set("draws", list.draws);
  offsets_.set("plain_vertices", plain_vertices);
  offsets_.set("patches_a_draw", patches_a_draw);
  offsets_.dispatch(1);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);

  lists_.use();
  lists_.bind("PatchClasses", list.classes);
  lists_.bind("GroupCounts", list.group_counts);
  lists_.bind("PlainPatches", list.plain);
  lists_.bind("TessellatedPatches", list.tessellated);
  lists_.set("count", list.patch_count);
  lists_.dispatch(groups);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_COMMAND_BARRIER_BIT |
                  GL_BUFFER_UPDATE_BARRIER_BIT);
}

PatchCounts count_patches(const PatchList& list, int32_t plain_vertices) {
  const auto commands = list.commands.read_all<shared::TreeDrawCommand>();
  PatchCounts counts;
  counts.plain = commands[0].count / plain_vertices;
  for (int32_t i = 1; i <= list.draws; ++i) counts.tessellated += commands[i].count;
  counts.dropped = list.patch_count - counts.plain - counts.tessellated;
  return counts;
}

}  // namespace snowbough::render
