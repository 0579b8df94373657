#pragma once

#include <epoxy/gl.h>

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "gpu/resources.h"

namespace snowbough::gpu {

/// A question to the GPU that is answered when it gets there. GPU thread.
class Query : public Handle {
 public:
  Query() = default;
  /// `target` as glBeginQuery's, or GL_TIMESTAMP.
  explicit Query(GLenum target);
  Query(Query&&) noexcept = default;
  Query& operator=(Query&&) noexcept = default;
  ~Query();

  /// Whether `result` would return at once.
  bool is_ready() const;
  /// Waits until the GPU has got there.
  uint64_t result() const;
};

/// What a pass took.
struct PassTime {
  std::string name;
  /// Seconds between the GPU's own clock before and after the pass.
  double gpu_seconds = 0.0;
  /// Seconds that the processor took to hand it in and, where the timer waits, for its end.
  double wall_seconds = 0.0;
  /// Points, lines or triangles that the pass handed to the rasteriser, those that the tessellator
  /// made included.
  uint64_t primitives = 0;
};

/// Measures passes with pairs of GL_TIMESTAMP and a GL_PRIMITIVES_GENERATED each. GPU thread. Used
/// like this:
///
///   { const auto pass = timer.measure("draw"); program.draw(...); }
///   for (const PassTime& pass : timer.take()) ...
class PassTimer {
 public:
  /// Ends the pass when it goes.
  class Pass {
   public:
    explicit Pass(PassTimer& timer) : timer_(timer) {}
    ~Pass() { timer_.end(); }
    Pass(const Pass&) = delete;
    Pass& operator=(const Pass&) = delete;

   private:
    PassTimer& timer_;
  };

  /// `waits`: waits for the GPU at the end of each pass. A software renderer puts drawing off until
  /// it must, so only then is a pass's time its own; elsewhere it would keep the GPU idle.
  explicit PassTimer(bool waits = false) : waits_(waits) {}

  /// Without being enabled `measure` measures nothing: what is taken would have to be waited for.
  void set_enabled(bool enabled) { enabled_ = enabled; }
  /// Begins a pass. @throws std::logic_error while another is being measured: OpenGL counts
  /// primitives for one at a time.
  [[nodiscard]] Pass measure(std::string name);
  /// What was measured since the last call, in order. Waits for the GPU.
  /// @throws std::logic_error while a pass is being measured.
  std::vector<PassTime> take();

 private:
  using Clock = std::chrono::steady_clock;
  struct Measurement {
    std::string name;
    Query begin{GL_TIMESTAMP};
    Query end{GL_TIMESTAMP};
    Query primitives{GL_PRIMITIVES_GENERATED};
    Clock::time_point started;
    double wall_seconds = 0.0;
  };

  void end();

  /// The first `used_` are waiting; the others' queries are kept for later passes.
  std::vector<Measurement> measurements_;
  size_t used_ = 0;
  bool waits_;
  bool enabled_ = true;
  bool running_ = false;
};

}  // namespace snowbough::gpu
