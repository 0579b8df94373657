#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace snowbough::base {

/// Threads that a computation may use where nothing else is said: one a core, and at least one.
/// More than 16 wait for memory rather than compute.
int32_t default_threads();

/// Threads that stay, and help whoever has work to share out.
///
/// A forked process has none of them: there the callers do their work alone.
class ThreadPool {
 public:
  /// @param threads  that are to work at once, the calling one included: one less is made, or as
  ///   many as the system grants.
  explicit ThreadPool(int32_t threads);
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  /// The pool for all work of the process, of default_threads(); made at the first call. On Linux,
  /// where a thread has a niceness of its own, there is one for each: who has lowered its priority
  /// is helped by threads of the same, so that its work steps back for others' as a whole.
  static ThreadPool& shared();

  /// Calls `work(part)` for all parts 0 to parts - 1, each once and begun in their order: part 0 on
  /// the calling thread, the others there and on the pool's threads that have nothing else to do.
  /// Returns when all are done. Any thread may call it, also from within `work`; no part may wait
  /// for another.
  ///
  /// Once a part has failed no new one is begun.
  /// @throws what the first part that failed threw.
  void run(size_t parts, const std::function<void(size_t part)>& work);

 private:
  struct Job;

  void help(const std::stop_token& stop);
  void run_next(Job& job, std::unique_lock<std::mutex>& lock);

  std::mutex mutex_;
  std::condition_variable_any opened_;
  std::condition_variable done_;
  /// Those that have parts left which nobody has begun.
  std::vector<Job*> open_;
  /// Last, so that they end before what they use.
  std::vector<std::jthread> threads_;
};

/// Makes the threads of ThreadPool::shared(), if they are not there yet. To be called before
/// another thread begins to load a library: in glibc a new thread waits until that is done, which
/// takes a tenth of a second for a graphics driver.
void start_thread_pool();

}  // namespace snowbough::base
