#pragma once

#include <functional>
#include <stdexcept>

namespace snowbough::tree {

/// Called now and then with the share done, 0 to 1, from the calling thread; false asks to stop.
using Progress = std::function<bool(float)>;

/// Thrown when a Progress callback asked to stop. Nothing is left half done.
struct Cancelled : std::runtime_error {
  Cancelled() : std::runtime_error("cancelled") {}
};

/// Reports `share` and throws Cancelled when the callback says stop. An empty callback never does.
inline void report_progress(const Progress& progress, float share) {
  if (progress && !progress(share)) {
    throw Cancelled();
  }
}

}  // namespace snowbough::tree
