#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>

#include "base/progress.h"
#include "base/thread_pool.h"

namespace snowbough::base {

/// How long work may be done.
struct Execution {
  /// Threads that may share the work, the calling one included; 0 = one a core. The result does not
  /// depend on it.
  int threads = 0;
  /// Asked between blocks of work whether to go on.
  Progress progress = {};

  /// The same work as the part from `from` to `to` of a longer one's progress.
  Execution part(float from, float to) const;
};

/// Calls work(part, parts) for all parts 0 to parts - 1, at the same time as far as the shared pool
/// has threads: ThreadPool::run.
/// @throws what the first part that failed threw.
template <typename Work>
void parallel_for(int32_t parts, const Work& work) {
  const auto count = static_cast<size_t>(parts);
  ThreadPool::shared().run(count, [&](size_t part) { work(part, count); });
}

/// Calls work(item) for items 0 to count - 1, in any order, `run` of them in a row on one thread,
/// as soon as one of `threads` threads is free. @throws what the first that failed threw.
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

/// Calls work(begin, end) for consecutive blocks of [0, count), no longer than `block`, on several
/// threads of the shared pool at once. What a block writes must depend on its range alone and
/// concern no other block.
///
/// Progress is reported from the calling thread, which works too; when it says stop, blocks under
/// way are finished and no new one is begun.
/// @throws Cancelled when progress says stop; else what the first block that failed threw.
void parallel_for(size_t count, size_t block, const Execution& execution,
                  const std::function<void(size_t begin, size_t end)>& work);

}  // namespace snowbough::base
