#include "snow/movement/movement.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/parallel_for.h"
#include "snow/scene/memory_estimate.h"

namespace snowbough::snow {
namespace {

/// Maps with more active blocks than this may share them among threads; others use one thread each.
constexpr size_t kManyBlocks = 16;
/// Names of planes in checkpoints.
constexpr const char* kMaskPlane = "mask";

}  // namespace

int64_t Movement::memory(const std::vector<const SceneObject*>& objects) {
  // See BareTexels, and where ways end. A coarser map takes less memory than the blocks of
  // the receiver's own, which it replaces.
  constexpr int64_t kPerTexel = 5 * 4 + 2 * 4;
  constexpr int64_t kPerPlace = 4;
  // See Masks, and Pressing::Pressed.
  constexpr int64_t kPerMasked = 3 * 4;
  constexpr int64_t kPerPressed = 3 * 4 + 4 * 4 + 2 * 4 + 1;
  const bool presses = std::any_of(objects.begin(), objects.end(), [](const SceneObject* object) {
    return object->press.kind != PressSettings::Kind::kNone;
  });
  int64_t bytes =
      count_blocks(objects, kReposeBlock) *
      static_cast<int64_t>(sizeof(ReposeTile) + sizeof(std::array<TilePlane, kForwardLinks>));
  for (const SceneObject* object : objects) {
    if (!object->description.receive) continue;
    const int64_t side = object->description.topology.resolution;
    const int64_t per_texel =
        kPerTexel + (object->mask != nullptr ? kPerMasked : 0) + (presses ? kPerPressed : 0);
    bytes +=
        per_texel * static_cast<int64_t>(object->table->texel.size()) + kPerPlace * side * side;
  }
  return bytes;
}

void Movement::lay_out(const std::vector<const SceneObject*>& objects) {
  receivers_.clear();
  targets_.lay_out(objects);
  masks_.lay_out(objects);
  shedding_.lay_out(objects);
  pressing_.lay_out(objects);
  landing_.lay_out(targets_.rays());
  coarse_.lay_out(objects, targets_.rays());
  thaw_.lay_out(objects);
  drift_.lay_out(objects);
  water_.lay_out(targets_.rays());
  sun = rain = {};
  link_tables_ = std::make_unique<ReposeLinkTables>();
  for (const SceneObject* object : objects) {
    receivers_.push_back(object->description.receive
                             ? std::make_unique<Repose>(*object, *link_tables_, &targets_.rays())
                             : nullptr);
  }
}

void Movement::forget_pose(size_t object) {
  pressing_.forget_pose(object);
  coarse_.forget_pose(object);
  water_.forget_pose(object);
  drift_.forget_pose();
  sun = rain = {};
  if (receivers_[object] != nullptr) receivers_[object]->forget_pose();
  targets_.forget_pose(object, [&](size_t near) {
    if (receivers_[near] != nullptr) receivers_[near]->forget_rooms();
    coarse_.forget_rooms(near);
  });
}

/// The maps of receivers that are not hidden in this step.
std::vector<MovingMap*> Movement::shown(std::vector<MovingMap>& maps) const {
  std::vector<MovingMap*> shown;
  for (MovingMap& map : maps) {
    if (!targets_.rays().objects()[map.object]->hidden) shown.push_back(&map);
  }
  return shown;
}

void Movement::before(const MovementSettings& settings, double dt, std::vector<MovingMap>& maps) {
  for (MovingMap* map :
       settings.melt.is_on() && dt > 0.0 ? shown(maps) : std::vector<MovingMap*>()) {
    Repose& repose = *receivers_[map->object];
    const std::vector<float>* const light = sun.of(map->object);
    const std::vector<float>& melted = thaw_.melt(settings.melt, light, *map, repose);
    if (!settings.melt.is_wet) continue;
    water_.flow(settings.melt, dt, melted, light, rain.of(map->object), *map, repose,
                thaw_.runs_of(map->object, repose));
  }
  water_.drip(settings.landing.is_on);
  // Above hidden receivers snow stays in the air.
  for (MovingMap* map : shown(maps)) masks_.begin(*map);
  if (dt > 0.0 && settings.repose.is_on()) {
    landing_.arrive(dt, settings.landing, shown(maps),
                    [&](size_t object) -> Repose& { return *receivers_[object]; });
  }
  if (!settings.drift.is_on()) return;
  std::vector<Drift::Receiver> receivers;
  for (MovingMap* map : shown(maps)) {
    const std::vector<float>& packed = pressing_.packed(*map);
    receivers.push_back({map, receivers_[map->object].get(), packed.empty() ? nullptr : &packed});
  }
  drift_.blow(settings.drift, receivers);
}

void Movement::after(const MovementSettings& settings, uint32_t step_number, double dt,
                     std::vector<MovingMap>& maps) {
  const std::vector<MovingMap*> moving = shown(maps);
  rounds_ = 0.0;
  coarse_.begin_step();
  for (MovingMap* map : moving) {
    masks_.refuse(*map, *receivers_[map->object]);
    shedding_.shed(step_number, dt, *map, *receivers_[map->object]);
  }
  // Without duration nothing is pressed: objects are only put in their places.
  const int parts = dt > 0.0 ? pressing_.begin(moving) : 1;
  const double slope = std::tan(settings.repose.angle);
  for (int part = 1; part <= parts; ++part) {
    if (dt > 0.0) {
      pressing_.move_to(part);
      for (MovingMap* map : moving) pressing_.press(*map, *receivers_[map->object], slope);
    }
    if (part == parts) {
      rest(settings, dt, false, moving);
    } else if (pressing_.rests()) {
      rest(settings, 0.0, true, moving);
    }
  }
  std::vector<FlyingSnow>* const flying = settings.records_flying ? &flying_ : nullptr;
  pressing_.end(step_number, dt, flying);
  for (MovingMap* map : moving) {
    masks_.limit(*map, *receivers_[map->object], settings.max_depth);
  }
  if (settings.landing.is_on && settings.repose.is_on()) {
    landing_.fall(step_number, dt, settings.landing, flying);
  }
}

/// Lets snow come to rest for `dt` seconds, and collects what leaves the maps. `of_blades`: only
/// what blades have just pushed, for some rounds.
void Movement::rest(const MovementSettings& settings, double dt, bool of_blades,
                    const std::vector<MovingMap*>& shown) {
  if (!settings.repose.is_on()) return;
  std::vector<MovingMap*> maps;
  for (MovingMap* map : shown) {
    const bool moves = dt > 0.0 || (of_blades && pressing_.is_pressed(*map));
    if (moves || !map->slid_from.empty() || !map->shed_from.empty()) maps.push_back(map);
  }
  // Coarser maps of many receivers are made side by side.
  base::for_each_item(maps.size(), 1, [&](size_t i) {
    coarse_.choose(*maps[i], settings.repose.is_granular, *link_tables_,
                   *receivers_[maps[i]->object]);
  });
  std::vector<Resting> first;
  std::vector<Resting> then;
  for (MovingMap* map : maps) choose_maps(settings, dt, *map, of_blades, first, then);
  rest_on(settings, dt, of_blades, maps, first);
  if (!then.empty()) rest_on(settings, dt, of_blades, maps, then);
}

/// Chooses the map on which a receiver's snow comes to rest. Near packed snow, whose walls stand,
/// it is the receiver's own, `then`, after the rest of a coarser one.
void Movement::choose_maps(const MovementSettings& settings, double dt, MovingMap& map,
                           bool of_blades, std::vector<Resting>& first,
                           std::vector<Resting>& then) {
  Repose& own = *receivers_[map.object];
  CoarseMap* const coarse = coarse_.choose(map, settings.repose.is_granular, *link_tables_, own);
  const std::vector<int32_t> blades = pressing_.ploughed_blocks(map);
  if (coarse == nullptr) {
    pressing_.set_stand(map, own);
    first.push_back({&map, &own, nullptr, blades});
    return;
  }
  Resting on_squares{&map, &coarse->repose(), coarse};
  Resting near_packed{&map, &own, nullptr};
  if (const std::vector<uint8_t> stands = pressing_.standing_blocks(map, own); !stands.empty()) {
    const std::vector<int32_t> blocks = coarse->blocks_of_own();
    std::vector<int32_t> standing;
    for (size_t b = 0; b < stands.size(); ++b) {
      if (stands[b] != 0) standing.push_back(static_cast<int32_t>(b));
    }
    on_squares.within.assign(coarse->repose().ground().links->block_count(), 1);
    for (const int32_t block : near_blocks(*own.ground().links, standing)) {
      on_squares.within[static_cast<size_t>(blocks[static_cast<size_t>(block)])] = 0;
    }
    for (const int32_t block : blocks) {
      near_packed.within.push_back(on_squares.within[static_cast<size_t>(block)] == 0 ? 1 : 0);
    }
  }
  if (!blades.empty()) {
    const std::vector<int32_t> blocks = coarse->blocks_of_own();
    for (const int32_t block : blades) {
      const bool is_near =
          !near_packed.within.empty() && near_packed.within[static_cast<size_t>(block)] != 0;
      if (is_near)
        near_packed.blades.push_back(block);
      else
        on_squares.blades.push_back(blocks[static_cast<size_t>(block)]);
    }
    std::sort(on_squares.blades.begin(), on_squares.blades.end());
    on_squares.blades.erase(std::unique(on_squares.blades.begin(), on_squares.blades.end()),
                            on_squares.blades.end());
  }
  const bool rests_near_packed =
      !near_packed.within.empty() && (!of_blades || !near_packed.blades.empty());
  if (rests_near_packed) {
    pressing_.set_stand(map, own);
    then.push_back(std::move(near_packed));
  }
  coarse->block(pressing_.under(map));
  std::vector<int32_t> needed;
  if (of_blades) {
    needed = near_blocks(*coarse->repose().ground().links, on_squares.blades);
  } else if (dt == 0.0) {
    needed = coarse->blocks_with_released(map);
  }
  on_squares.coarser = coarse->begin(map, of_blades || dt == 0.0 ? &needed : nullptr);
  first.push_back(std::move(on_squares));
}

/// `all`: the receivers' maps that come to rest now, on these and on others.
void Movement::rest_on(const MovementSettings& settings, double dt, bool of_blades,
                       const std::vector<MovingMap*>& all, std::vector<Resting>& maps) {
  std::vector<double> slid;
  for (Resting& one : maps) slid.push_back(std::exchange(one.own->slid, 0.0));
  if (dt > 0.0 || of_blades) run_repose(settings, static_cast<float>(dt), of_blades, all, maps);
  for (size_t i = 0; i < maps.size(); ++i) {
    Resting& one = maps[i];
    if (settings.landing.is_on)
      landing_.release(settings.landing, one.moved.releases, one.map(), *one.repose);
    if (one.coarse != nullptr) one.coarse->end(one.coarser, *one.own);
    one.own->slid += slid[i];
    one.own->slid_from.clear();
    one.own->shed_from.clear();
  }
}

void Movement::save(SimulationState& state) const {
  state.landing = landing_.state();
  pressing_.save(state);
}

void Movement::save(size_t object, ObjectState& state) const {
  if (std::vector<float> mask = masks_.state(object); !mask.empty()) {
    state.planes[kMaskPlane] = std::move(mask);
  }
  pressing_.save(object, state);
  if (std::vector<float> water = water_.state(object); !water.empty()) {
    state.planes[kWaterPlane] = std::move(water);
  }
}

void Movement::load(const SimulationState& state) {
  landing_.set_state(state.landing);
  pressing_.load(state);
}

void Movement::load(size_t object, const ObjectState& state) {
  const auto plane = [&](const char* name) {
    const auto found = state.planes.find(name);
    return found != state.planes.end() ? &found->second : nullptr;
  };
  masks_.set_state(object, plane(kMaskPlane));
  water_.set_state(object, plane(kWaterPlane));
  pressing_.load(object, state);
}

void Movement::run_repose(const MovementSettings& settings, float dt, bool of_blades,
                          const std::vector<MovingMap*>& all, std::vector<Resting>& maps) {
  const ReposeLimits limits{.slope = static_cast<float>(std::tan(settings.repose.angle)),
                            .cohesion = static_cast<float>(settings.repose.cohesion),
                            .is_granular = settings.repose.is_granular};
  std::vector<size_t> blocks(maps.size(), 0);
  base::for_each_item(maps.size(), 1, [&](size_t i) {
    Resting& one = maps[i];
    blocks[i] =
        one.repose->choose_blocks(*one.map().height, limits, one.blades, of_blades, one.within);
  });
  // Large maps one by one, each on all cores; small ones, and those that are a small part of all,
  // side by side.
  const size_t sum = std::accumulate(blocks.begin(), blocks.end(), size_t{0});
  const size_t many =
      std::max(kManyBlocks, sum / (2 * static_cast<size_t>(base::default_threads())));
  const auto for_maps = [&](const auto& work) {
    std::vector<size_t> small;
    for (size_t i = 0; i < maps.size(); ++i) {
      if (blocks[i] > many) work(maps[i], true);
      if (blocks[i] > 0 && blocks[i] <= many) small.push_back(i);
    }
    base::for_each_item(small.size(), 1, [&](size_t i) { work(maps[small[i]], false); });
  };
  for_maps([&](Resting& one, bool on_all_cores) {
    one.repose->set_up(*one.map().height, on_all_cores);
  });
  // Without landing a receiver's snow must not depend on that of others, so that machines can share
  // a shot. No map changes before all are raised.
  std::vector<const std::vector<float>*> heights(receivers_.size(), nullptr);
  for (const MovingMap* map : all) {
    if (settings.landing.is_on) heights[map->object] = map->height;
  }
  for (const Resting& one : maps) {
    const size_t object = one.own->object;
    const std::vector<float>* const others = heights[object];
    heights[object] = one.own->height;
    targets_.raise(object, *one.repose, heights);
    heights[object] = others;
  }
  for_maps([&](Resting& one, bool on_all_cores) {
    MovingMap& map = one.map();
    one.moved = one.repose->run(*map.height, dt, on_all_cores, settings.landing.is_on);
    map.slid = one.moved.fallen;
    map.has_changed = map.has_changed || one.moved.has_changed;
  });
  for (const Resting& one : maps) rounds_ += one.moved.rounds;
}

}  // namespace snowbough::snow
