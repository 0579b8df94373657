#include "snow/simulation.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <stdexcept>
#include <utility>

#include "base/thread_pool.h"
#include "gpu/thread_texture.h"
#include "snow/engine_scene.h"

namespace snowbough::snow {

namespace {

void check_settings(const SimulationSettings& settings) {
  for (const NumberSetting& one : kNumberSettings) {
    const double value = settings.*one.field;
    if (!(value >= one.least && value <= one.most)) {
      throw std::invalid_argument(std::string(one.name) + " must be " + one.range);
    }
  }
  if (settings.tile_size < 64 || settings.tile_size > kLargestTile ||
      !std::has_single_bit(static_cast<uint32_t>(settings.tile_size))) {
    throw std::invalid_argument("tile_size must be a power of two from 64 to 4096");
  }
}

glm::dvec3 unit_fall(const glm::dvec3& direction) {
  const double length = glm::length(direction);
  if (!std::isfinite(length) || length < 1e-12) {
    throw std::invalid_argument("direction must not be zero");
  }
  const glm::dvec3 unit = direction / length;
  if (unit.z >= 0.0) {
    throw std::invalid_argument("direction must point downwards: its z is " +
                                std::to_string(direction.z));
  }
  return unit;
}

/// Seconds that a fall takes at most in a step with `depth` metres of new snow. A shot in which the
/// snow grows shows hours in seconds, so that falls are as quick as all else.
double longest_fall(bool takes_time, double depth, double dt) {
  constexpr double kGrowthMeanwhile = 0.01;
  if (!takes_time) return 0.0;
  return depth > 0.0 ? kGrowthMeanwhile * dt / depth : std::numeric_limits<double>::infinity();
}

/// Water in metres as a part of what soaks in, 0 to 1.
std::vector<float> wetness(std::vector<float> water, double soak) {
  for (float& own : water) own = std::min(own / static_cast<float>(soak), 1.0f);
  return water;
}

}  // namespace

SnowSimulation::SnowSimulation(const SimulationSettings& settings)
    : settings_(settings), outputs_(settings.blur_radius) {
  check_settings(settings);
  base::start_thread_pool();
  scene_ = std::make_unique<EngineScene>(settings.engine, objects_);
  if (settings.wait_for_gpu) scene_->engine();
}

SnowSimulation::~SnowSimulation() {
  close();
}

void SnowSimulation::close() {
  const std::scoped_lock lock(mutex_);
  scene_.reset();
  outputs_.clear();
  objects_.clear();
}

EngineScene& SnowSimulation::scene() const {
  if (scene_ == nullptr) {
    throw std::runtime_error("the simulation is closed: make a new SnowSimulation");
  }
  return *scene_;
}

void SnowSimulation::add_object(ObjectDescription description) {
  const std::scoped_lock lock(mutex_);
  EngineScene& scene = this->scene();
  std::shared_ptr<SceneObject> object = objects_.make(std::move(description));
  scene.set_aside();
  objects_.put(std::move(object));
}

void SnowSimulation::replace_object(ObjectDescription description) {
  const std::scoped_lock lock(mutex_);
  EngineScene& scene = this->scene();
  std::shared_ptr<SceneObject> object = objects_.make_replacement(std::move(description));
  scene.set_aside();
  scene.keep_owned(*object);
  outputs_.forget(object->description.name);
  const SceneObject& before = *objects_.by_name().at(object->description.name);
  object->press = before.press;
  object->shed_half_life = before.shed_half_life;
  objects_.put(std::move(object));
}

void SnowSimulation::step(const PositionMap& positions, double depth, const glm::dvec3& direction,
                          double dt, const std::set<std::string>& hidden, const glm::dvec3& sun,
                          const glm::dvec2& wind) {
  const std::scoped_lock lock(mutex_);
  EngineScene& scene = this->scene();
  if (!std::isfinite(depth)) {
    throw std::invalid_argument("step: depth must be a finite number of metres");
  }
  const double shines = glm::length(sun);
  if (!std::isfinite(shines)) {
    throw std::invalid_argument("step: sun must be three finite numbers");
  }
  const double blows = glm::length(wind);
  if (!std::isfinite(blows)) {
    throw std::invalid_argument("step: wind must be two finite numbers");
  }
  if (!std::isfinite(dt) || dt < 0.0) {
    throw std::invalid_argument("step: dt must be 0 seconds or more");
  }
  const glm::dvec3 fall = unit_fall(direction);
  FrameStep frame{
      .fall = {.direction = fall,
               .pixel_size = settings_.pixel_size,
               .flutter = settings_.flutter,
               .noise_density = settings_.noise_density,
               .depth = std::max(depth, 0.0),
               .seed = settings_.seed,
               .step_number = step_number_},
      .stability = {.max_depth = static_cast<float>(settings_.max_depth),
                    .half_life = static_cast<float>(settings_.slide_half_life),
                    .adhesion = static_cast<float>(settings_.adhesion)},
      .movement = {.repose = {.angle = settings_.repose,
                              .cohesion = settings_.cohesion,
                              .is_granular = settings_.granular},
                   .landing = {.is_on = settings_.landing,
                               .throw_speed = settings_.throw_speed,
                               .spread = settings_.spread,
                               .heap_grain = settings_.heap_grain,
                               .longest_fall = longest_fall(settings_.fall_time, depth, dt)},
                   .max_depth = static_cast<float>(settings_.max_depth),
                   .melt = {.depth = std::max(-depth, 0.0),
                            .rain = settings_.rain * dt,
                            .sun_share = shines > 0.0 ? settings_.sun_share : 0.0,
                            .unevenness = settings_.unevenness,
                            .density = settings_.density,
                            .is_wet = settings_.wet,
                            .soak = settings_.soak,
                            .wet_spread = settings_.wet_spread,
                            .drying = settings_.drying},
                   .drift = {.wind = blows > 0.0 ? wind / blows : glm::dvec2(0.0),
                             .flux = settings_.drift * dt},
                   .records_flying = settings_.points},
      .sun = shines > 0.0 ? sun / shines : glm::dvec3(0.0),
      .dt = dt,
      .tile_size = settings_.tile_size};
  objects_.set_positions(positions, hidden);
  if (settings_.rising > 0.0 && depth > 0.0) {
    FrameStep from_below = frame;
    from_below.fall.direction.z = -fall.z;
    from_below.fall.depth = depth * settings_.rising;
    from_below.dt = 0.0;
    scene.run_step(from_below);
  }
  scene.run_step(frame);
  ++step_number_;
}

std::map<std::string, std::vector<FlyingSnow>> SnowSimulation::take_flying() {
  const std::scoped_lock lock(mutex_);
  std::map<std::string, std::vector<FlyingSnow>> by_name;
  const std::vector<const SceneObject*> objects = objects_.all();
  for (const FlyingSnow& snow : scene().take_flying()) {
    by_name[objects[static_cast<size_t>(snow.object)]->description.name].push_back(snow);
  }
  return by_name;
}

void SnowSimulation::change_settings(const SimulationSettings& settings) {
  const std::scoped_lock lock(mutex_);
  scene();
  SimulationSettings changed = settings;
  for (const NumberSetting& one : kNumberSettings) {
    if (!one.can_change) changed.*one.field = settings_.*one.field;
  }
  changed.tile_size = settings_.tile_size;
  changed.engine = settings_.engine;
  check_settings(changed);
  settings_ = std::move(changed);
}

void SnowSimulation::set_mask(const std::string& name, const SnowMask& mask) {
  const std::scoped_lock lock(mutex_);
  scene();
  SceneObject& object = *objects_.receiver(name);
  if (mask.empty()) {
    object.mask.reset();
    return;
  }
  const auto triangles = static_cast<size_t>(object.triangle_count());
  std::vector<float> weights = texel_weights(mask, *object.table, triangles);
  object.mask = std::make_shared<const std::vector<float>>(std::move(weights));
}

void SnowSimulation::set_shed_half_life(const std::string& name, double half_life) {
  const std::scoped_lock lock(mutex_);
  scene();
  if (!std::isfinite(half_life) || half_life < 0.0) {
    throw std::invalid_argument("shed_half_life must be 0 seconds or more");
  }
  objects_.receiver(name)->shed_half_life = half_life;
}

void SnowSimulation::set_presser(const std::string& name, const PressSettings& settings) {
  const std::scoped_lock lock(mutex_);
  scene();
  const auto found = objects_.by_name().find(name);
  if (found == objects_.by_name().end()) {
    throw std::invalid_argument("there is no object '" + name + "'");
  }
  const auto check = [](bool is_right, const std::string& what) {
    if (!is_right) throw std::invalid_argument(what);
  };
  check(settings.packed_density >= kFreshDensity && settings.packed_density <= 917.0,
        "packed_density must be 100 to 917 kg/m3");
  check(settings.pushed_aside >= 0.0 && settings.pushed_aside <= 1.0,
        "pushed_aside must be 0 to 1");
  check(settings.rim_width >= 0.0 && settings.rim_width <= 100.0,
        "rim_width must be 0 to 100 metres");
  check(settings.walls_stand >= 0.0 && settings.walls_stand <= 100.0,
        "walls_stand must be 0 to 100 metres");
  found->second->press = settings;
}

void SnowSimulation::set_blur_radius(const std::string& name, double blur_radius) {
  const std::scoped_lock lock(mutex_);
  scene();
  outputs_.set_blur_radius(*objects_.receiver(name), blur_radius);
}

int32_t SnowSimulation::resolution(const std::string& name) const {
  const std::scoped_lock lock(mutex_);
  return objects_.receiver(name)->description.topology.resolution;
}

std::vector<float> SnowSimulation::stored_height(const std::string& name) {
  const auto edge = static_cast<size_t>(objects_.receiver(name)->description.topology.resolution);
  std::vector<float> heights(edge * edge);
  scene().read_height(name, heights);
  return heights;
}

std::vector<float> SnowSimulation::height(const std::string& name) {
  const std::scoped_lock lock(mutex_);
  scene();
  return stored_height(name);
}

MapOutput SnowSimulation::output(const std::string& name) {
  return snapshot(name).output();
}

OutputSnapshot SnowSimulation::snapshot(const std::string& name, const MapRequest& maps) {
  const std::scoped_lock lock(mutex_);
  scene();
  const std::shared_ptr<SceneObject>& object = objects_.stepped_receiver(name);
  std::vector<float> water;
  if (settings_.wet && maps.wet) water = scene().water(name);
  return outputs_.snapshot(object, maps, stored_height(name),
                           wetness(std::move(water), settings_.soak));
}

std::shared_ptr<const gpu::ThreadTexture> SnowSimulation::live_output(const std::string& name) {
  const std::scoped_lock lock(mutex_);
  EngineScene& scene = this->scene();
  const std::shared_ptr<SceneObject>& object = objects_.stepped_receiver(name);
  if (!scene.is_current() || scene.engine().kind() != EngineKind::kGl) return nullptr;
  const SeamTable& seams = outputs_.seams(object);
  const size_t index = objects_.index_of(name);
  std::shared_ptr<const gpu::ThreadTexture> made;
  scene.engine().run([&] {
    made = scene.engine().live_output(index, *object, seams, outputs_.blur_radius(*object));
  });
  return made;
}

void SnowSimulation::prepare_output(const std::string& name) {
  const std::scoped_lock lock(mutex_);
  scene();
  outputs_.prepare(objects_.receiver(name));
}

std::vector<float> SnowSimulation::texel_area(const std::string& name) {
  const std::scoped_lock lock(mutex_);
  scene();
  const SceneObject& object = *objects_.receiver(name);
  if (object.positions.empty()) {
    throw std::invalid_argument(
        "object '" + name + "' has no positions yet: texel_area is available after its first step");
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
  EngineScene& scene = this->scene();
  SnowStatistics statistics;
  statistics.step_number = step_number_;
  const LandingState landing = scene.landing();
  for (const FallingSnow& snow : landing.air) {
    statistics.air_volume += static_cast<double>(snow.units) * kLandingUnit;
  }
  statistics.floor_volume = static_cast<double>(landing.on_floors) * kLandingUnit;
  statistics.left_volume = static_cast<double>(landing.left) * kLandingUnit;
  for (const std::string& name : objects_.receivers()) {
    const StatisticsPair pair = balance_of(scene.read_sums(name));
    statistics.objects[name] = pair;
    add_balance(statistics.all, pair);
  }
  return statistics;
}

MemoryEstimate SnowSimulation::memory_estimate() {
  const std::scoped_lock lock(mutex_);
  return scene().memory(settings_.tile_size, ReposeSettings{.angle = settings_.repose}.is_on());
}

EngineInfo SnowSimulation::engine_info() {
  const std::scoped_lock lock(mutex_);
  const Engine& now = scene().engine();
  return {engine_name(now.kind()), now.driver(), scene().reason()};
}

void SnowSimulation::measure_passes(bool on) {
  const std::scoped_lock lock(mutex_);
  Engine& engine = scene().engine();
  engine.run([&] { engine.measure_passes(on); });
}

std::vector<PassCost> SnowSimulation::take_costs() {
  const std::scoped_lock lock(mutex_);
  Engine& engine = scene().engine();
  std::vector<PassCost> costs;
  engine.run([&] { costs = engine.take_costs(); });
  return costs;
}

void SnowSimulation::hash_passes(bool on) {
  const std::scoped_lock lock(mutex_);
  scene().hash_passes(on);
}

std::vector<PassHash> SnowSimulation::take_hashes() {
  const std::scoped_lock lock(mutex_);
  return scene().take_hashes();
}

SimulationState SnowSimulation::state() {
  const std::scoped_lock lock(mutex_);
  SimulationState state = scene().state();
  state.step_number = step_number_;
  return state;
}

void SnowSimulation::set_state(const SimulationState& state) {
  const std::scoped_lock lock(mutex_);
  scene().set_state(state);
  step_number_ = state.step_number;
}

}  // namespace snowbough::snow
