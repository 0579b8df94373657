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
#include "snow/scene/scene_object.h"
#include "snow/seams/seam_table.h"

namespace snowbough::snow {

/// Makes a receiver's output: how its texels hang together, and what rounds them on the processor,
/// for both engines. The same from frame to frame. All functions are for any thread.
class OutputFilter {
 public:
  /// `receiver` has its rest pose; its description and texel table must not change any more.
  /// `blur_radius` in metres.
  OutputFilter(std::shared_ptr<const SceneObject> receiver, double blur_radius);

  /// Builds unless that is done, or waits for the thread that is at it. run() builds first.
  /// @throws std::invalid_argument as build_seam_table and check_smoothing.
  void build();
  /// How the receiver's texels hang together; builds first.
  const SeamTable& seams();

  /// See CpuFilter::run.
  MapOutput run(std::vector<float> stored, const OutputSurface& surface);

 private:
  const std::shared_ptr<const SceneObject> receiver_;
  const double blur_radius_;
  std::once_flag built_;
  SeamTable seams_;
  std::unique_ptr<CpuFilter> cpu_filter_;
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
  void begin(const std::shared_ptr<const SceneObject>& receiver, double blur_radius);
  /// The receiver's filter, maybe not built yet.
  std::shared_ptr<OutputFilter> get(const std::shared_ptr<const SceneObject>& receiver,
                                    double blur_radius);
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
