#pragma once

#include <memory>
#include <string>

#include "gpu/gpu_thread.h"
#include "snow/step/engine.h"
#include "snow/step/gl/engine.h"

namespace snowbough::snow {

/// Which engine is asked for.
enum class EngineKind {
  /// GL on a hardware driver, else CPU.
  kAuto,
  kGl,
  kCpu,
};

/// The engine of a simulation: begun when this is made, there when it is first asked for, so that
/// objects come in while a driver is still being loaded. For one thread at a time.
class EngineChoice {
 public:
  struct Wish {
    EngineKind kind = EngineKind::kAuto;
    gl::DepositMapping mapping = gl::DepositMapping::kCompute;
    /// Which EGL device, see gpu::GlContext. Where one is named, here or in the environment, AUTO
    /// is GL.
    std::string device = {};
  };

  /// @throws std::invalid_argument for GEOMETRY on the CPU, which has no such mapping.
  explicit EngineChoice(const Wish& wish);

  /// Waits for the engine. @throws std::runtime_error where GL is asked for and there is none.
  Engine& engine();
  /// Whether it is certain that passes run on the processor.
  bool is_cpu() const { return engine_ != nullptr && engine_->name() == "CPU"; }
  /// Whether the engine may still be changed for the processor's, where GL fails.
  bool may_fall_back() const { return may_fall_back_; }
  /// Takes the processor's engine instead, because `why`.
  Engine& fall_back(const std::string& why);
  /// From here on a failure is the caller's: what has been done cannot be done again.
  void commit() { may_fall_back_ = false; }
  /// Why this engine: a sentence without its full stop.
  const std::string& reason() const { return reason_; }

 private:
  gl::DepositMapping mapping_;
  bool may_fall_back_ = false;
  std::string reason_;
  std::shared_ptr<gpu::GpuThread> thread_;
  std::unique_ptr<Engine> engine_;
};

/// AUTO, GL or CPU, or std::invalid_argument.
EngineKind engine_kind(const std::string& name);

}  // namespace snowbough::snow
