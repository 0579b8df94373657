#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "snow/output/cpu_filter.h"
#include "snow/output/map_output.h"
#include "snow/scene/scene_object.h"
#include "snow/seams/seam_table.h"

namespace snowbough::snow {

/// Makes a receiver's output: its texel connectivity and the CPU filter, for both engines. The same
/// for all frames. Thread-safe.
class OutputFilter {
 public:
  /// `receiver` has its rest pose; its description and texel table must not change afterwards.
  /// `blur_radius` in metres.
  OutputFilter(std::shared_ptr<const SceneObject> receiver, double blur_radius);

  /// Builds the tables once; waits if another thread is building them. run() calls it.
  /// @throws std::invalid_argument as build_seam_table and check_smoothing.
  void build();
  /// The receiver's texel connectivity; builds first.
  const SeamTable& seams();

  /// See CpuFilter::run.
  MapOutput run(std::vector<float> stored, const OutputPose& pose);

 private:
  const std::shared_ptr<const SceneObject> receiver_;
  const double blur_radius_;
  std::once_flag built_;
  SeamTable seams_;
  std::unique_ptr<CpuFilter> cpu_filter_;
};

/// The filters of a simulation's receivers, built once; after begin() on the thread pool, beside
/// the first steps, which does not change the result. All functions are for one thread. Building
/// them for each map again takes 9 % of a bake of two maps a receiver, and more of longer ones.
class OutputFilterCache {
 public:
  /// Starts building unless already started; returns at once. Arguments as in OutputFilter.
  void begin(const std::shared_ptr<const SceneObject>& receiver, double blur_radius);
  /// The receiver's filter, possibly not built yet.
  std::shared_ptr<OutputFilter> get(const std::shared_ptr<const SceneObject>& receiver,
                                    double blur_radius);
  void forget(const std::string& name) { filters_.erase(name); }
  /// Removes all filters.
  void clear() { filters_.clear(); }

 private:
  std::map<std::string, std::shared_ptr<OutputFilter>> filters_;
};

}  // namespace snowbough::snow
