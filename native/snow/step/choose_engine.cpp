#include "snow/step/choose_engine.h"

#include <cstdlib>
#include <stdexcept>

#include "snow/step/cpu/engine.h"
#include "snow/step/gl/engine.h"

namespace snowbough::snow {
namespace {

bool names_a_device(const std::string& device) {
  const char* wanted = std::getenv("SNOWBOUGH_EGL_DEVICE");
  return !device.empty() || (wanted != nullptr && *wanted != '\0');
}

}  // namespace

EngineChoice::EngineChoice(const EngineRequest& request)
    : scatters_(request.mapping == DepositMapping::kGeometry) {
  if (request.kind == EngineKind::kCpu) {
    if (scatters_) {
      throw std::invalid_argument(
          "mapping GEOMETRY needs OpenGL: use engine GL, or mapping COMPUTE");
    }
    engine_ = cpu::make_engine();
    reason_ = "requested";
    return;
  }
  if (request.kind == EngineKind::kGl || scatters_ || names_a_device(request.device)) {
    thread_ = gpu::GpuThread::begin(request.device);
    reason_ = request.kind == EngineKind::kGl ? "requested"
              : scatters_                     ? "mapping GEOMETRY needs OpenGL"
                                              : "a device is named";
    return;
  }
  const std::string without = gpu::why_no_hardware();
  if (!without.empty()) {
    engine_ = cpu::make_engine();
    reason_ = without;
    return;
  }
  may_fall_back_ = true;
  thread_ = gpu::GpuThread::begin("");
}

Engine& EngineChoice::engine() {
  if (engine_ != nullptr) return *engine_;
  if (may_fall_back_) {
    try {
      if (gpu::is_software(thread_->info().renderer)) {
        return fall_back("OpenGL would run on the CPU, too (" + thread_->info().renderer + ")");
      }
    } catch (const std::runtime_error& error) {
      return fall_back(error.what());
    }
    reason_ = "a graphics driver for " + thread_->info().renderer;
  }
  thread_->info();  // throws where there is none
  engine_ = gl::make_engine(thread_, scatters_);
  return *engine_;
}

Engine& EngineChoice::fall_back(const std::string& why) {
  engine_ = cpu::make_engine();
  thread_.reset();
  reason_ = why;
  may_fall_back_ = false;
  return *engine_;
}

}  // namespace snowbough::snow
