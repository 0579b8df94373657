#pragma once

#include <epoxy/gl.h>

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "gpu/resources.h"

namespace snowbough::gpu {

/// A GL query object. GPU thread.
class Query : public Handle {
 public:
  Query() = default;
  /// `target` as in glBeginQuery, or GL_TIMESTAMP.
  explicit Query(GLenum target);
  Query(Query&&) noexcept = default;
  Query& operator=(Query&&) noexcept = default;
  ~Query();

  /// Waits until the GPU has reached the query.
  uint64_t result() const;
};

/// Cost of a pass.
struct PassTime {
  std::string name;
  /// Seconds by the GPU's clock from the pass's beginning to its end.
  double gpu_seconds = 0.0;
  /// Seconds that the CPU took to submit it and, if the timer waits, until its end.
  double wall_seconds = 0.0;
  /// Points, lines or triangles that reached the rasteriser, including those from tessellation.
  uint64_t primitives = 0;
};

/// Measures passes with two GL_TIMESTAMP queries and one GL_PRIMITIVES_GENERATED query each. GPU
/// thread. Usage:
///
///   { const auto pass = timer.measure("draw"); program.draw(...); }
///   for (const PassTime& pass : timer.take()) ...
class PassTimer {
 public:
  /// Ends the pass in its destructor.
  class Pass {
   public:
    explicit Pass(PassTimer& timer) : timer_(timer) {}
    ~Pass() { timer_.end(); }
    Pass(const Pass&) = delete;
    Pass& operator=(const Pass&) = delete;

   private:
    PassTimer& timer_;
  };

  /// `waits`: wait for the GPU at the end of each pass. A software renderer postpones drawing, so
  /// only then are times per pass correct; on a GPU waiting would leave it idle.
  explicit PassTimer(bool waits = false) : waits_(waits) {}

  /// While disabled, `measure` records nothing, so that no results need waiting for.
  void set_enabled(bool enabled) { enabled_ = enabled; }
  /// Begins a pass. @throws std::logic_error during another pass: OpenGL counts primitives for one
  /// at a time.
  [[nodiscard]] Pass measure(std::string name);
  /// The measurements since the last call, in order. Waits for the GPU.
  /// @throws std::logic_error during a pass.
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

  /// The first `used_` hold results to read; the queries of the rest are reused.
  std::vector<Measurement> measurements_;
  size_t used_ = 0;
  bool waits_;
  bool enabled_ = true;
  bool running_ = false;
};

}  // namespace snowbough::gpu
