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
#include "snow/level_seams.h"
#include "snow/map_output.h"
#include "snow/normals_pass.h"
#include "snow/scene_object.h"
#include "snow/seam_table.h"
#include "snow/smoothing.h"
#include "snow/smoothing_pass.h"

namespace snowbough::snow {

/// What makes output on the GPU. GPU thread.
struct OutputPasses {
  SmoothingPass smoothing;
  NormalsPass normals;
};

/// What a receiver's output needs besides its texels: how they hang together and how far each is
/// smoothed. The same from frame to frame. All functions are for any thread.
class OutputTables {
 public:
  /// `receiver` has its rest pose; its description and texel table must not change any more.
  /// `blur_radius` in metres; `on_processor`: output_on_processor will be asked for, else
  /// output_on_gpu.
  OutputTables(std::shared_ptr<const SceneObject> receiver, double blur_radius, bool on_processor);

  /// Builds unless that is done, or waits for the thread that is at it. The functions below build
  /// first. @throws std::invalid_argument as build_seam_table and plan_smoothing.
  void build();

  const SceneObject& receiver() const { return *receiver_; }
  const SeamTable& seams();
  const SmoothingPlan& plan();
  /// See CpuOutput::run.
  MapOutput output_on_processor(std::vector<float> stored,
                                const std::vector<SurfaceMetric>& metrics);
  /// The same of layer `layer` of `height_maps` (R32F array). Where `metrics` are empty, seams are
  /// not level yet: that is left to level(), so that the GPU need not wait. GPU thread.
  MapOutput output_on_gpu(OutputPasses& passes, const gpu::Texture& height_maps, int32_t layer,
                          const std::vector<SurfaceMetric>& metrics);
  /// Levels the seams of a smoothed map, in place. Callers take turns.
  void level(std::vector<float>& map);

 private:
  void make_processor();
  void make_leveller();

  const std::shared_ptr<const SceneObject> receiver_;
  const double blur_radius_;
  const bool on_processor_;
  std::once_flag built_;
  SeamTable seams_;
  SmoothingPlan plan_;
  /// Held while one of them is made, and by whoever levels what the GPU smoothed.
  std::mutex making_;
  std::unique_ptr<CpuOutput> processor_;
  std::unique_ptr<SeamLeveller> leveller_;
};

/// The tables of a simulation's receivers, built once: in threads of its own for whom begin()
/// names, so that the first steps run meanwhile. What they hold does not depend on that. All
/// functions are for one thread.
class OutputTableStore {
 public:
  OutputTableStore() = default;
  OutputTableStore(const OutputTableStore&) = delete;
  OutputTableStore& operator=(const OutputTableStore&) = delete;
  /// Waits for what the threads have begun.
  ~OutputTableStore();

  /// Starts building unless that was begun before; returns at once. Arguments as OutputTables.
  void begin(const std::shared_ptr<const SceneObject>& receiver, double blur_radius,
             bool on_processor);
  /// The receiver's tables, maybe not built yet.
  std::shared_ptr<OutputTables> get(const std::shared_ptr<const SceneObject>& receiver,
                                    double blur_radius, bool on_processor);
  void forget(const std::string& name);
  /// Forgets all.
  void clear();

 private:
  void work();

  std::map<std::string, std::shared_ptr<OutputTables>> tables_;
  /// Guards what follows.
  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<std::shared_ptr<OutputTables>> waiting_;
  size_t idle_ = 0;
  bool stopping_ = false;
  std::vector<std::thread> workers_;
};

}  // namespace snowbough::snow
