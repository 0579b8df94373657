#define NOMINMAX
#define WIN32_LEAN_AND_MEAN
#include <windows.h>
// After windows.h, whose types it uses.
#include <epoxy/gl.h>

#include <cstdlib>
#include <stdexcept>

#include "gpu/gl_context.h"

// On Windows OpenGL needs a window: each context has its own hidden one. opengl32's functions are
// called directly, since libepoxy's wrappers of them crash on a second thread; libepoxy is notified
// afterwards.
extern "C" void epoxy_handle_external_wglMakeCurrent(void);

namespace snowbough::gpu {
namespace {

constexpr const wchar_t* kWindowClass = L"SnowboughOffscreen";

// Of WGL_ARB_create_context and WGL_ARB_create_context_profile.
constexpr int kMajorVersion = 0x2091;
constexpr int kMinorVersion = 0x2092;
constexpr int kProfileMask = 0x9126;
constexpr int kCoreProfile = 0x00000001;
using CreateContext = HGLRC(WINAPI*)(HDC, HGLRC, const int*);

[[noreturn]] void fail(const char* step) {
  throw std::runtime_error(std::string("no OpenGL 4.5 context could be made: ") + step +
                           " failed (Windows error " + std::to_string(::GetLastError()) +
                           "). Install the graphics card's driver, or choose the engine CPU");
}

HWND make_window() {
  const HINSTANCE instance = ::GetModuleHandleW(nullptr);
  WNDCLASSEXW description{};
  description.cbSize = sizeof description;
  description.style = CS_OWNDC;
  description.lpfnWndProc = ::DefWindowProcW;
  description.hInstance = instance;
  description.lpszClassName = kWindowClass;
  // Fails if the class is already registered.
  ::RegisterClassExW(&description);
  const HWND window = ::CreateWindowExW(0, kWindowClass, L"", WS_OVERLAPPED, 0, 0, 1, 1, nullptr,
                                        nullptr, instance, nullptr);
  if (window == nullptr) fail("CreateWindow");
  return window;
}

void choose_pixels(HDC device) {
  PIXELFORMATDESCRIPTOR wanted{};
  wanted.nSize = sizeof wanted;
  wanted.nVersion = 1;
  wanted.dwFlags = PFD_DRAW_TO_WINDOW | PFD_SUPPORT_OPENGL;
  wanted.iPixelType = PFD_TYPE_RGBA;
  wanted.cColorBits = 32;
  const int format = ::ChoosePixelFormat(device, &wanted);
  if (format == 0 || !::SetPixelFormat(device, format, &wanted)) fail("SetPixelFormat");
}

/// A context of any version is needed to ask for one of version 4.5.
HGLRC make_context(HDC device) {
  const HGLRC old = ::wglCreateContext(device);
  if (old == nullptr || !::wglMakeCurrent(device, old)) fail("wglCreateContext");
  const auto create =
      reinterpret_cast<CreateContext>(::wglGetProcAddress("wglCreateContextAttribsARB"));
  const int attributes[] = {kMajorVersion, 4, kMinorVersion, 5, kProfileMask, kCoreProfile, 0};
  const HGLRC context = create != nullptr ? create(device, nullptr, attributes) : nullptr;
  ::wglMakeCurrent(nullptr, nullptr);
  ::wglDeleteContext(old);
  if (context == nullptr) fail("wglCreateContextAttribs (OpenGL 4.5 core)");
  if (!::wglMakeCurrent(device, context)) fail("wglMakeCurrent");
  epoxy_handle_external_wglMakeCurrent();
  return context;
}

}  // namespace

std::string why_no_hardware() {
  return "";
}

GlContext::GlContext(const std::string& device) {
  const char* variable = std::getenv("SNOWBOUGH_EGL_DEVICE");
  const std::string wanted = !device.empty() ? device : variable != nullptr ? variable : "";
  if (!wanted.empty()) {
    throw std::runtime_error("no OpenGL device matches '" + wanted +
                             "': Windows chooses it, so name none, also not in "
                             "SNOWBOUGH_EGL_DEVICE");
  }
  const HWND window = make_window();
  display_ = window;
  try {
    const HDC pixels = ::GetDC(window);
    choose_pixels(pixels);
    context_ = make_context(pixels);
  } catch (...) {
    ::DestroyWindow(window);
    throw;
  }
  info_ = read_info("WGL");
}

GlContext::~GlContext() {
  ::wglMakeCurrent(nullptr, nullptr);
  ::wglDeleteContext(static_cast<HGLRC>(context_));
  ::DestroyWindow(static_cast<HWND>(display_));
}

}  // namespace snowbough::gpu
