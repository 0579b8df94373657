#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <type_traits>
#include <typeindex>

#include "base/process.h"
#include "gpu/gl_context.h"

namespace snowbough::gpu {

/// A thread that owns an EGL context and runs closures on it one after the other, in the order they
/// were handed in. Every GL object is made, used and destroyed in such closures, so the caller's
/// thread (Blender's main thread with Blender's own context) sees no GL call.
class GpuThread {
 public:
  /// The process's thread for `device` (see GlContext); made on first use and ended with the last
  /// owner, so that simulations share one context. @throws std::runtime_error when there is none.
  static std::shared_ptr<GpuThread> shared(const std::string& device = "");
  /// The same without waiting for the context: whether there is one, `info` tells.
  static std::shared_ptr<GpuThread> begin(const std::string& device = "");

  /// Returns while the thread still makes the context.
  explicit GpuThread(const std::string& device);
  /// Runs what is still queued, then destroys the context and joins the thread. Not to be called on
  /// the thread itself.
  ~GpuThread();
  GpuThread(const GpuThread&) = delete;
  GpuThread& operator=(const GpuThread&) = delete;

  /// Runs `work` on the thread, waits, and returns its result or throws its exception. A GL error
  /// that it leaves behind becomes a std::runtime_error. Called on the thread itself it just runs.
  /// Without a context it throws what `info` throws; in a forked process, which has not the thread,
  /// a std::runtime_error.
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

  /// Has `work` run on the thread and returns at once; a GL error that it leaves behind counts as
  /// an exception of its. What it throws is handed to `failed`, on the thread. Without a context
  /// neither ever runs: see `is_ready`.
  void post(std::function<void()> work, std::function<void(std::exception_ptr)> failed);
  /// Whether the context is made, or could not be: `info` does not wait then.
  bool is_ready() const;

  /// The context's one object of type T (programs, say), made on first use and destroyed with the
  /// context. Only on the thread itself.
  template <typename T>
  T& resource() {
    std::shared_ptr<void>& slot = resources_[std::type_index(typeid(T))];
    if (slot == nullptr) {
      slot = std::make_shared<T>();
    }
    return *static_cast<T*>(slot.get());
  }

  /// Whether the process has the thread: a forked one has not. There, what lies on it is left.
  bool is_in_this_process() const { return made_in_.is_here(); }
  /// True on the thread itself.
  bool is_current() const { return std::this_thread::get_id() == thread_.get_id(); }
  /// Waits for the context. @throws std::runtime_error where none could be made.
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
  std::map<std::type_index, std::shared_ptr<void>> resources_;
  std::thread thread_;
};

}  // namespace snowbough::gpu
