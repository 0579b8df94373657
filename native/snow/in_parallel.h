#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <vector>

namespace snowbough::snow {

/// Threads that a computation may use where nothing else is said: one a core. More than 16 wait for
/// memory rather than compute.
int32_t default_threads();

/// Makes the threads that help in_parallel, one less than default_threads(), if they are not there
/// yet. To be called before another thread begins to load a library: in glibc a new thread waits
/// until that is done, which takes a tenth of a second for a graphics driver.
void start_helpers();

/// Calls `run(part)` for all parts 0 to parts - 1, each once, on the caller's thread and on those
/// of the helpers that have nothing else to do; returns when all are done. `run` does not throw.
/// Any thread may call it, also from within `run`.
void share_out(size_t parts, const std::function<void(size_t part)>& run);

/// Calls `work(part, parts)` for all parts 0 to parts - 1, `threads` of them, at the same time as
/// far as there are threads; returns when all are done. No part may wait for another.
/// @throws what the first part that failed threw.
template <typename Work>
void in_parallel(int32_t threads, const Work& work) {
  const auto parts = static_cast<size_t>(threads);
  std::vector<std::exception_ptr> errors(parts);
  share_out(parts, [&](size_t part) {
    try {
      work(part, parts);
    } catch (...) {
      errors[part] = std::current_exception();
    }
  });
  for (const std::exception_ptr& error : errors) {
    if (error) std::rethrow_exception(error);
  }
}

}  // namespace snowbough::snow
