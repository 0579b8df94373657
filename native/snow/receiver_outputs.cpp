#include "snow/receiver_outputs.h"

#include <cmath>
#include <stdexcept>
#include <utility>

namespace snowbough::snow {

MapOutput OutputSnapshot::output() {
  if (filter_ == nullptr) {
    throw std::runtime_error("output() of this snapshot was already called: take a new snapshot");
  }
  const std::shared_ptr<OutputFilter> filter = std::move(filter_);
  return filter->run(std::move(stored_), pose_);
}

double ReceiverOutputs::blur_radius(const SceneObject& receiver) const {
  const double own = receiver.description.blur_radius;
  return own < 0.0 ? blur_radius_ : own;
}

void ReceiverOutputs::set_blur_radius(SceneObject& receiver, double radius) {
  const std::string& name = receiver.description.name;
  if (!std::isfinite(radius) || radius < 0.0) {
    throw std::invalid_argument("object '" + name + "': blur_radius must be 0 metres or more");
  }
  if (radius == blur_radius(receiver)) return;
  receiver.description.blur_radius = radius;
  filters_.forget(name);
}

void ReceiverOutputs::prepare(const std::shared_ptr<SceneObject>& receiver) {
  if (receiver->description.rest.empty()) {
    throw std::invalid_argument("object '" + receiver->description.name +
                                "' has no rest pose yet: prepare its output after its first step");
  }
  filters_.begin(receiver, blur_radius(*receiver));
}

const SeamTable& ReceiverOutputs::seams(const std::shared_ptr<SceneObject>& receiver) {
  return filters_.get(receiver, blur_radius(*receiver))->seams();
}

OutputSnapshot ReceiverOutputs::snapshot(const std::shared_ptr<SceneObject>& receiver,
                                         const MapRequest& maps, std::vector<float> stored,
                                         std::vector<float> wet) {
  const MapTopology& topology = receiver->description.topology;
  OutputSnapshot snapshot;
  snapshot.resolution_ = topology.resolution;
  snapshot.filter_ = filters_.get(receiver, blur_radius(*receiver));
  if (receiver->layers == nullptr) {
    receiver->layers = std::make_shared<const std::vector<LayerTerms>>(
        layer_terms(topology.triangles, receiver->description.shading, receiver->positions));
  }
  snapshot.pose_.layers = receiver->layers;
  snapshot.pose_.maps = maps;
  snapshot.pose_.wet = std::move(wet);
  if (maps.normal) {
    const std::vector<glm::vec3> positions(receiver->positions.begin(),
                                           receiver->positions.begin() + topology.vertex_count);
    snapshot.pose_.metrics = surface_metrics(topology, positions);
  }
  snapshot.stored_ = std::move(stored);
  return snapshot;
}

}  // namespace snowbough::snow
