// Output of a simulation: smoothed maps and checkpoints.
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <sstream>
#include <stdexcept>

#include "gpu/thread_texture.h"
#include "snow/simulation.h"
#include "snow/state/checkpoint.h"
#include "snow/step/choose_engine.h"

namespace snowbough::snow {
namespace {

/// FNV-1a, 64 bits. Source: G. Fowler, L. C. Noll, K.-P. Vo, public domain.
uint64_t digest(const void* data, size_t bytes, uint64_t hash = 0xcbf29ce484222325ull) {
  const auto* byte = static_cast<const unsigned char*>(data);
  for (size_t i = 0; i < bytes; ++i) {
    hash = (hash ^ byte[i]) * 0x100000001b3ull;
  }
  return hash;
}

std::string hexadecimal(uint64_t value) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(value));
  return text;
}

/// Exact and independent of the locale.
std::string number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%a", value);
  return text;
}

/// Lines "name=value" of everything that affects the bits of the result.
std::string describe(const SimulationSettings& s,
                     const std::map<std::string, std::shared_ptr<SceneObject>>& objects,
                     const Engine& engine) {
  std::string text;
  text += "pixel_size=" + number(s.pixel_size) + "\n";
  text += "noise_density=" + number(s.noise_density) + "\n";
  // Older checkpoints hold `flutter` in degrees; 0 is the same in both.
  text += (s.flutter > 0.0 ? "flutter in radians=" : "flutter=") + number(s.flutter) + "\n";
  text += "max_depth=" + number(s.max_depth) + "\n";
  text += "slide_half_life=" + number(s.slide_half_life) + "\n";
  text += "repose=" + number(s.repose) + "\n";
  if (s.cohesion > 0.0) text += "cohesion=" + number(s.cohesion) + "\n";
  text += "seed=" + std::to_string(s.seed) + "\n";
  text += std::string("mapping=") +
          (s.mapping == DepositMapping::kCompute ? "COMPUTE" : "GEOMETRY") + "\n";
  // Older checkpoints of the scattered deposit lack this line.
  text += "deposit=gathered\n";
  text += "driver=" + engine.name() + ", " + engine.driver() + "\n";
  for (const auto& [name, object] : objects) {
    const MapTopology& topology = object->description.topology;
    uint64_t hash = digest(topology.triangles.data(), topology.triangles.size() * 4);
    if (object->description.receive) {
      hash = digest(topology.corner_uv.data(), topology.corner_uv.size() * 8, hash);
    }
    const ObjectDescription& own = object->description;
    if (own.receive) {
      hash = digest(own.shading.data(), own.shading.size() * 4, hash);
      hash = digest(&own.sides, sizeof own.sides, hash);
    }
    const ObjectAlpha& alpha = own.alpha;
    if (!alpha.empty()) {
      hash = digest(alpha.corner_uv.data(), alpha.corner_uv.size() * 8, hash);
      hash = digest(alpha.mask.data(), alpha.mask.size() * 4, hash);
      for (const std::shared_ptr<const AlphaMask>& mask : alpha.masks) {
        const std::array<uint32_t, 3> shape{static_cast<uint32_t>(mask->width),
                                            static_cast<uint32_t>(mask->height), mask->extension};
        hash = digest(shape.data(), sizeof shape, hash);
        hash = digest(mask->bits.data(), mask->bits.size() * 4, hash);
      }
    }
    text += "object '" + name + "'=" +
            (object->description.receive ? std::to_string(topology.resolution) : "occludes") + " " +
            hexadecimal(hash) + "\n";
  }
  return text;
}

std::map<std::string, std::string> lines_of(const std::string& text) {
  std::map<std::string, std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    const size_t sign = line.rfind('=');
    lines[line.substr(0, sign)] = sign == std::string::npos ? "" : line.substr(sign + 1);
  }
  return lines;
}

/// The names that differ between two descriptions, except the driver if `any_driver`.
std::string differences(const std::string& one, const std::string& other, bool any_driver) {
  const auto a = lines_of(one);
  const auto b = lines_of(other);
  std::string names;
  const auto add = [&](const std::string& name) {
    if (!(any_driver && name == "driver")) {
      names += (names.empty() ? "" : ", ") + name;
    }
  };
  for (const auto& [name, value] : a) {
    const auto found = b.find(name);
    if (found == b.end() || found->second != value) {
      add(name);
    }
  }
  for (const auto& [name, value] : b) {
    if (!a.contains(name)) {
      add(name);
    }
  }
  return names;
}

}  // namespace

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

MapOutput SnowSimulation::output(const std::string& name, bool with_normals) {
  return snapshot(name, with_normals).output();
}

OutputSnapshot SnowSimulation::snapshot(const std::string& name, bool with_normals) {
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
  if (with_normals) {
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
  if (!scene_is_current_ || engine().name() != "GL") return nullptr;
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

std::vector<PassCost> SnowSimulation::take_costs() {
  const std::scoped_lock lock(mutex_);
  std::vector<PassCost> costs;
  engine().run([&] { costs = engine().take_costs(); });
  return costs;
}

void SnowSimulation::save(const std::string& path) {
  Checkpoint checkpoint{{}, state()};
  {
    const std::scoped_lock lock(mutex_);
    checkpoint.description = describe(settings_, objects_, engine());
  }
  save_checkpoint(path, checkpoint);
}

void SnowSimulation::restore(const std::string& path, bool any_driver) {
  const Checkpoint checkpoint = load_checkpoint(path, [&](const CheckpointOutline& outline) {
    const std::scoped_lock lock(mutex_);
    const std::string changed =
        differences(outline.description, describe(settings_, objects_, engine()), any_driver);
    if (!changed.empty()) {
      throw std::invalid_argument(path + " belongs to another simulation; differences: " + changed);
    }
    for (const auto& [name, resolution] : outline.maps) check_map(name, resolution);
  });
  set_state(checkpoint.state);
}

}  // namespace snowbough::snow
