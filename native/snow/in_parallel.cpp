#include "snow/in_parallel.h"

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <system_error>
#include <thread>

namespace snowbough::snow {
namespace {

/// One share_out that is going on.
struct Shared {
  const std::function<void(size_t)>& run;
  size_t parts;
  size_t next = 0;
  size_t done = 0;
};

class Helpers {
 public:
  Helpers() {
    for (int32_t i = 1; i < default_threads(); ++i) {
      try {
        threads_.emplace_back([this](const std::stop_token& stop) { help(stop); });
      } catch (const std::system_error&) {
        return;  // no more threads to be had: callers do without
      }
    }
  }

  void share_out(size_t parts, const std::function<void(size_t)>& run) {
    Shared shared{run, parts};
    std::unique_lock lock(mutex_);
    if (parts > 1) {
      open_.push_back(&shared);
      for (size_t helper = 1; helper < parts; ++helper) opened_.notify_one();
    }
    while (shared.next < parts) run_next(shared, lock);
    done_.wait(lock, [&] { return shared.done == parts; });
  }

 private:
  void help(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    while (opened_.wait(lock, stop, [&] { return !open_.empty(); })) {
      run_next(*open_.front(), lock);
    }
  }

  void run_next(Shared& shared, std::unique_lock<std::mutex>& lock) {
    const size_t part = shared.next++;
    if (shared.next == shared.parts) std::erase(open_, &shared);
    lock.unlock();
    shared.run(part);
    lock.lock();
    if (++shared.done == shared.parts) done_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable_any opened_;
  std::condition_variable done_;
  /// Those that have parts left which nobody has begun.
  std::vector<Shared*> open_;
  /// Last, so that they end before what they use.
  std::vector<std::jthread> threads_;
};

Helpers& helpers() {
  // Never destroyed: work that goes on while the process ends must not find them gone.
  static auto* all = new Helpers();
  return *all;
}

}  // namespace

int32_t default_threads() {
  return static_cast<int32_t>(std::clamp(std::thread::hardware_concurrency(), 1u, 16u));
}

void start_helpers() {
  helpers();
}

void share_out(size_t parts, const std::function<void(size_t part)>& run) {
  helpers().share_out(parts, run);
}

}  // namespace snowbough::snow
