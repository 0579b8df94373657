#include "snow/movement/repose_pass.h"

#include <cmath>

#include "base/parallel_for.h"
#include "snow/scene/memory_estimate.h"

namespace snowbough::snow {
namespace {

/// Maps with more active blocks than this share them among threads; others use one thread each.
constexpr size_t kManyBlocks = 16;

}  // namespace

int64_t ReposePass::memory(const std::vector<const SceneObject*>& objects) {
  return count_blocks(objects, kReposeBlock) *
         static_cast<int64_t>(sizeof(ReposeTile) + sizeof(std::array<TilePlane, kForwardLinks>));
}

void ReposePass::lay_out(const std::vector<const SceneObject*>& objects) {
  receivers_.clear();
  link_tables_ = std::make_unique<ReposeLinkTables>();
  for (const SceneObject* object : objects) {
    receivers_.push_back(
        object->description.receive ? std::make_unique<Repose>(*object, *link_tables_) : nullptr);
  }
}

void ReposePass::forget_pose(size_t object) {
  if (receivers_[object] != nullptr) receivers_[object]->forget_pose();
}

void ReposePass::run_map(MovingMap& map, float dt, bool on_all_cores) {
  Repose& repose = *receivers_[map.object];
  map.slid = repose.run(*map.height, dt, on_all_cores);
  map.has_changed = repose.has_changed();
}

void ReposePass::run(const ReposeSettings& settings, float dt, std::vector<MovingMap>& maps) {
  if (!settings.is_on() || !(dt > 0.0f)) return;
  const ReposeLimits limits{.slope = static_cast<float>(std::tan(settings.angle)),
                            .cohesion = static_cast<float>(settings.cohesion)};
  std::vector<size_t> blocks(maps.size(), 0);
  base::for_each_item(maps.size(), 1, [&](size_t i) {
    blocks[i] = receivers_[maps[i].object]->choose_blocks(*maps[i].height, limits);
  });
  std::vector<size_t> small;
  for (size_t i = 0; i < maps.size(); ++i) {
    if (blocks[i] > kManyBlocks) run_map(maps[i], dt, true);
    if (blocks[i] > 0 && blocks[i] <= kManyBlocks) small.push_back(i);
  }
  base::for_each_item(small.size(), 1, [&](size_t i) { run_map(maps[small[i]], dt, false); });
}

}  // namespace snowbough::snow
