#include "gpu/gpu_thread.h"

#include <epoxy/gl.h>

#include <chrono>
#include <map>
#include <optional>
#include <stdexcept>
#include <utility>

namespace snowbough::gpu {

namespace {

[[noreturn]] void refuse_forked() {
  throw std::runtime_error(
      "this process was forked from one that uses OpenGL: start a new process instead "
      "(multiprocessing's 'spawn'), or use engine CPU");
}

}  // namespace

std::shared_ptr<GpuThread> GpuThread::shared(const std::string& device) {
  std::shared_ptr<GpuThread> thread = begin(device);
  thread->info();
  return thread;
}

std::shared_ptr<GpuThread> GpuThread::begin(const std::string& device) {
  // Never destroyed: a simulation may outlive main.
  static auto* mutex = new std::mutex();
  static auto* threads = new std::map<std::string, std::weak_ptr<GpuThread>>();
  static const base::ProcessMark made_in;
  // A forked process lacks the driver's threads and may inherit locked mutexes.
  if (!made_in.is_here()) refuse_forked();
  const std::scoped_lock lock(*mutex);
  std::weak_ptr<GpuThread>& slot = (*threads)[device];
  std::shared_ptr<GpuThread> thread = slot.lock();
  if (thread == nullptr) {
    thread = std::shared_ptr<GpuThread>(new GpuThread(device), [](GpuThread* done) {
      if (done->is_in_this_process()) delete done;
    });
    slot = thread;
  }
  return thread;
}

GpuThread::GpuThread(const std::string& device) {
  std::promise<GpuInfo> started;
  info_ = started.get_future().share();
  thread_ = std::thread(
      [this, device, started = std::move(started)]() mutable { loop(device, std::move(started)); });
}

GpuThread::~GpuThread() {
  {
    const std::scoped_lock lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

void GpuThread::post(std::function<void()> work, std::function<void(std::exception_ptr)> failed) {
  enqueue([work = std::move(work), failed = std::move(failed)] {
    try {
      work();
      throw_gl_errors();
    } catch (...) {
      failed(std::current_exception());
    }
  });
}

bool GpuThread::is_ready() const {
  return info_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

void GpuThread::require_own_process() const {
  if (!is_in_this_process()) refuse_forked();
}

void GpuThread::enqueue(std::function<void()> task) {
  require_own_process();
  {
    const std::scoped_lock lock(mutex_);
    queue_.push_back(std::move(task));
  }
  wake_.notify_one();
}

void GpuThread::loop(const std::string& device, std::promise<GpuInfo> started) {
  std::optional<GlContext> context;
  try {
    context.emplace(device);
  } catch (...) {
    started.set_exception(std::current_exception());
    return;
  }
  started.set_value(context->info());
  while (true) {
    std::unique_lock lock(mutex_);
    wake_.wait(lock, [this] { return stopping_ || !queue_.empty(); });
    if (queue_.empty()) return;
    const std::function<void()> task = std::move(queue_.front());
    queue_.pop_front();
    lock.unlock();
    task();
  }
}

void GpuThread::throw_gl_errors() {
  const GLenum error = glGetError();
  if (error == GL_NO_ERROR) {
    return;
  }
  while (glGetError() != GL_NO_ERROR) {
  }
  char code[16];
  std::snprintf(code, sizeof code, "0x%04x", error);
  throw std::runtime_error(
      error == GL_OUT_OF_MEMORY
          ? std::string("the GPU ran out of memory: use smaller maps, fewer receivers or a larger "
                        "pixel_size")
          : std::string("OpenGL error ") + code + " in a pass");
}

}  // namespace snowbough::gpu
