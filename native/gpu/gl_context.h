#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace snowbough::gpu {

/// The driver behind a context and the limits that the passes have to keep to.
struct GpuInfo {
  std::string vendor;
  std::string renderer;
  std::string version;
  /// How the display was found, e.g. "EGL device 0 (/dev/dri/renderD128)" or "EGL surfaceless".
  std::string device;
  int32_t max_texture_size = 0;
  int32_t max_array_layers = 0;
  int32_t max_viewport = 0;
  int64_t max_storage_buffer_bytes = 0;
};

/// Whether a renderer of that name computes on the processor: Mesa's llvmpipe and softpipe.
bool is_software(std::string_view renderer);
/// Whether that of the current context does. GPU thread.
bool renders_in_software();

/// The same of the current context. GPU thread.
GpuInfo read_info(const std::string& device);

/// Why no context on graphics hardware can be had, as far as that is known without making one: no
/// EGL or OpenGL library, or only software devices. Empty: there may be one.
std::string why_no_hardware();

/// An off-screen OpenGL 4.5 core context without a surface, current on the thread that made it.
/// Creating and destroying it leaves every other context of the process alone.
class GlContext {
 public:
  /// Which device: "" = the environment variable SNOWBOUGH_EGL_DEVICE, else the first that works
  /// (real GPUs before software); "0", "1", ...: that EGL device; "software": Mesa's llvmpipe;
  /// "/dev/dri/...": the device with that file; "surfaceless": EGL's surfaceless platform.
  /// @throws std::runtime_error naming the step that failed on each device tried, and what to do.
  explicit GlContext(const std::string& device);
  ~GlContext();
  GlContext(const GlContext&) = delete;
  GlContext& operator=(const GlContext&) = delete;

  const GpuInfo& info() const { return info_; }

 private:
  void* display_ = nullptr;
  void* context_ = nullptr;
  GpuInfo info_;
};

}  // namespace snowbough::gpu
