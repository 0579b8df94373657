#pragma once

#include <cstdint>
#include <vector>

#include "gpu/program.h"
#include "render/draw/cached_buffer.h"
#include "shaders/lib/tree_shared.h"

namespace snowbough::render {

/// The items of all instances that one dispatch works on, see shaders/glsl/work_range.glsl.
class WorkList {
 public:
  void clear();
  /// Adds successive items of an instance.
  void add(int32_t instance, int32_t first_item, int32_t count);

  const std::vector<shared::WorkRange>& ranges() const { return ranges_; }
  /// Number of an instance's items; 0 if it has none.
  int32_t count_of(int32_t instance) const;
  int32_t groups() const { return groups_; }
  /// Number of slots: each range is filled up to whole work groups.
  int64_t slots() const { return int64_t{groups_} * shared::kPatchGroup; }
  bool is_empty() const { return groups_ == 0; }

  /// Binds the ranges to a program that is in use, and uploads them if they have changed.
  void bind(gpu::Program& program);
  /// Binds the ranges and runs the program on all items.
  void dispatch(gpu::Program& program);

 private:
  std::vector<shared::WorkRange> ranges_;
  int32_t groups_ = 0;
  CachedBuffer<shared::WorkRange> buffer_;
};

}  // namespace snowbough::render
