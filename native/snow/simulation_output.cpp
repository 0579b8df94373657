// Output of a simulation: smoothed maps.
#include <cmath>
#include <stdexcept>
#include <utility>

#include "gpu/thread_texture.h"
#include "snow/simulation.h"
#include "snow/step/choose_engine.h"

namespace snowbough::snow {
double SnowSimulation::blur_radius_of(const SceneObject& receiver) const {
  const double own = receiver.description.blur_radius;
  return own < 0.0 ? settings_.blur_radius : own;
}

void SnowSimulation::prepare_output(const std::string& name) {
  const std::scoped_lock lock(mutex_);
  require_open();
  const std::shared_ptr<SceneObject>& object = find_receiver(name);
  if (object->description.rest.empty()) {
    throw std::invalid_argument("object '" + name +
                                "' has no rest pose yet: prepare its output after its first step");
  }
  outputs_.begin(object, blur_radius_of(*object));
}

void SnowSimulation::set_blur_radius(const std::string& name, double blur_radius) {
  const std::scoped_lock lock(mutex_);
  require_open();
  find_receiver(name);
  if (!std::isfinite(blur_radius) || blur_radius < 0.0) {
    throw std::invalid_argument("object '" + name + "': blur_radius must be 0 metres or more");
  }
  SceneObject& object = *objects_.at(name);
  if (blur_radius == blur_radius_of(object)) return;
  object.description.blur_radius = blur_radius;
  outputs_.forget(name);
}

const std::shared_ptr<SceneObject>& SnowSimulation::find_stepped_receiver(
    const std::string& name) const {
  const std::shared_ptr<SceneObject>& object = find_receiver(name);
  if (object->positions.empty()) {
    throw std::invalid_argument("object '" + name +
                                "' has no positions yet: output is available after its first step");
  }
  return object;
}

MapOutput OutputSnapshot::output() {
  if (filter_ == nullptr) {
    throw std::runtime_error("output() of this snapshot was already called: take a new snapshot");
  }
  const std::shared_ptr<OutputFilter> filter = std::move(filter_);
  return filter->run(std::move(stored_), surface_);
}

MapOutput SnowSimulation::output(const std::string& name, const MapRequest& maps) {
  return snapshot(name, maps).output();
}

OutputSnapshot SnowSimulation::snapshot(const std::string& name, const MapRequest& maps) {
  const std::scoped_lock lock(mutex_);
  require_open();
  const std::shared_ptr<SceneObject>& object = find_stepped_receiver(name);
  const MapTopology& topology = object->description.topology;
  OutputSnapshot snapshot;
  snapshot.resolution_ = topology.resolution;
  snapshot.filter_ = outputs_.get(object, blur_radius_of(*object));
  if (object->layers == nullptr) {
    object->layers = std::make_shared<const std::vector<LayerTerms>>(
        layer_terms(topology.triangles, object->description.shading, object->positions));
  }
  snapshot.surface_.layers = object->layers;
  snapshot.surface_.maps = maps;
  if (maps != MapRequest{}) {
    const std::vector<glm::vec3> positions(object->positions.begin(),
                                           object->positions.begin() + topology.vertex_count);
    snapshot.surface_.metrics = surface_metrics(topology, positions);
  }
  snapshot.stored_ = stored_height(name);
  snapshot.memory_ = map_memory_;
  return snapshot;
}

std::shared_ptr<const gpu::ThreadTexture> SnowSimulation::live_output(const std::string& name) {
  const std::scoped_lock lock(mutex_);
  require_open();
  const std::shared_ptr<SceneObject>& object = find_stepped_receiver(name);
  if (!scene_is_current_ || engine().kind() != EngineKind::kGl) return nullptr;
  const double blur_radius = blur_radius_of(*object);
  const SeamTable& seams = outputs_.get(object, blur_radius)->seams();
  const size_t index = index_of(name);
  std::shared_ptr<const gpu::ThreadTexture> made;
  engine().run([&] { made = engine().live_output(index, *object, seams, blur_radius); });
  return made;
}

void SnowSimulation::measure_passes(bool on) {
  const std::scoped_lock lock(mutex_);
  engine().run([&] { engine().measure_passes(on); });
}

void SnowSimulation::hash_passes(bool on) {
  const std::scoped_lock lock(mutex_);
  hashes_passes_ = on;
}

std::vector<PassHash> SnowSimulation::take_hashes() {
  const std::scoped_lock lock(mutex_);
  return std::exchange(hashes_, {});
}

std::vector<PassCost> SnowSimulation::take_costs() {
  const std::scoped_lock lock(mutex_);
  std::vector<PassCost> costs;
  engine().run([&] { costs = engine().take_costs(); });
  return costs;
}

}  // namespace snowbough::snow
