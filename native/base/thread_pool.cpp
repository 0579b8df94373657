#include "base/thread_pool.h"

#include <algorithm>
#include <array>
#include <exception>
#include <memory>
#include <system_error>
#include <utility>

#ifdef __linux__
#include <sys/resource.h>
#endif

namespace snowbough::base {
namespace {

constexpr size_t kNicenesses = 40;

/// Niceness of the calling thread, from 0. A new thread inherits it from its creator.
size_t niceness() {
#ifdef __linux__
  constexpr int kMin = -20;
  return static_cast<size_t>(
      std::clamp(getpriority(PRIO_PROCESS, 0) - kMin, 0, static_cast<int>(kNicenesses) - 1));
#else
  return 0;
#endif
}

}  // namespace

/// State of one running run().
struct ThreadPool::Job {
  const std::function<void(size_t)>& work;
  /// Number of parts to start; reduced once one has failed.
  size_t parts;
  size_t next = 0;
  size_t done = 0;
  /// Exception of the first failed part, and the part's number.
  std::exception_ptr error = nullptr;
  size_t failed = 0;
};

int32_t default_threads() {
  // Each query opens a file, which takes longer than a small loop.
  static const auto threads =
      static_cast<int32_t>(std::clamp(std::thread::hardware_concurrency(), 1u, 16u));
  return threads;
}

ThreadPool::ThreadPool(int32_t threads) {
  for (int32_t i = 1; i < threads; ++i) {
    try {
      threads_.emplace_back([this](const std::stop_token& stop) { help(stop); });
    } catch (const std::system_error&) {
      return;  // the system grants no more threads
    }
  }
}

ThreadPool& ThreadPool::shared() {
  // Never destroyed: work may still run while the process ends.
  static auto* pools = new std::array<std::unique_ptr<ThreadPool>, kNicenesses>;
  static auto* made = new std::array<std::once_flag, kNicenesses>;
  const size_t own = niceness();
  std::call_once((*made)[own],
                 [own] { (*pools)[own] = std::make_unique<ThreadPool>(default_threads()); });
  return *(*pools)[own];
}

void ThreadPool::run(size_t parts, const std::function<void(size_t)>& work) {
  Job job{work, parts};
  std::unique_lock lock(mutex_);
  if (parts > 1) {
    open_.push_back(&job);
    for (size_t helper = 1; helper < parts; ++helper) opened_.notify_one();
  }
  while (job.next < job.parts) run_next(job, lock);
  done_.wait(lock, [&] { return job.done == job.parts; });
  if (job.error) std::rethrow_exception(job.error);
}

void ThreadPool::begin(std::function<void()> work) {
  if (threads_.empty()) return;
  const std::scoped_lock lock(mutex_);
  begun_.push_back(std::move(work));
  opened_.notify_one();
}

void ThreadPool::help(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (opened_.wait(lock, stop, [&] { return !open_.empty() || !begun_.empty(); })) {
    if (!open_.empty()) {
      run_next(*open_.front(), lock);
      continue;
    }
    std::function<void()> work = std::move(begun_.front());
    begun_.pop_front();
    lock.unlock();
    work();
    work = nullptr;
    lock.lock();
  }
}

void ThreadPool::run_next(Job& job, std::unique_lock<std::mutex>& lock) {
  const size_t part = job.next++;
  if (job.next == job.parts) std::erase(open_, &job);
  lock.unlock();
  std::exception_ptr error;
  try {
    job.work(part);
  } catch (...) {
    error = std::current_exception();
  }
  lock.lock();
  if (error) {
    // Parts start in order, so the first of several failing parts has always started.
    if (!job.error || part < job.failed) {
      job.error = error;
      job.failed = part;
    }
    job.parts = job.next;
    std::erase(open_, &job);
  }
  if (++job.done == job.parts) done_.notify_all();
}

void start_thread_pool() {
  ThreadPool::shared();
}

}  // namespace snowbough::base
