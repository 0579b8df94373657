#pragma once

#include <epoxy/gl.h>

#include <array>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <vector>

#include "gpu/program.h"
#include "gpu/resources.h"
#include "render/view.h"

namespace snowbough::render {

/// A finished picture, packed: a word a pixel, row 0 at the bottom (see shaders/lib/frame_code.h).
struct PackedFrame {
  /// What `FrameQueue::request` gave for it.
  uint64_t ticket = 0;
  int32_t width = 0;
  int32_t height = 0;
  std::vector<uint32_t> words;
};

/// Memory that the GPU writes pixels into and the processor sees. GPU thread.
class PixelBuffer : public gpu::Handle {
 public:
  PixelBuffer() = default;
  /// @throws std::runtime_error when memory runs out.
  explicit PixelBuffer(int64_t bytes);
  PixelBuffer(PixelBuffer&&) noexcept = default;
  PixelBuffer& operator=(PixelBuffer&&) noexcept = default;
  ~PixelBuffer();

  int64_t bytes() const { return bytes_; }
  /// To be read behind a fence that has passed.
  const uint32_t* words() const { return words_; }

 private:
  int64_t bytes_ = 0;
  const uint32_t* words_ = nullptr;
};

/// Packs pictures and reads them back through three pixel buffers with fences, none of which is
/// ever waited for. GPU thread.
class FrameReader {
 public:
  FrameReader();
  ~FrameReader();
  FrameReader(const FrameReader&) = delete;
  FrameReader& operator=(const FrameReader&) = delete;

  /// Whether there is a buffer for another picture.
  bool has_room() const;
  /// Begins to read a picture of linear light. @throws std::logic_error without room.
  void begin(const gpu::Texture& light, uint64_t ticket);
  /// The newest picture that has arrived by now, if any; older ones are passed over.
  std::optional<PackedFrame> arrived();

 private:
  struct Slot {
    PixelBuffer pixels;
    GLsync fence = nullptr;
    uint64_t ticket = 0;
    int32_t width = 0;
    int32_t height = 0;
  };

  gpu::Program pack_{{"frame_pack.comp.glsl"}};
  gpu::Texture words_;
  std::array<Slot, 3> slots_;
};

/// Between a viewport that asks for pictures and the GPU thread that makes them: the newest request
/// counts, and the newest picture. All functions may be called from any thread and wait for nothing
/// but each other.
class FrameQueue {
 public:
  struct Request {
    uint64_t ticket = 0;
    Camera camera;
    RenderSettings settings;
  };

  /// Replaces a request that nobody has begun. Returns its ticket, from 1 on.
  uint64_t request(const Camera& camera, const RenderSettings& settings);
  /// Takes the newest picture that was not taken yet.
  /// @throws what was handed to `fail`, once.
  std::optional<PackedFrame> take();
  /// Whether the GPU thread has something to do or to wait for.
  bool is_busy() const;
  /// Claims the right to hand one pump to the GPU thread; it is given back as the pump begins or
  /// fails.
  bool claim_pump();
  void fail(std::exception_ptr error);

  /// On the GPU thread: collects what has arrived, and draws the newest request where there is
  /// room. `draw` gives the texture of its light.
  void pump(FrameReader& reader, const std::function<const gpu::Texture&(const Request&)>& draw);

 private:
  mutable std::mutex mutex_;
  uint64_t last_ticket_ = 0;
  /// Of the newest picture that was begun, and of the newest that has arrived.
  uint64_t begun_ = 0;
  uint64_t arrived_ = 0;
  bool pump_waits_ = false;
  std::optional<Request> wanted_;
  std::optional<PackedFrame> finished_;
  std::exception_ptr error_;
};

}  // namespace snowbough::render
