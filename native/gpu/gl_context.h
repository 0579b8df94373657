#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace snowbough::gpu {

/// The driver of a context and the limits that the passes respect.
struct GpuInfo {
  std::string vendor;
  std::string renderer;
  std::string version;
  /// How the display was found, e.g. "EGL device 0 (/dev/dri/renderD128)" or "EGL surfaceless".
  std::string device;
  int32_t max_array_layers = 0;
  int64_t max_storage_buffer_bytes = 0;
};

/// Whether a renderer of that name is a software renderer: Mesa's llvmpipe and softpipe.
bool is_software(std::string_view renderer);
/// The same for the current context. GPU thread.
bool renders_in_software();

GpuInfo read_info(const std::string& device);

/// Storage blocks that every stage of a shader may use in the current context. OpenGL 4.5
/// guarantees 8, and only to compute shaders: Mesa's llvmpipe has 8 in version 22.0 and 16 in 22.3.
int32_t storage_blocks();

/// Why no hardware context is possible, as far as can be known without creating one: no EGL or
/// OpenGL library, or only software devices. Empty: there may be one.
std::string why_no_hardware();

/// An off-screen OpenGL 4.5 core context without a surface, current on the thread that creates it.
/// Creating and destroying it does not affect other contexts of the process.
class GlContext {
 public:
  /// Device: "" = the environment variable SNOWBOUGH_EGL_DEVICE, else the first that works
  /// (hardware before software); "0", "1", ...: that EGL device; "software": Mesa's llvmpipe;
  /// "/dev/dri/...": the device with that file; "surfaceless": EGL's surfaceless platform.
  /// @throws std::runtime_error naming the step that failed on each device tried, and advice.
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
