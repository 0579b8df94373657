#include "snow/engine_scene.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "snow/step/frame_step.h"

namespace snowbough::snow {
namespace {

shared::ObjectSums sums_of(const ObjectState& saved) {
  shared::ObjectSums sums;
  std::memcpy(&sums, saved.sums.data(), sizeof sums);
  return sums;
}

void check_finite(const ObjectState& saved) {
  const auto finite = [](auto number) { return std::isfinite(number); };
  if (!std::all_of(saved.height.begin(), saved.height.end(), finite) ||
      !std::all_of(saved.sums.begin(), saved.sums.end(), finite)) {
    throw std::invalid_argument("the checkpoint's map or sums of '" + saved.name +
                                "' are not finite numbers");
  }
  for (const auto& [name, plane] : saved.planes) {
    if (plane.size() != saved.height.size() || !std::all_of(plane.begin(), plane.end(), finite)) {
      throw std::invalid_argument(
          "the checkpoint's plane '" + name + "' of '" + saved.name +
          "' has another size than its map, or numbers that are not finite");
    }
  }
}

}  // namespace

MemoryEstimate EngineScene::memory(int32_t tile_size, bool moves_snow) {
  const std::vector<const SceneObject*> objects = objects_.all();
  MemoryEstimate estimate = engine().memory(objects, tile_size);
  if (moves_snow) estimate.repose = Movement::memory(objects);
  return estimate;
}

void EngineScene::build(const FrameStep& step) {
  const std::vector<const SceneObject*> objects = objects_.all();
  require_memory(memory(step.tile_size, step.moves_snow()), engine().free_memory());
  engine().build_scene(objects);
  movement_.lay_out(objects);
  for (const auto& [name, object] : objects_.by_name()) object->moved = true;
  is_current_ = true;
  write_state(pending_);
}

void EngineScene::run_on(Engine& engine, const FrameStep& step) {
  engine.run([&] {
    if (!is_current_) build(step);
    std::vector<SceneObject*> objects;
    for (const auto& [name, object] : objects_.by_name()) objects.push_back(object.get());
    snow::run_step(engine, movement_, objects, step, hashes_passes_ ? &hashes_ : nullptr);
  });
  pending_ = {};
  choice_.commit();
}

void EngineScene::run_step(const FrameStep& step) {
  try {
    run_on(engine(), step);
  } catch (const std::runtime_error& error) {
    if (!choice_.may_fall_back()) throw;
    is_current_ = false;
    run_on(choice_.fall_back(error.what()), step);
  }
}

void EngineScene::set_aside() {
  if (!is_current_) return;
  pending_ = state();
  is_current_ = false;
}

void EngineScene::keep_owned(const SceneObject& replacement) {
  for (ObjectState& saved : pending_.objects) {
    if (saved.name != replacement.description.name) continue;
    const auto keep = [&](std::vector<float>& values) {
      std::vector<float> kept(values.size(), 0.0f);
      for (const int32_t texel : replacement.table->texel) {
        kept[static_cast<size_t>(texel)] = values[static_cast<size_t>(texel)];
      }
      values = std::move(kept);
    };
    keep(saved.height);
    for (auto& [name, plane] : saved.planes) keep(plane);
  }
}

const ObjectState* EngineScene::pending(const std::string& receiver) const {
  for (const ObjectState& saved : pending_.objects) {
    if (saved.name == receiver) return &saved;
  }
  return nullptr;
}

void EngineScene::read_height(const std::string& receiver, std::vector<float>& height) {
  if (is_current_) {
    engine().run([&] { engine().read_height(objects_.index_of(receiver), height); });
  } else if (const ObjectState* saved = pending(receiver)) {
    height = saved->height;
  } else {
    std::fill(height.begin(), height.end(), 0.0f);
  }
}

std::vector<float> EngineScene::water(const std::string& receiver) {
  const auto side =
      static_cast<size_t>(objects_.receiver(receiver)->description.topology.resolution);
  std::vector<float> water;
  if (is_current_) {
    water = movement_.water(objects_.index_of(receiver));
  } else if (const ObjectState* saved = pending(receiver)) {
    const auto plane = saved->planes.find(kWaterPlane);
    if (plane != saved->planes.end()) water = plane->second;
  }
  water.resize(side * side, 0.0f);
  return water;
}

shared::ObjectSums EngineScene::read_sums(const std::string& receiver) {
  shared::ObjectSums sums{};
  if (is_current_) {
    engine().run([&] { sums = engine().read_sums(objects_.index_of(receiver)); });
  } else if (const ObjectState* saved = pending(receiver)) {
    sums = sums_of(*saved);
  }
  return sums;
}

SimulationState EngineScene::state() {
  if (!is_current_) return pending_;
  SimulationState state;
  movement_.save(state);
  engine().run([&] {
    for (const std::string& name : objects_.receivers()) {
      ObjectState saved;
      saved.name = name;
      saved.resolution = objects_.receiver(name)->description.topology.resolution;
      const size_t at = objects_.index_of(name);
      engine().read_height(at, saved.height);
      const shared::ObjectSums sums = engine().read_sums(at);
      std::memcpy(saved.sums.data(), &sums, sizeof sums);
      movement_.save(at, saved);
      state.objects.push_back(std::move(saved));
    }
  });
  return state;
}

void EngineScene::write_state(const SimulationState& state) {
  movement_.load(state);
  for (const ObjectState& saved : state.objects) {
    const size_t at = objects_.index_of(saved.name);
    engine().write_height(at, saved.height);
    engine().write_sums(at, sums_of(saved));
    movement_.load(at, saved);
  }
}

void EngineScene::set_state(const SimulationState& state) {
  for (const ObjectState& saved : state.objects) {
    const int32_t own = objects_.receiver(saved.name)->description.topology.resolution;
    if (saved.resolution != own) {
      throw std::invalid_argument("the checkpoint's map of '" + saved.name + "' has " +
                                  std::to_string(saved.resolution) +
                                  " texels per side, the object has " + std::to_string(own));
    }
    check_finite(saved);
  }
  for (const FallingSnow& snow : state.landing.air) {
    const int64_t side = objects_.receiver(snow.receiver)->description.topology.resolution;
    if (snow.place < 0 || snow.place >= side * side || snow.units < 0) {
      throw std::invalid_argument("the checkpoint's snow in the air above '" + snow.receiver +
                                  "' has a place outside of its map, or a negative volume");
    }
  }
  const size_t receivers = objects_.receivers().size();
  if (state.objects.size() != receivers) {
    throw std::invalid_argument("the checkpoint holds " + std::to_string(state.objects.size()) +
                                " receivers, the simulation has " + std::to_string(receivers));
  }
  if (is_current_) {
    engine().run([&] { write_state(state); });
  } else {
    pending_ = state;
  }
}

}  // namespace snowbough::snow
