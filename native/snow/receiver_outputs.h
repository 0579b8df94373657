#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "snow/output/map_output.h"
#include "snow/output/output_filter.h"
#include "snow/scene/scene_object.h"

namespace snowbough::snow {

/// A copy of a receiver's map at one moment. Its output can be computed on any thread while the
/// simulation continues, and after it is closed.
class OutputSnapshot {
 public:
  int32_t resolution() const { return resolution_; }
  /// See SnowSimulation::output. @throws std::runtime_error on a second call.
  MapOutput output();

 private:
  friend class ReceiverOutputs;
  int32_t resolution_ = 0;
  std::vector<float> stored_;
  OutputPose pose_;
  std::shared_ptr<OutputFilter> filter_;
};

/// What the receivers' output needs beside their heights: blur and filters. For one thread at a
/// time.
class ReceiverOutputs {
 public:
  /// `blur_radius` in metres, of receivers without their own.
  explicit ReceiverOutputs(double blur_radius) : blur_radius_(blur_radius) {}

  double blur_radius(const SceneObject& receiver) const;
  /// @throws std::invalid_argument for a radius that is negative or not finite.
  void set_blur_radius(SceneObject& receiver, double blur_radius);
  /// Starts building a receiver's tables on other threads. @throws std::invalid_argument without
  /// its rest pose.
  void prepare(const std::shared_ptr<SceneObject>& receiver);
  const SeamTable& seams(const std::shared_ptr<SceneObject>& receiver);
  /// `stored`: the heights; `wet`: see OutputPose.
  OutputSnapshot snapshot(const std::shared_ptr<SceneObject>& receiver, const MapRequest& maps,
                          std::vector<float> stored, std::vector<float> wet = {});
  /// Call it when a receiver is replaced.
  void forget(const std::string& name) { filters_.forget(name); }
  void clear() { filters_.clear(); }

 private:
  double blur_radius_;
  OutputFilterCache filters_;
};

}  // namespace snowbough::snow
