#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <type_traits>

#include "base/process.h"
#include "gpu/gl_context.h"

namespace snowbough::gpu {

/// A thread that owns an EGL context and runs closures on it in the order of submission. Every GL
/// object is created, used and destroyed in such closures, so the caller's thread (Blender's main
/// thread with Blender's own context) makes no GL call.
class GpuThread {
 public:
  /// The process's thread for `device` (see GlContext): created on first use and ended with its
  /// last owner, so that simulations share one context. @throws std::runtime_error if no context
  /// can be made.
  static std::shared_ptr<GpuThread> shared(const std::string& device = "");
  /// The same without waiting for the context; `info` reports whether there is one.
  static std::shared_ptr<GpuThread> begin(const std::string& device = "");

  /// Returns while the thread is still creating the context.
  explicit GpuThread(const std::string& device);
  /// Runs the queued closures, then destroys the context and joins the thread. Do not call it on
  /// the thread itself.
  ~GpuThread();
  GpuThread(const GpuThread&) = delete;
  GpuThread& operator=(const GpuThread&) = delete;

  /// Runs `work` on the thread, waits, and returns its result or throws its exception. A pending GL
  /// error becomes a std::runtime_error. Called on the thread itself it runs `work` directly.
  /// Without a context it throws as `info`; in a forked process, which lacks the thread, it throws
  /// std::runtime_error.
  template <typename Work>
  std::invoke_result_t<Work> run(Work&& work) {
    using Result = std::invoke_result_t<Work>;
    if (is_current()) {
      return work();
    }
    require_own_process();
    info();
    // Shared, because the thread is still inside the task when the caller has its result.
    auto task = std::make_shared<std::packaged_task<Result()>>([&work]() -> Result {
      if constexpr (std::is_void_v<Result>) {
        work();
        throw_gl_errors();
      } else {
        Result result = work();
        throw_gl_errors();
        return result;
      }
    });
    std::future<Result> future = task->get_future();
    enqueue([task] { (*task)(); });
    return future.get();
  }

  /// Queues `work` on the thread and returns at once. `failed` receives its exception or GL error,
  /// on the thread. Without a context neither ever runs: see `is_ready`.
  void post(std::function<void()> work, std::function<void(std::exception_ptr)> failed);
  /// Whether creating the context has finished or failed: `info` does not wait then.
  bool is_ready() const;

  /// Whether the process has the thread. A forked one does not: objects on the thread are leaked
  /// there.
  bool is_in_this_process() const { return made_in_.is_here(); }
  /// True on the thread itself.
  bool is_current() const { return std::this_thread::get_id() == thread_.get_id(); }
  /// Waits for the context. @throws std::runtime_error if it could not be made.
  const GpuInfo& info() const {
    require_own_process();
    return info_.get();
  }

 private:
  static void throw_gl_errors();
  void require_own_process() const;
  void enqueue(std::function<void()> task);
  void loop(const std::string& device, std::promise<GpuInfo> started);

  base::ProcessMark made_in_;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<std::function<void()>> queue_;
  bool stopping_ = false;
  std::shared_future<GpuInfo> info_;
  std::thread thread_;
};

}  // namespace snowbough::gpu
