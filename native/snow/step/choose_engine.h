#pragma once

#include <memory>
#include <string>

#include "gpu/gpu_thread.h"
#include "snow/step/engine/engine.h"
#include "snow/step/engine/engine_request.h"

namespace snowbough::snow {

/// The engine of a simulation. The constructor starts it and `engine` waits for it, so that objects
/// can be added while a driver loads. For one thread at a time.
class EngineChoice {
 public:
  /// @throws std::invalid_argument for a mapping that the engine lacks.
  explicit EngineChoice(const EngineRequest& request);

  /// Waits for the engine. @throws std::runtime_error if GL is requested and not available.
  Engine& engine();
  /// Whether the CPU engine may still replace this one if GL fails.
  bool may_fall_back() const { return may_fall_back_; }
  /// Switches to the CPU engine; `why` becomes the reason.
  Engine& fall_back(const std::string& why);
  /// After this call the engine stays: a step that has run cannot be repeated on another one.
  void commit() { may_fall_back_ = false; }
  /// Why this engine was chosen: a sentence without its full stop.
  const std::string& reason() const { return reason_; }

 private:
  bool scatters_;
  bool may_fall_back_ = false;
  std::string reason_;
  std::shared_ptr<gpu::GpuThread> thread_;
  std::unique_ptr<Engine> engine_;
};

}  // namespace snowbough::snow
