#include "tree/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace snowbough::tree {
namespace {

/// More threads than this wait for memory rather than compute.
constexpr size_t kMostThreads = 16;

size_t thread_count(const Execution& execution, size_t blocks) {
  const size_t wanted = execution.threads > 0
                            ? static_cast<size_t>(execution.threads)
                            : std::max<size_t>(std::thread::hardware_concurrency(), 1);
  return std::min({wanted, blocks, kMostThreads});
}

}  // namespace

Execution Execution::part(float from, float to) const {
  Execution result{threads, {}};
  if (progress) {
    result.progress = [whole = progress, from, to](float share) {
      return whole(from + share * (to - from));
    };
  }
  return result;
}

void parallel_blocks(size_t count, size_t block, const Execution& execution,
                     const std::function<void(size_t begin, size_t end)>& work) {
  const size_t blocks = (count + block - 1) / block;
  std::atomic<size_t> next{0};
  std::atomic<bool> stop{false};
  std::mutex mutex;
  std::exception_ptr error;
  size_t failed = blocks;
  const auto run = [&](const Progress& progress) {
    while (!stop) {
      const size_t number = next++;
      if (number >= blocks) {
        return;
      }
      try {
        report_progress(progress, static_cast<float>(number) / static_cast<float>(blocks));
        work(number * block, std::min(count, (number + 1) * block));
      } catch (...) {
        // Blocks are begun in their order: of several that fail the first is always among them.
        const std::lock_guard lock(mutex);
        if (number < failed) {
          failed = number;
          error = std::current_exception();
        }
        stop = true;
      }
    }
  };
  {
    std::vector<std::jthread> helpers;
    try {
      for (size_t i = 1; i < thread_count(execution, blocks); ++i) {
        helpers.emplace_back([&run] { run({}); });
      }
    } catch (const std::system_error&) {
      // No more threads to be had: those there are do the work.
    }
    run(execution.progress);
  }
  if (error) {
    std::rethrow_exception(error);
  }
}

}  // namespace snowbough::tree
