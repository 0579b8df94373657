#include "base/thread_pool.h"

#include <algorithm>
#include <array>
#include <exception>
#include <memory>
#include <system_error>

#ifdef __linux__
#include <sys/resource.h>
#endif

namespace snowbough::base {
namespace {

constexpr size_t kNicenesses = 40;

/// Of the calling thread, counted from 0. A new thread has that of the one that makes it.
size_t niceness() {
#ifdef __linux__
  constexpr int kLeast = -20;
  return static_cast<size_t>(
      std::clamp(getpriority(PRIO_PROCESS, 0) - kLeast, 0, static_cast<int>(kNicenesses) - 1));
#else
  return 0;
#endif
}

}  // namespace

/// One run() that is going on.
struct ThreadPool::Job {
  const std::function<void(size_t)>& work;
  /// Parts to be begun: fewer than asked for once one has failed.
  size_t parts;
  size_t next = 0;
  size_t done = 0;
  /// Whether the caller sleeps until the others are done.
  bool is_awaited = false;
  /// What the first part that failed threw, and which one that was.
  std::exception_ptr error = nullptr;
  size_t failed = 0;
};

int32_t default_threads() {
  return static_cast<int32_t>(std::clamp(std::thread::hardware_concurrency(), 1u, 16u));
}

ThreadPool::ThreadPool(int32_t threads) {
  for (int32_t i = 1; i < threads; ++i) {
    try {
      threads_.emplace_back([this] { help(); });
    } catch (const std::system_error&) {
      return;  // no more threads to be had: callers do without
    }
  }
}

ThreadPool::~ThreadPool() {
  {
    const std::scoped_lock lock(mutex_);
    is_ending_ = true;
  }
  opened_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

ThreadPool& ThreadPool::shared() {
  // Never destroyed: work that goes on while the process ends must not find them gone.
  static auto* pools = new std::array<std::unique_ptr<ThreadPool>, kNicenesses>;
  static auto* made = new std::array<std::once_flag, kNicenesses>;
  const size_t own = niceness();
  std::call_once((*made)[own],
                 [own] { (*pools)[own] = std::make_unique<ThreadPool>(default_threads()); });
  return *(*pools)[own];
}

void ThreadPool::run(size_t parts, const std::function<void(size_t)>& work) {
  if (parts == 0) return;
  if (parts == 1) {
    work(0);
    return;
  }
  Job job{work, parts};
  std::unique_lock lock(mutex_);
  open_.push_back(&job);
  job.next = 1;
  lock.unlock();
  // Who is woken needs the lock, and would go to sleep again if it were held here.
  for (size_t helper = 1; helper < parts; ++helper) opened_.notify_one();
  run_part(job, 0, lock);
  while (job.next < job.parts) run_next(job, lock);
  job.is_awaited = job.done < job.parts;
  done_.wait(lock, [&] { return job.done == job.parts; });
  if (job.error) std::rethrow_exception(job.error);
}

void ThreadPool::help() {
  std::unique_lock lock(mutex_);
  while (true) {
    opened_.wait(lock, [&] { return is_ending_ || !open_.empty(); });
    if (is_ending_) return;
    run_next(*open_.front(), lock);
  }
}

void ThreadPool::run_next(Job& job, std::unique_lock<std::mutex>& lock) {
  const size_t part = job.next++;
  if (job.next == job.parts) std::erase(open_, &job);
  lock.unlock();
  run_part(job, part, lock);
}

void ThreadPool::run_part(Job& job, size_t part, std::unique_lock<std::mutex>& lock) {
  std::exception_ptr error;
  try {
    job.work(part);
  } catch (...) {
    error = std::current_exception();
  }
  lock.lock();
  if (error) {
    // Parts are begun in their order: of several that fail the first is always among them.
    if (!job.error || part < job.failed) {
      job.error = error;
      job.failed = part;
    }
    job.parts = job.next;
    std::erase(open_, &job);
  }
  if (++job.done < job.parts || !job.is_awaited) return;
  // The job is gone as soon as its caller has the lock.
  lock.unlock();
  done_.notify_all();
  lock.lock();
}

void start_thread_pool() {
  ThreadPool::shared();
}

}  // namespace snowbough::base
