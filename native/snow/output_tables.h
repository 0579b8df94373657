#pragma once

#include <condition_variable>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "snow/cpu_output.h"
#include "snow/scene_object.h"
#include "snow/seam_table.h"
#include "snow/smoothing.h"

namespace snowbough::snow {

/// What a receiver's output needs besides its texels: how they hang together and how far each is
/// smoothed. The same from frame to frame.
struct OutputTables {
  SeamTable seams;
  SmoothingPlan plan;
  /// On software renderers, and for maps that are too large for the driver's buffers; else empty.
  std::unique_ptr<CpuOutput> processor;
};

/// The tables of a simulation's receivers. They are built once, in threads of their own for whom
/// begin() names, so that the first steps run meanwhile. What they hold does not depend on that.
///
/// Receivers are kept by reference until they are forgotten; their description and texel table must
/// not change meanwhile. All functions are for one thread.
class OutputTableStore {
 public:
  OutputTableStore() = default;
  OutputTableStore(const OutputTableStore&) = delete;
  OutputTableStore& operator=(const OutputTableStore&) = delete;
  ~OutputTableStore();

  /// Starts building for a receiver that has its rest pose, unless that is done or under way;
  /// returns at once. `blur_radius` in metres; `on_processor`: with OutputTables::processor.
  void begin(const SceneObject& receiver, double blur_radius, bool on_processor);
  /// The tables, when they are built. @throws std::invalid_argument as build_seam_table and
  /// plan_smoothing.
  OutputTables& get(const SceneObject& receiver, double blur_radius, bool on_processor);
  void forget(const std::string& name);
  /// Forgets all.
  void clear();

 private:
  /// The tables of one receiver, built by whoever comes first.
  struct Entry {
    const SceneObject* receiver = nullptr;
    double blur_radius = 0.0;
    bool on_processor = false;
    std::once_flag once;
    OutputTables tables;
    /// A worker has begun with it, and has ended. Guarded by mutex_.
    bool taken = false;
    bool finished = false;

    void build();
  };

  std::shared_ptr<Entry> entry(const SceneObject& receiver, double blur_radius, bool on_processor);
  void work();

  std::map<std::string, std::shared_ptr<Entry>> entries_;
  /// Guards what follows.
  std::mutex mutex_;
  std::condition_variable wake_;
  std::condition_variable finished_;
  std::deque<std::shared_ptr<Entry>> waiting_;
  size_t idle_ = 0;
  bool stopping_ = false;
  std::vector<std::thread> workers_;
};

}  // namespace snowbough::snow
