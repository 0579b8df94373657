#include "base/parallel_for.h"

#include <exception>
#include <mutex>

namespace snowbough::base {
namespace {

size_t thread_count(const Execution& execution, size_t blocks) {
  const auto most = static_cast<size_t>(default_threads());
  return std::min(blocks, execution.threads > 0
                              ? std::min(static_cast<size_t>(execution.threads), most)
                              : most);
}

}  // namespace

Execution Execution::part(float from, float to) const {
  return {threads, part_of(progress, from, to)};
}

void parallel_for(size_t count, size_t block, const Execution& execution,
                  const std::function<void(size_t begin, size_t end)>& work) {
  const size_t blocks = (count + block - 1) / block;
  std::atomic<size_t> next{0};
  std::atomic<bool> stop{false};
  std::mutex mutex;
  std::exception_ptr error;
  size_t failed = blocks;
  ThreadPool::shared().run(thread_count(execution, blocks), [&](size_t part) {
    while (!stop) {
      const size_t number = next++;
      if (number >= blocks) return;
      try {
        // The calling thread runs part 0.
        if (part == 0) {
          report_progress(execution.progress,
                          static_cast<float>(number) / static_cast<float>(blocks));
        }
        work(number * block, std::min(count, (number + 1) * block));
      } catch (...) {
        // Blocks start in order, so the first of several failing blocks has always started.
        const std::lock_guard lock(mutex);
        if (number < failed) {
          failed = number;
          error = std::current_exception();
        }
        stop = true;
      }
    }
  });
  if (error) std::rethrow_exception(error);
}

}  // namespace snowbough::base
