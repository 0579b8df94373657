#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <system_error>
#include <thread>
#include <vector>

namespace snowbough::snow {

/// Threads that a computation may use where nothing else is said: one a core. More than 16 wait for
/// memory rather than compute.
inline int32_t default_threads() {
  return static_cast<int32_t>(std::clamp(std::thread::hardware_concurrency(), 1u, 16u));
}

/// Calls `work(part, parts)` for all parts 0 to parts - 1, `threads` of them, each on a thread of
/// its own and the first on the caller's; returns when all are done. @throws what the first part
/// that failed threw.
template <typename Work>
void in_parallel(int32_t threads, const Work& work) {
  const auto parts = static_cast<size_t>(threads);
  std::vector<std::exception_ptr> errors(parts);
  const auto run = [&](size_t part) {
    try {
      work(part, parts);
    } catch (...) {
      errors[part] = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> others;
    for (size_t part = 1; part < parts; ++part) {
      try {
        others.emplace_back(run, part);
      } catch (const std::system_error&) {
        run(part);  // no more threads to be had
      }
    }
    run(0);
  }
  for (const std::exception_ptr& error : errors) {
    if (error) std::rethrow_exception(error);
  }
}

}  // namespace snowbough::snow
