#pragma once

#include <epoxy/gl.h>

#include <cstdint>
#include <type_traits>

namespace snowbough::render {

/// Counts of OpenGL calls.
struct GlCalls {
  /// Queries that wait for the GPU, or that copy its data to the processor.
  int32_t read_backs = 0;
  /// Calls that wait for a fence of the GPU.
  int32_t waits = 0;
  /// Memory barriers.
  int32_t barriers = 0;
  /// Bytes written to existing buffers.
  int64_t uploaded = 0;
};

/// While it lives, replaces libepoxy's pointer to a function of OpenGL and calls `Note::of` before
/// each call.
template <auto Slot, typename Note, typename Function = std::remove_reference_t<decltype(*Slot)>>
class Watched;

template <auto Slot, typename Note, typename Result, typename... Arguments>
class Watched<Slot, Note, Result (*)(Arguments...)> {
 public:
  Watched() { take(); }
  ~Watched() { *Slot = real_; }
  Watched(const Watched&) = delete;
  Watched& operator=(const Watched&) = delete;

 private:
  using Function = Result (*)(Arguments...);

  static void take() {
    real_ = *Slot;
    *Slot = &call;
  }
  static Result call(Arguments... arguments) {
    Note::of(arguments...);
    // Into the pointer itself: at its first call, libepoxy's function resolves itself there.
    *Slot = real_;
    const struct Again {
      ~Again() { take(); }
    } again;
    return (*Slot)(arguments...);
  }

  static inline Function real_ = nullptr;
};

/// Watches the calls of one thread at a time.
class GlWatch {
 public:
  GlWatch() { calls() = {}; }
  const GlCalls& seen() const { return calls(); }

 private:
  static GlCalls& calls() {
    static GlCalls counted;
    return counted;
  }
  struct ReadBack {
    template <typename... Arguments>
    static void of(const Arguments&...) {
      ++calls().read_backs;
    }
  };
  /// Pixels that go into a buffer stay on the GPU.
  struct ReadPixels {
    template <typename... Arguments>
    static void of(const Arguments&...) {
      GLint buffer = 0;
      glGetIntegerv(GL_PIXEL_PACK_BUFFER_BINDING, &buffer);
      if (buffer == 0) ++calls().read_backs;
    }
  };
  struct Finish {
    static void of() { ++calls().waits; }
  };
  struct Sync {
    static void of(GLsync /*fence*/, GLbitfield /*flags*/, GLuint64 timeout) {
      if (timeout > 0) ++calls().waits;
    }
  };
  struct Barrier {
    static void of(GLbitfield /*what*/) { ++calls().barriers; }
  };
  struct Upload {
    static void of(GLuint /*buffer*/, GLintptr /*offset*/, GLsizeiptr bytes, const void* /*data*/) {
      calls().uploaded += bytes;
    }
  };

  Watched<&epoxy_glGetNamedBufferSubData, ReadBack> buffers_;
  Watched<&epoxy_glMapNamedBufferRange, ReadBack> maps_;
  Watched<&epoxy_glGetQueryObjectui64v, ReadBack> queries_;
  Watched<&epoxy_glGetTextureSubImage, ReadPixels> textures_;
  Watched<&epoxy_glFinish, Finish> finishes_;
  Watched<&epoxy_glClientWaitSync, Sync> syncs_;
  Watched<&epoxy_glMemoryBarrier, Barrier> barriers_;
  Watched<&epoxy_glNamedBufferSubData, Upload> uploads_;
};

}  // namespace snowbough::render
