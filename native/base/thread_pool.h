#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace snowbough::base {

/// Default number of threads of a computation: one per core, at least one, at most 16, since more
/// would only wait for memory.
int32_t default_threads();

/// A pool of threads that share the work of their callers.
///
/// A forked process has none of the threads: callers then work alone.
class ThreadPool {
 public:
  /// @param threads  that work at once, the calling one included: one fewer is created, or as many
  ///   as the system grants.
  explicit ThreadPool(int32_t threads);
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  /// The pool for all work of the process, of default_threads(); created at the first call. On
  /// Linux, where each thread has its own niceness, there is one pool per niceness, so that a
  /// low-priority caller is helped by threads of the same priority.
  static ThreadPool& shared();

  /// Calls `work(part)` for all parts 0 to parts - 1, each once and started in order: part 0 on the
  /// calling thread, the others there and on idle threads of the pool. Returns when all are done.
  /// Any thread may call it, also from within `work`; no part may wait for another.
  ///
  /// After a part has failed no new one starts.
  /// @throws the exception of the first part that failed.
  void run(size_t parts, const std::function<void(size_t part)>& work);

  /// Calls `work` once, on a thread of the pool that no run() needs, and returns at once. `work`
  /// must not throw. Without threads, as on one core, it is not called.
  void begin(std::function<void()> work);

 private:
  struct Job;

  void help(const std::stop_token& stop);
  void run_next(Job& job, std::unique_lock<std::mutex>& lock);

  std::mutex mutex_;
  std::condition_variable_any opened_;
  std::condition_variable done_;
  /// Jobs with parts that have not started.
  std::vector<Job*> open_;
  /// Work of begin() that has not started.
  std::deque<std::function<void()>> begun_;
  /// Last, so that the threads end before the members that they use.
  std::vector<std::jthread> threads_;
};

/// Creates the threads of ThreadPool::shared(), if they do not exist yet. Call it before another
/// thread starts loading a library: in glibc a new thread waits until loading is done, which takes
/// a tenth of a second for a graphics driver.
void start_thread_pool();

}  // namespace snowbough::base
