#include <dlfcn.h>
#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <stdexcept>
#include <vector>

#include "gpu/gl_context.h"

namespace snowbough::gpu {
namespace {

/// A display to try: a device of EGL_EXT_platform_device, or null for the surfaceless platform.
struct Candidate {
  EGLDeviceEXT device = nullptr;
  std::string label;
  bool software = false;
};

/// eglTerminate ends a display for the whole process, so displays are counted.
std::mutex display_mutex;
std::map<EGLDisplay, int>& display_users() {
  static auto* users = new std::map<EGLDisplay, int>();
  return *users;
}

bool can_load(const char* library) {
  // Left open on purpose: libepoxy loads the same file next.
  return dlopen(library, RTLD_LAZY | RTLD_LOCAL) != nullptr;
}

/// libepoxy ends the process if a library is missing, so this checks first.
void require_libraries() {
  if (!can_load("libEGL.so.1")) {
    throw std::runtime_error(
        "OpenGL needs libEGL.so.1, which cannot be loaded: install the graphics driver, or Mesa "
        "(Debian and Ubuntu: apt install libegl1 libgl1-mesa-dri)");
  }
  if (!can_load("libOpenGL.so.0") && !can_load("libGL.so.1")) {
    throw std::runtime_error(
        "neither libOpenGL.so.0 nor libGL.so.1 can be loaded: install the graphics driver, or Mesa "
        "(Debian and Ubuntu: apt install libopengl0 libgl1)");
  }
}

bool has_extension(const char* extensions, const char* name) {
  const size_t length = std::strlen(name);
  for (const char* at = extensions; at != nullptr && (at = std::strstr(at, name)) != nullptr;
       at += length) {
    if (at[length] == ' ' || at[length] == '\0') {
      return true;
    }
  }
  return false;
}

std::vector<Candidate> list_candidates() {
  std::vector<Candidate> candidates;
  const char* client = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  if (has_extension(client, "EGL_EXT_platform_device") &&
      (has_extension(client, "EGL_EXT_device_enumeration") ||
       has_extension(client, "EGL_EXT_device_base"))) {
    EGLint count = 0;
    eglQueryDevicesEXT(0, nullptr, &count);
    std::vector<EGLDeviceEXT> devices(static_cast<size_t>(std::max(count, 0)));
    if (count > 0 && eglQueryDevicesEXT(count, devices.data(), &count)) {
      devices.resize(static_cast<size_t>(count));
      for (size_t i = 0; i < devices.size(); ++i) {
        Candidate candidate{devices[i], "EGL device " + std::to_string(i), false};
        const char* extensions = eglQueryDeviceStringEXT(devices[i], EGL_EXTENSIONS);
        candidate.software = has_extension(extensions, "EGL_MESA_device_software");
        const char* file = has_extension(extensions, "EGL_EXT_device_drm")
                               ? eglQueryDeviceStringEXT(devices[i], EGL_DRM_DEVICE_FILE_EXT)
                               : nullptr;
        if (file != nullptr) {
          candidate.label += " (" + std::string(file) + ")";
        } else if (candidate.software) {
          candidate.label += " (software)";
        }
        candidates.push_back(candidate);
      }
    }
  }
  if (has_extension(client, "EGL_MESA_platform_surfaceless")) {
    candidates.push_back({nullptr, "EGL surfaceless", false});
  }
  return candidates;
}

/// Keeps the candidates that `wanted` names; if it is empty, hardware comes before software.
std::vector<Candidate> select_candidates(std::vector<Candidate> all, const std::string& wanted) {
  if (wanted.empty()) {
    std::stable_partition(all.begin(), all.end(), [](const Candidate& c) { return !c.software; });
    return all;
  }
  std::vector<Candidate> chosen;
  for (const Candidate& candidate : all) {
    const bool by_index = candidate.label == wanted || candidate.label == "EGL device " + wanted ||
                          candidate.label.starts_with("EGL device " + wanted + " ");
    const bool by_file =
        wanted.starts_with("/") && candidate.label.find("(" + wanted + ")") != std::string::npos;
    const bool by_kind = (wanted == "software" && candidate.software) ||
                         (wanted == "surfaceless" && candidate.device == nullptr);
    if (by_index || by_file || by_kind) {
      chosen.push_back(candidate);
    }
  }
  if (chosen.empty()) {
    std::string names;
    for (const Candidate& candidate : all) {
      names += (names.empty() ? "" : ", ") + candidate.label;
    }
    throw std::runtime_error("no EGL device matches '" + wanted +
                             "' (there are: " + (names.empty() ? "none" : names) +
                             "); use a number, 'software', 'surfaceless' or a /dev/dri file");
  }
  return chosen;
}

std::string egl_failure(const char* step) {
  char code[16];
  std::snprintf(code, sizeof code, "0x%04x", static_cast<unsigned>(eglGetError()));
  return std::string(step) + " failed (EGL error " + code + ")";
}

EGLDisplay open_display(const Candidate& candidate, std::string& failure) {
  const EGLDisplay display =
      candidate.device != nullptr
          ? eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, candidate.device, nullptr)
          : eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  if (display == EGL_NO_DISPLAY) {
    failure = egl_failure("eglGetPlatformDisplay");
    return EGL_NO_DISPLAY;
  }
  const std::scoped_lock lock(display_mutex);
  if (!eglInitialize(display, nullptr, nullptr)) {
    failure = egl_failure("eglInitialize");
    return EGL_NO_DISPLAY;
  }
  ++display_users()[display];
  return display;
}

void close_display(EGLDisplay display) {
  const std::scoped_lock lock(display_mutex);
  if (--display_users()[display] == 0) {
    eglTerminate(display);
  }
}

EGLContext make_context(EGLDisplay display, std::string& failure) {
  if (!eglBindAPI(EGL_OPENGL_API)) {
    failure = egl_failure("eglBindAPI(EGL_OPENGL_API)");
    return EGL_NO_CONTEXT;
  }
  const EGLint config_attributes[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, 0,
                                      EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  if (!eglChooseConfig(display, config_attributes, &config, 1, &count) || count < 1) {
    failure = egl_failure("eglChooseConfig");
    return EGL_NO_CONTEXT;
  }
  const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                               4,
                               EGL_CONTEXT_MINOR_VERSION,
                               5,
                               EGL_CONTEXT_OPENGL_PROFILE_MASK,
                               EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                               EGL_NONE};
  const EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, attributes);
  if (context == EGL_NO_CONTEXT) {
    failure = egl_failure("eglCreateContext (OpenGL 4.5 core)");
    return EGL_NO_CONTEXT;
  }
  if (!eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) {
    failure = egl_failure("eglMakeCurrent without a surface");
    eglDestroyContext(display, context);
    return EGL_NO_CONTEXT;
  }
  return context;
}

}  // namespace

std::string why_no_hardware() {
  try {
    require_libraries();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  const std::vector<Candidate> candidates = list_candidates();
  const bool lists_devices = std::any_of(candidates.begin(), candidates.end(),
                                         [](const Candidate& c) { return c.device != nullptr; });
  const bool has_hardware =
      std::any_of(candidates.begin(), candidates.end(),
                  [](const Candidate& c) { return c.device != nullptr && !c.software; });
  return lists_devices && !has_hardware ? "EGL lists no graphics hardware" : "";
}

GlContext::GlContext(const std::string& device) {
  require_libraries();
  const char* variable = std::getenv("SNOWBOUGH_EGL_DEVICE");
  const std::string wanted = !device.empty() ? device : variable != nullptr ? variable : "";
  std::string failures;
  for (const Candidate& candidate : select_candidates(list_candidates(), wanted)) {
    std::string failure;
    const EGLDisplay display = open_display(candidate, failure);
    if (display != EGL_NO_DISPLAY) {
      const EGLContext context = make_context(display, failure);
      if (context != EGL_NO_CONTEXT) {
        display_ = display;
        context_ = context;
        info_ = read_info(candidate.label);
        return;
      }
      close_display(display);
    }
    failures += "\n  " + candidate.label + ": " + failure;
  }
  throw std::runtime_error(
      "no OpenGL 4.5 context could be created" +
      (failures.empty() ? std::string(": EGL offers neither a device nor a surfaceless platform")
                        : ":" + failures) +
      "\nInstall Mesa's drivers (Debian and Ubuntu: apt install libgl1-mesa-dri libegl-mesa0), or "
      "choose a device with SNOWBOUGH_EGL_DEVICE");
}

GlContext::~GlContext() {
  eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(display_, context_);
  close_display(display_);
  eglReleaseThread();
}

}  // namespace snowbough::gpu
