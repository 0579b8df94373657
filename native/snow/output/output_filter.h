#pragma once

#include <condition_variable>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "snow/output/cpu_filter.h"
#include "snow/output/map_output.h"
#include "snow/output/smoothing.h"
#include "snow/scene/scene_object.h"
#include "snow/seams/seam_leveller.h"
#include "snow/seams/seam_table.h"

namespace snowbough::snow {

/// Makes a receiver's output: how its texels hang together, how far each is smoothed, and what
/// smooths them on the processor. The same from frame to frame. All functions are for any thread.
class OutputFilter {
 public:
  /// `receiver` has its rest pose; its description and texel table must not change any more.
  /// `blur_radius` in metres; `on_processor`: run() will be asked for, else level() alone, beside
  /// filter_on_gpu.
  OutputFilter(std::shared_ptr<const SceneObject> receiver, double blur_radius, bool on_processor);

  /// Builds unless that is done, or waits for the thread that is at it. The functions below build
  /// first. @throws std::invalid_argument as build_seam_table and plan_smoothing.
  void build();

  const SceneObject& receiver() const { return *receiver_; }
  const SeamTable& seams();
  const SmoothingPlan& plan();
  /// See CpuFilter::run.
  MapOutput run(std::vector<float> stored, const std::vector<SurfaceMetric>& metrics);
  /// Levels the seams of a smoothed map, in place. Callers take turns.
  void level(std::vector<float>& map);

 private:
  void make_cpu_filter();
  void make_leveller();

  const std::shared_ptr<const SceneObject> receiver_;
  const double blur_radius_;
  const bool on_processor_;
  std::once_flag built_;
  SeamTable seams_;
  SmoothingPlan plan_;
  /// Held while one of them is made, and by whoever levels what the GPU smoothed.
  std::mutex making_;
  std::unique_ptr<CpuFilter> cpu_filter_;
  std::unique_ptr<SeamLeveller> leveller_;
};

/// The filters of a simulation's receivers, built once: in threads of its own for whom begin()
/// names, so that the first steps run meanwhile. What they hold does not depend on that. All
/// functions are for one thread.
class OutputFilterCache {
 public:
  OutputFilterCache() = default;
  OutputFilterCache(const OutputFilterCache&) = delete;
  OutputFilterCache& operator=(const OutputFilterCache&) = delete;
  /// Waits for what the threads have begun.
  ~OutputFilterCache();

  /// Starts building unless that was begun before; returns at once. Arguments as OutputFilter.
  void begin(const std::shared_ptr<const SceneObject>& receiver, double blur_radius,
             bool on_processor);
  /// The receiver's filter, maybe not built yet.
  std::shared_ptr<OutputFilter> get(const std::shared_ptr<const SceneObject>& receiver,
                                    double blur_radius, bool on_processor);
  void forget(const std::string& name);
  /// Forgets all.
  void clear();

 private:
  void work();

  std::map<std::string, std::shared_ptr<OutputFilter>> filters_;
  /// Guards what follows.
  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<std::shared_ptr<OutputFilter>> waiting_;
  size_t idle_ = 0;
  bool stopping_ = false;
  std::vector<std::thread> workers_;
};

}  // namespace snowbough::snow
