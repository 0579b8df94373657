#include "snow/simulation.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <numbers>
#include <stdexcept>

#include "snow/simulation_gpu.h"

namespace snowbough::snow {

namespace {

[[noreturn]] void refuse(const std::string& message) {
  throw std::invalid_argument(message);
}

void check_settings(const SimulationSettings& s) {
  const auto require = [](bool good, const char* message) {
    if (!good) {
      refuse(message);
    }
  };
  require(std::isfinite(s.pixel_size) && s.pixel_size > 0.0, "pixel_size must be over 0 metres");
  require(s.noise_density > 0.0 && s.noise_density <= 1.0,
          "noise_density must be over 0 and at most 1");
  require(s.flutter >= 0.0 && s.flutter <= 45.0, "flutter must be 0 to 45 degrees");
  require(std::isfinite(s.max_depth) && s.max_depth >= 0.0, "max_depth must be 0 metres or more");
  require(std::isfinite(s.slide_half_life) && s.slide_half_life >= 0.0,
          "slide_half_life must be 0 seconds or more");
  require(std::isfinite(s.blur_radius) && s.blur_radius >= 0.0,
          "blur_radius must be 0 metres or more");
  require(s.tile_size >= 64 && s.tile_size <= kBlockSize && (s.tile_size & (s.tile_size - 1)) == 0,
          "tile_size must be a power of two from 64 to 8192");
}

glm::dvec3 unit_fall(const glm::dvec3& direction) {
  const double length = glm::length(direction);
  if (!std::isfinite(length) || length < 1e-12) {
    refuse("direction must be a vector of some length");
  }
  const glm::dvec3 unit = direction / length;
  if (unit.z >= 0.0) {
    refuse("direction must point downwards: its z is " + std::to_string(direction.z));
  }
  return unit;
}

std::vector<SceneObject*> pointers(std::map<std::string, SceneObject>& objects) {
  std::vector<SceneObject*> result;
  for (auto& [name, object] : objects) {
    result.push_back(&object);
  }
  return result;
}

std::vector<const SceneObject*> pointers(const std::map<std::string, SceneObject>& objects) {
  std::vector<const SceneObject*> result;
  for (const auto& [name, object] : objects) {
    result.push_back(&object);
  }
  return result;
}

/// Puts the equal mask among `known` in the place of this one, or adds it to them.
void share(std::shared_ptr<const AlphaMask>& mask,
           std::vector<std::weak_ptr<const AlphaMask>>& known) {
  std::erase_if(known, [](const auto& one) { return one.expired(); });
  for (const std::weak_ptr<const AlphaMask>& one : known) {
    const std::shared_ptr<const AlphaMask> other = one.lock();
    if (*other == *mask) {
      mask = other;
      return;
    }
  }
  known.push_back(mask);
}

/// A map with the texels that the table does not own at zero.
std::vector<float> only_owned(const TexelTable& table, const std::vector<float>& height) {
  std::vector<float> kept(height.size(), 0.0f);
  for (const int32_t texel : table.texel) {
    kept[static_cast<size_t>(texel)] = height[static_cast<size_t>(texel)];
  }
  return kept;
}

}  // namespace

SnowSimulation::SnowSimulation(const SimulationSettings& settings) : settings_(settings) {
  check_settings(settings);
  thread_ = gpu::GpuThread::shared(settings.device);
}

SnowSimulation::~SnowSimulation() {
  close();
}

void SnowSimulation::close() {
  const std::scoped_lock lock(mutex_);
  if (thread_ != nullptr) {
    thread_->run([this] { gpu_.reset(); });
    thread_.reset();
  }
  objects_.clear();
  outputs_.clear();
}

void SnowSimulation::require_open() const {
  if (thread_ == nullptr) {
    throw std::runtime_error("the simulation is closed: make a new SnowSimulation");
  }
}

SceneObject SnowSimulation::make_object(ObjectDescription description) {
  MapTopology& topology = description.topology;
  int32_t highest = -1;
  for (const int32_t index : topology.triangles) {
    if (index < 0) {
      refuse("object '" + description.name + "': a triangle has the vertex index " +
             std::to_string(index));
    }
    highest = std::max(highest, index);
  }
  topology.vertex_count = highest + 1;
  if (!description.rest.empty() && static_cast<int32_t>(description.rest.size()) <= highest) {
    refuse("object '" + description.name + "': rest has " +
           std::to_string(description.rest.size()) + " vertices, a triangle asks for number " +
           std::to_string(highest));
  }
  SceneObject object;
  try {
    if (!description.alpha.empty()) {
      check_alpha(description.alpha, topology.triangles.size() / 3);
    }
    if (description.receive) {
      object.table = build_texel_table(topology);
    }
  } catch (const std::invalid_argument& error) {
    refuse("object '" + description.name + "': " + error.what());
  }
  for (std::shared_ptr<const AlphaMask>& mask : description.alpha.masks) {
    share(mask, masks_);
  }
  object.description = std::move(description);
  return object;
}

void SnowSimulation::set_state_aside() {
  if (scene_is_current_) {
    pending_state_ = read_state();
    scene_is_current_ = false;
  }
}

void SnowSimulation::add_object(ObjectDescription description) {
  const std::scoped_lock lock(mutex_);
  require_open();
  if (objects_.contains(description.name)) {
    refuse("there is already an object named '" + description.name + "'");
  }
  std::string name = description.name;
  SceneObject object = make_object(std::move(description));
  set_state_aside();
  objects_.emplace(std::move(name), std::move(object));
}

void SnowSimulation::replace_object(ObjectDescription description) {
  const std::scoped_lock lock(mutex_);
  require_open();
  const auto found = objects_.find(description.name);
  if (found == objects_.end()) {
    refuse("there is no object named '" + description.name + "' to replace: add_object it first");
  }
  const ObjectDescription& before = found->second.description;
  if (before.receive != description.receive) {
    refuse("object '" + description.name + "' must go on " +
           (before.receive ? "as a receiver" : "without a map") + " when it is replaced");
  }
  if (before.receive && before.topology.resolution != description.topology.resolution) {
    refuse("object '" + description.name + "' must keep its map of " +
           std::to_string(before.topology.resolution) + " texels a side when it is replaced");
  }
  SceneObject object = make_object(std::move(description));
  set_state_aside();
  for (ObjectState& saved : pending_state_.objects) {
    if (saved.name == found->first) {
      saved.height = only_owned(object.table, saved.height);
    }
  }
  outputs_.erase(found->first);
  found->second = std::move(object);
}

void SnowSimulation::take_positions(const PositionMap& positions) {
  // Everything is checked before anything changes.
  for (const auto& [name, points] : positions) {
    const auto found = objects_.find(name);
    if (found == objects_.end()) {
      refuse("step: there is no object named '" + name + "': add_object it first");
    }
    const SceneObject& object = found->second;
    const auto needed = static_cast<size_t>(object.description.topology.vertex_count);
    if (object.positions.empty() ? points.size() < needed
                                 : points.size() != object.positions.size()) {
      refuse("step: object '" + name + "' comes with " + std::to_string(points.size()) +
             " vertices, it has " +
             std::to_string(object.positions.empty() ? needed : object.positions.size()) +
             ": its topology must stay as it was added");
    }
    for (const glm::vec3& point : points) {
      if (!std::isfinite(point.x) || !std::isfinite(point.y) || !std::isfinite(point.z)) {
        refuse("step: object '" + name + "' has a vertex that is not a finite number");
      }
    }
  }
  for (const auto& [name, object] : objects_) {
    if (object.positions.empty() && !positions.contains(name) &&
        object.description.topology.vertex_count > 0) {
      refuse("step: object '" + name + "' has no positions yet: name it in its first step");
    }
  }
  for (const auto& [name, points] : positions) {
    SceneObject& object = objects_.at(name);
    if (object.positions.size() == points.size() &&
        std::memcmp(object.positions.data(), points.data(), points.size_bytes()) == 0) {
      continue;
    }
    if (object.description.receive && object.description.rest.empty()) {
      object.description.rest.assign(points.begin(), points.end());
    }
    object.positions.assign(points.begin(), points.end());
    object.moved = true;
    // Only vertices in use count: stray ones would widen the grid.
    glm::vec3 low(1e30f);
    glm::vec3 high(-1e30f);
    for (const int32_t index : object.description.topology.triangles) {
      const glm::vec3& point = object.positions[static_cast<size_t>(index)];
      low = {std::min(low.x, point.x), std::min(low.y, point.y), std::min(low.z, point.z)};
      high = {std::max(high.x, point.x), std::max(high.y, point.y), std::max(high.z, point.z)};
    }
    object.bounds = Bounds{};
    if (low.x <= high.x) {
      object.bounds.include(glm::dvec3(low));
      object.bounds.include(glm::dvec3(high));
    }
  }
}

void SnowSimulation::build_scene() {
  require_memory(estimate_memory(pointers(std::as_const(objects_)), settings_.tile_size),
                 available_memory(thread_->info()));
  if (gpu_ == nullptr) {
    gpu_ = std::make_unique<Gpu>();
  }
  gpu_->scene = SceneBuffers{};
  gpu_->scene = build_scene_buffers(pointers(std::as_const(objects_)), thread_->info());
  for (auto& [name, object] : objects_) {
    object.moved = true;
  }
  scene_is_current_ = true;
  write_state(pending_state_);
  pending_state_ = {};
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
  FrameStep::Input input;
  input.fall = {unit_fall(direction),
                settings_.pixel_size,
                settings_.flutter * std::numbers::pi / 180.0,
                settings_.noise_density,
                depth,
                settings_.seed,
                step_number_};
  input.stability = {static_cast<float>(settings_.max_depth),
                     static_cast<float>(settings_.slide_half_life)};
  input.dt = dt;
  input.mapping = settings_.mapping;
  input.tile_size = settings_.tile_size;
  take_positions(positions);
  thread_->run([&] {
    if (!scene_is_current_) {
      build_scene();
    }
    gpu_->frame_step.run(pointers(objects_), gpu_->scene, input);
  });
  ++step_number_;
}

const SceneObject& SnowSimulation::find_receiver(const std::string& name) const {
  const auto found = objects_.find(name);
  if (found == objects_.end()) {
    refuse("there is no object named '" + name + "'");
  }
  if (!found->second.description.receive) {
    refuse("object '" + name + "' does not receive snow, so it has no map");
  }
  return found->second;
}

size_t SnowSimulation::index_of(const std::string& name) const {
  return static_cast<size_t>(std::distance(objects_.begin(), objects_.find(name)));
}

int32_t SnowSimulation::resolution(const std::string& name) const {
  const std::scoped_lock lock(mutex_);
  return find_receiver(name).description.topology.resolution;
}

std::vector<std::string> SnowSimulation::receivers() const {
  const std::scoped_lock lock(mutex_);
  std::vector<std::string> names;
  for (const auto& [name, object] : objects_) {
    if (object.description.receive) {
      names.push_back(name);
    }
  }
  return names;
}

std::vector<float> SnowSimulation::height(const std::string& name) {
  const std::scoped_lock lock(mutex_);
  require_open();
  const int32_t resolution = find_receiver(name).description.topology.resolution;
  std::vector<float> heights(static_cast<size_t>(resolution) * static_cast<size_t>(resolution));
  if (scene_is_current_) {
    const size_t object = index_of(name);
    thread_->run([&] {
      const SceneBuffers& scene = gpu_->scene;
      const MapGroup& group = scene.groups[static_cast<size_t>(scene.group[object])];
      group.height.read(scene.slot[object] - group.first_slot, GL_RED, GL_FLOAT,
                        static_cast<int64_t>(heights.size()) * 4, heights.data());
    });
    return heights;
  }
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
  const SceneObject& object = find_receiver(name);
  if (object.positions.empty()) {
    refuse("object '" + name + "' has no positions yet: texel_area is known after its first step");
  }
  // The same sums as the GPU's texel surface pass, without asking it.
  const MapTopology& topology = object.description.topology;
  std::vector<float> triangle_area(static_cast<size_t>(object.triangle_count()));
  for (size_t t = 0; t < triangle_area.size(); ++t) {
    const glm::dvec3 a(object.positions[static_cast<size_t>(topology.triangles[3 * t])]);
    const glm::dvec3 b(object.positions[static_cast<size_t>(topology.triangles[3 * t + 1])]);
    const glm::dvec3 c(object.positions[static_cast<size_t>(topology.triangles[3 * t + 2])]);
    triangle_area[t] = static_cast<float>(0.5 * glm::length(glm::cross(b - a, c - a)));
  }
  const TexelTable& table = object.table;
  std::vector<float> areas(
      static_cast<size_t>(table.resolution) * static_cast<size_t>(table.resolution), 0.0f);
  for (size_t i = 0; i < table.texel.size(); ++i) {
    float area = 0.0f;
    for (int32_t f = table.fragment_begin[i]; f < table.fragment_begin[i + 1]; ++f) {
      const auto fragment = static_cast<size_t>(f);
      area += table.fragment_share[fragment] *
              triangle_area[static_cast<size_t>(table.fragment_triangle[fragment])];
    }
    areas[static_cast<size_t>(table.texel[i])] = area;
  }
  return areas;
}

SnowStatistics SnowSimulation::statistics() {
  const std::scoped_lock lock(mutex_);
  require_open();
  SnowStatistics statistics;
  statistics.step_number = step_number_;
  const SimulationState state = scene_is_current_ ? SimulationState{} : pending_state_;
  std::vector<shared::ObjectSums> sums;
  if (scene_is_current_) {
    sums = thread_->run([&] { return gpu_->scene.sums.read_all<shared::ObjectSums>(); });
  }
  size_t index = 0;
  for (const auto& [name, object] : objects_) {
    const size_t at = index++;
    if (!object.description.receive) {
      continue;
    }
    shared::ObjectSums own{};
    if (scene_is_current_) {
      own = sums[static_cast<size_t>(gpu_->scene.slot[at])];
    }
    for (const ObjectState& saved : state.objects) {
      if (saved.name == name) {
        std::memcpy(&own, saved.sums.data(), sizeof own);
      }
    }
    const StatisticsPair pair = balance_of(own, settings_.pixel_size * settings_.pixel_size);
    statistics.objects[name] = pair;
    add_balance(statistics.all, pair);
  }
  return statistics;
}

MemoryEstimate SnowSimulation::memory_estimate() const {
  const std::scoped_lock lock(mutex_);
  return estimate_memory(pointers(objects_), settings_.tile_size);
}

const gpu::GpuInfo& SnowSimulation::gpu_info() const {
  require_open();
  return thread_->info();
}

SimulationState SnowSimulation::read_state() {
  SimulationState state;
  state.step_number = step_number_;
  thread_->run([&] {
    const SceneBuffers& scene = gpu_->scene;
    const auto sums = scene.sums.read_all<shared::ObjectSums>();
    size_t index = 0;
    for (const auto& [name, object] : objects_) {
      const size_t at = index++;
      if (!object.description.receive) {
        continue;
      }
      ObjectState saved;
      saved.name = name;
      saved.resolution = object.description.topology.resolution;
      saved.height.resize(static_cast<size_t>(saved.resolution) *
                          static_cast<size_t>(saved.resolution));
      const MapGroup& group = scene.groups[static_cast<size_t>(scene.group[at])];
      group.height.read(scene.slot[at] - group.first_slot, GL_RED, GL_FLOAT,
                        static_cast<int64_t>(saved.height.size()) * 4, saved.height.data());
      std::memcpy(saved.sums.data(), &sums[static_cast<size_t>(scene.slot[at])],
                  sizeof(shared::ObjectSums));
      state.objects.push_back(std::move(saved));
    }
  });
  return state;
}

void SnowSimulation::write_state(const SimulationState& state) {
  SceneBuffers& scene = gpu_->scene;
  for (const ObjectState& saved : state.objects) {
    const size_t at = index_of(saved.name);
    MapGroup& group = scene.groups[static_cast<size_t>(scene.group[at])];
    const int32_t slot = scene.slot[at];
    group.height.write(slot - group.first_slot, GL_RED, GL_FLOAT, saved.height.data());
    scene.sums.write(int64_t{slot} * static_cast<int64_t>(sizeof(shared::ObjectSums)),
                     sizeof(shared::ObjectSums), saved.sums.data());
  }
}

SimulationState SnowSimulation::state() {
  const std::scoped_lock lock(mutex_);
  require_open();
  SimulationState state = scene_is_current_ ? read_state() : pending_state_;
  state.step_number = step_number_;
  return state;
}

void SnowSimulation::set_state(const SimulationState& state) {
  const std::scoped_lock lock(mutex_);
  require_open();
  size_t receivers = 0;
  for (const auto& [name, object] : objects_) {
    receivers += object.description.receive ? 1 : 0;
  }
  for (const ObjectState& saved : state.objects) {
    const int32_t resolution = find_receiver(saved.name).description.topology.resolution;
    if (saved.resolution != resolution) {
      refuse("the checkpoint's map of '" + saved.name + "' has " +
             std::to_string(saved.resolution) + " texels a side, the object has " +
             std::to_string(resolution));
    }
  }
  if (state.objects.size() != receivers) {
    refuse("the checkpoint holds " + std::to_string(state.objects.size()) +
           " receivers, the simulation has " + std::to_string(receivers));
  }
  step_number_ = state.step_number;
  if (scene_is_current_) {
    thread_->run([&] { write_state(state); });
  } else {
    pending_state_ = state;
  }
}

}  // namespace snowbough::snow
