#include "snow/simulation.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <stdexcept>

#include "base/thread_pool.h"
#include "snow/repose/pass.h"
#include "snow/step/choose_engine.h"
#include "snow/step/frame_step.h"

namespace snowbough::snow {

namespace {

[[noreturn]] void refuse(const std::string& message) {
  throw std::invalid_argument(message);
}

void check_settings(const SimulationSettings& settings) {
  for (const NumberSetting& one : kNumberSettings) {
    const double value = settings.*one.field;
    if (!(value >= one.least && value <= one.most)) {
      refuse(std::string(one.name) + " must be " + one.range);
    }
  }
  if (settings.tile_size < 64 || settings.tile_size > kLargestTile ||
      !std::has_single_bit(static_cast<uint32_t>(settings.tile_size))) {
    refuse("tile_size must be a power of two from 64 to 4096");
  }
}

glm::dvec3 unit_fall(const glm::dvec3& direction) {
  const double length = glm::length(direction);
  if (!std::isfinite(length) || length < 1e-12) {
    refuse("direction must not be zero");
  }
  const glm::dvec3 unit = direction / length;
  if (unit.z >= 0.0) {
    refuse("direction must point downwards: its z is " + std::to_string(direction.z));
  }
  return unit;
}

}  // namespace

SnowSimulation::SnowSimulation(const SimulationSettings& settings) : settings_(settings) {
  check_settings(settings);
  base::start_thread_pool();
  choice_ = std::make_unique<EngineChoice>(
      EngineRequest{settings.engine, settings.mapping, settings.device});
  if (settings.wait_for_gpu) choice_->engine();
}

SnowSimulation::~SnowSimulation() {
  close();
}

void SnowSimulation::close() {
  const std::scoped_lock lock(mutex_);
  choice_.reset();
  outputs_.clear();
  objects_.clear();
}

void SnowSimulation::require_open() const {
  if (choice_ == nullptr) {
    throw std::runtime_error("the simulation is closed: make a new SnowSimulation");
  }
}

std::vector<const SceneObject*> SnowSimulation::all_objects() const {
  std::vector<const SceneObject*> result;
  for (const auto& [name, object] : objects_) {
    result.push_back(object.get());
  }
  return result;
}

Engine& SnowSimulation::engine() {
  require_open();
  return choice_->engine();
}

void SnowSimulation::build_scene() {
  Engine& engine = choice_->engine();
  require_memory(estimate(), engine.free_memory());
  engine.build_scene(all_objects());
  for (auto& [name, object] : objects_) {
    object->moved = true;
  }
  scene_is_current_ = true;
  write_state(pending_state_);
}

void SnowSimulation::step_on(Engine& engine, const FrameStep& step) {
  engine.run([&] {
    if (!scene_is_current_) {
      build_scene();
    }
    std::vector<SceneObject*> objects;
    for (auto& [name, object] : objects_) {
      objects.push_back(object.get());
    }
    run_step(engine, objects, step, hashes_passes_ ? &hashes_ : nullptr);
  });
  pending_state_ = {};
  choice_->commit();
}

void SnowSimulation::step(const PositionMap& positions, double depth, const glm::dvec3& direction,
                          double dt) {
  const std::scoped_lock lock(mutex_);
  require_open();
  if (!std::isfinite(depth) || depth < 0.0) {
    refuse("step: depth must be 0 metres or more");
  }
  if (!std::isfinite(dt) || dt < 0.0) {
    refuse("step: dt must be 0 seconds or more");
  }
  const FrameStep frame{.fall = {.direction = unit_fall(direction),
                                 .pixel_size = settings_.pixel_size,
                                 .flutter = settings_.flutter,
                                 .noise_density = settings_.noise_density,
                                 .depth = depth,
                                 .seed = settings_.seed,
                                 .step_number = step_number_},
                        .stability = {.max_depth = static_cast<float>(settings_.max_depth),
                                      .half_life = static_cast<float>(settings_.slide_half_life)},
                        .repose = {.angle = settings_.repose, .cohesion = settings_.cohesion},
                        .dt = dt,
                        .tile_size = settings_.tile_size};
  set_positions(positions);
  try {
    step_on(engine(), frame);
  } catch (const std::runtime_error& error) {
    if (!choice_->may_fall_back()) throw;
    scene_is_current_ = false;
    step_on(choice_->fall_back(error.what()), frame);
  }
  ++step_number_;
}

void SnowSimulation::change_settings(const SimulationSettings& settings) {
  const std::scoped_lock lock(mutex_);
  require_open();
  SimulationSettings changed = settings;
  for (const NumberSetting& one : kNumberSettings) {
    if (!one.can_change) changed.*one.field = settings_.*one.field;
  }
  changed.mapping = settings_.mapping;
  changed.tile_size = settings_.tile_size;
  changed.engine = settings_.engine;
  changed.device = settings_.device;
  check_settings(changed);
  settings_ = std::move(changed);
}

const std::shared_ptr<SceneObject>& SnowSimulation::find_receiver(const std::string& name) const {
  const auto found = objects_.find(name);
  if (found == objects_.end()) {
    refuse("there is no object named '" + name + "'");
  }
  if (!found->second->description.receive) {
    refuse("object '" + name + "' does not receive snow, so it has no map");
  }
  return found->second;
}

size_t SnowSimulation::index_of(const std::string& name) const {
  return static_cast<size_t>(std::distance(objects_.begin(), objects_.find(name)));
}

int32_t SnowSimulation::resolution(const std::string& name) const {
  const std::scoped_lock lock(mutex_);
  return find_receiver(name)->description.topology.resolution;
}

std::vector<std::string> SnowSimulation::receivers() const {
  const std::scoped_lock lock(mutex_);
  std::vector<std::string> names;
  for (const auto& [name, object] : objects_) {
    if (object->description.receive) {
      names.push_back(name);
    }
  }
  return names;
}

std::vector<float> SnowSimulation::height(const std::string& name) {
  const std::scoped_lock lock(mutex_);
  require_open();
  return stored_height(name);
}

std::vector<float> SnowSimulation::stored_height(const std::string& name) {
  const int32_t resolution = find_receiver(name)->description.topology.resolution;
  std::vector<float> heights =
      map_memory_->take(static_cast<size_t>(resolution) * static_cast<size_t>(resolution));
  if (scene_is_current_) {
    const size_t object = index_of(name);
    engine().run([&] { choice_->engine().read_height(object, heights); });
    return heights;
  }
  std::fill(heights.begin(), heights.end(), 0.0f);
  for (const ObjectState& object : pending_state_.objects) {
    if (object.name == name) {
      heights = object.height;
    }
  }
  return heights;
}

std::vector<float> SnowSimulation::texel_area(const std::string& name) {
  const std::scoped_lock lock(mutex_);
  require_open();
  const SceneObject& object = *find_receiver(name);
  if (object.positions.empty()) {
    refuse("object '" + name +
           "' has no positions yet: texel_area is available after its first step");
  }
  const TexelTable& table = *object.table;
  const std::vector<float> owned =
      texel_areas(object.description.topology, table, object.positions);
  std::vector<float> areas(
      static_cast<size_t>(table.resolution) * static_cast<size_t>(table.resolution), 0.0f);
  for (size_t i = 0; i < owned.size(); ++i) areas[static_cast<size_t>(table.texel[i])] = owned[i];
  return areas;
}

SnowStatistics SnowSimulation::statistics() {
  const std::scoped_lock lock(mutex_);
  require_open();
  SnowStatistics statistics;
  statistics.step_number = step_number_;
  const SimulationState state = scene_is_current_ ? SimulationState{} : pending_state_;
  size_t index = 0;
  for (const auto& [name, object] : objects_) {
    const size_t at = index++;
    if (!object->description.receive) {
      continue;
    }
    shared::ObjectSums own{};
    if (scene_is_current_) {
      choice_->engine().run([&] { own = choice_->engine().read_sums(at); });
    }
    for (const ObjectState& saved : state.objects) {
      if (saved.name == name) {
        std::memcpy(&own, saved.sums.data(), sizeof own);
      }
    }
    const StatisticsPair pair = balance_of(own);
    statistics.objects[name] = pair;
    add_balance(statistics.all, pair);
  }
  return statistics;
}

MemoryEstimate SnowSimulation::memory_estimate() const {
  const std::scoped_lock lock(mutex_);
  return estimate();
}

MemoryEstimate SnowSimulation::estimate() const {
  const std::vector<const SceneObject*> objects = all_objects();
  MemoryEstimate result =
      estimate_memory(objects, settings_.tile_size, settings_.mapping == DepositMapping::kGeometry);
  if (ReposeSettings{.angle = settings_.repose}.is_on())
    result.repose = ReposePass::memory(objects);
  return result;
}

EngineInfo SnowSimulation::engine_info() {
  const std::scoped_lock lock(mutex_);
  const Engine& now = engine();
  return {engine_name(now.kind()), now.driver(), choice_->reason()};
}

SimulationState SnowSimulation::read_state() {
  SimulationState state;
  state.step_number = step_number_;
  Engine& engine = choice_->engine();
  engine.run([&] {
    size_t index = 0;
    for (const auto& [name, object] : objects_) {
      const size_t at = index++;
      if (!object->description.receive) {
        continue;
      }
      ObjectState saved;
      saved.name = name;
      saved.resolution = object->description.topology.resolution;
      engine.read_height(at, saved.height);
      const shared::ObjectSums sums = engine.read_sums(at);
      std::memcpy(saved.sums.data(), &sums, sizeof sums);
      state.objects.push_back(std::move(saved));
    }
  });
  return state;
}

void SnowSimulation::write_state(const SimulationState& state) {
  Engine& engine = choice_->engine();
  for (const ObjectState& saved : state.objects) {
    const size_t at = index_of(saved.name);
    engine.write_height(at, saved.height);
    shared::ObjectSums sums;
    std::memcpy(&sums, saved.sums.data(), sizeof sums);
    engine.write_sums(at, sums);
  }
}

SimulationState SnowSimulation::state() {
  const std::scoped_lock lock(mutex_);
  require_open();
  SimulationState state = scene_is_current_ ? read_state() : pending_state_;
  state.step_number = step_number_;
  return state;
}

void SnowSimulation::check_map(const std::string& name, int32_t resolution) const {
  const int32_t own = find_receiver(name)->description.topology.resolution;
  if (resolution != own) {
    refuse("the checkpoint's map of '" + name + "' has " + std::to_string(resolution) +
           " texels per side, the object has " + std::to_string(own));
  }
}

void SnowSimulation::set_state(const SimulationState& state) {
  const std::scoped_lock lock(mutex_);
  require_open();
  size_t receivers = 0;
  for (const auto& [name, object] : objects_) {
    receivers += object->description.receive ? 1 : 0;
  }
  const auto finite = [](auto number) { return std::isfinite(number); };
  for (const ObjectState& saved : state.objects) {
    check_map(saved.name, saved.resolution);
    if (!std::all_of(saved.height.begin(), saved.height.end(), finite) ||
        !std::all_of(saved.sums.begin(), saved.sums.end(), finite)) {
      refuse("the checkpoint's map or sums of '" + saved.name + "' are not finite numbers");
    }
  }
  if (state.objects.size() != receivers) {
    refuse("the checkpoint holds " + std::to_string(state.objects.size()) +
           " receivers, the simulation has " + std::to_string(receivers));
  }
  step_number_ = state.step_number;
  if (scene_is_current_) {
    choice_->engine().run([&] { write_state(state); });
  } else {
    pending_state_ = state;
  }
}

}  // namespace snowbough::snow
