#include "render/draw/work_list.h"

namespace snowbough::render {

void WorkList::clear() {
  ranges_.clear();
  groups_ = 0;
}

void WorkList::add(int32_t instance, int32_t first_item, int32_t count) {
  if (count == 0) return;
  ranges_.push_back({static_cast<int32_t>(slots()), instance, first_item, count});
  groups_ += gpu::group_count(count, static_cast<int32_t>(shared::kPatchGroup));
}

int32_t WorkList::count_of(int32_t instance) const {
  for (const shared::WorkRange& range : ranges_) {
    if (range.instance == instance) return range.count;
  }
  return 0;
}

void WorkList::bind(gpu::Program& program) {
  buffer_.update(ranges_);
  program.bind("WorkRanges", buffer_.buffer());
  program.set("range_count", static_cast<int32_t>(ranges_.size()));
}

void WorkList::dispatch(gpu::Program& program) {
  bind(program);
  program.dispatch_items(slots(), static_cast<int32_t>(shared::kPatchGroup));
}

}  // namespace snowbough::render
