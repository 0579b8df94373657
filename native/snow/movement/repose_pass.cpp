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
  targets_.lay_out(objects);
  link_tables_ = std::make_unique<ReposeLinkTables>();
  for (const SceneObject* object : objects) {
    receivers_.push_back(object->description.receive ? std::make_unique<Repose>(
                                                           *object, *link_tables_, &targets_.rays())
                                                     : nullptr);
  }
}

void ReposePass::forget_pose(size_t object) {
  if (receivers_[object] != nullptr) receivers_[object]->forget_pose();
  targets_.forget_pose(object, [&](size_t near) {
    if (receivers_[near] != nullptr) receivers_[near]->forget_rooms();
  });
}

void ReposePass::run(const ReposeSettings& settings, float dt, std::vector<MovingMap>& maps) {
  if (!settings.is_on() || !(dt > 0.0f)) return;
  const ReposeLimits limits{.slope = static_cast<float>(std::tan(settings.angle)),
                            .cohesion = static_cast<float>(settings.cohesion)};
  std::vector<size_t> blocks(maps.size(), 0);
  base::for_each_item(maps.size(), 1, [&](size_t i) {
    blocks[i] = receivers_[maps[i].object]->choose_blocks(*maps[i].height, limits);
  });
  // Large maps one by one, each on all cores; small ones side by side.
  const auto for_maps = [&](const auto& work) {
    std::vector<size_t> small;
    for (size_t i = 0; i < maps.size(); ++i) {
      if (blocks[i] > kManyBlocks) work(maps[i], true);
      if (blocks[i] > 0 && blocks[i] <= kManyBlocks) small.push_back(i);
    }
    base::for_each_item(small.size(), 1, [&](size_t i) { work(maps[small[i]], false); });
  };
  for_maps([&](const MovingMap& map, bool on_all_cores) {
    receivers_[map.object]->set_up(*map.height, on_all_cores);
  });
  // Every map is raised by the others' heights before any of them changes.
  std::vector<const std::vector<float>*> heights(receivers_.size(), nullptr);
  for (const MovingMap& map : maps) heights[map.object] = map.height;
  for (const MovingMap& map : maps) targets_.raise(map.object, *receivers_[map.object], heights);
  for_maps([&](MovingMap& map, bool) {
    Repose& repose = *receivers_[map.object];
    map.slid = repose.run(*map.height, dt);
    map.has_changed = repose.has_changed();
  });
}

}  // namespace snowbough::snow
