#pragma once

#include <functional>
#include <stdexcept>
#include <utility>

namespace snowbough::base {

/// Called regularly from the calling thread with the fraction done, 0 to 1; returns false to stop.
using Progress = std::function<bool(float)>;

/// Thrown when a Progress callback asked to stop. No result is left half done.
struct Cancelled : std::runtime_error {
  Cancelled() : std::runtime_error("cancelled") {}
};

/// Reports `share` and throws Cancelled if the callback says stop. An empty callback never does.
inline void report_progress(const Progress& progress, float share) {
  if (progress && !progress(share)) {
    throw Cancelled();
  }
}

/// The progress of the part from `from` to `to` of a longer task; empty if `whole` is.
inline Progress part_of(Progress whole, float from, float to) {
  if (!whole) return {};
  return [whole = std::move(whole), from, to](float share) {
    return whole(from + share * (to - from));
  };
}

}  // namespace snowbough::base
