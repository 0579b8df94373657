#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>

#include "base/progress.h"
#include "base/thread_pool.h"

namespace snowbough::base {

/// How to run a long computation.
struct Execution {
  /// Threads that may share the work, the calling one included; 0 = one per core. Does not change
  /// the result.
  int threads = 0;
  /// Called between blocks of work; may stop it.
  Progress progress = {};

  /// Execution of one part of the work, whose progress runs from `from` to `to`.
  Execution part(float from, float to) const;
};

/// Calls work(part, parts) for all parts 0 to parts - 1, in parallel as far as the shared pool has
/// threads: ThreadPool::run.
/// @throws the first exception of `work`.
template <typename Work>
void parallel_for(int32_t parts, const Work& work) {
  const auto count = static_cast<size_t>(parts);
  ThreadPool::shared().run(count, [&](size_t part) { work(part, count); });
}

/// Calls work(item) for items 0 to count - 1 in any order, in runs of `run` items per thread, on at
/// most `threads` threads. @throws the first exception of `work`.
template <typename Work>
void for_each_item(size_t count, size_t run, const Work& work,
                   int32_t threads = default_threads()) {
  std::atomic<size_t> next = 0;
  const auto runs = static_cast<int32_t>(std::min<size_t>((count + run - 1) / run, 1 << 20));
  parallel_for(std::max(std::min(threads, runs), 1), [&](size_t, size_t) {
    for (size_t item; (item = next.fetch_add(run)) < count;) {
      for (const size_t end = std::min(item + run, count); item < end; ++item) work(item);
    }
  });
}

/// Calls work(begin, end) for consecutive blocks of [0, count) of at most `block` items, on several
/// threads of the shared pool at once. The output of a block must depend on its range alone and not
/// touch other blocks.
///
/// Progress is reported from the calling thread, which works too; after a stop, running blocks
/// finish and no new one starts.
/// @throws Cancelled when progress says stop; otherwise the first exception of `work`.
void parallel_for(size_t count, size_t block, const Execution& execution,
                  const std::function<void(size_t begin, size_t end)>& work);

}  // namespace snowbough::base
