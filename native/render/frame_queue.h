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
#include "render/data/view.h"

namespace snowbough::render {

/// A finished picture, packed: one word per pixel, row 0 at the bottom (see
/// shaders/lib/frame_code.h).
struct PackedFrame {
  /// The ticket that `FrameQueue::request` returned for this picture.
  uint64_t ticket = 0;
  int32_t width = 0;
  int32_t height = 0;
  std::vector<uint32_t> words;
};

/// A buffer that the GPU writes pixels into and the CPU reads through a mapping. GPU thread.
class PixelBuffer : public gpu::Handle {
 public:
  PixelBuffer() = default;
  /// @throws std::runtime_error when memory runs out.
  explicit PixelBuffer(int64_t bytes);
  PixelBuffer(PixelBuffer&&) noexcept = default;
  PixelBuffer& operator=(PixelBuffer&&) noexcept = default;
  ~PixelBuffer();

  int64_t bytes() const { return bytes_; }
  /// Valid once the fence after the write has been signalled.
  const uint32_t* words() const { return words_; }

 private:
  int64_t bytes_ = 0;
  const uint32_t* words_ = nullptr;
};

/// Packs pictures and reads them back through three pixel buffers with fences. It never blocks on a
/// fence. GPU thread.
class FrameReader {
 public:
  FrameReader();
  ~FrameReader();
  FrameReader(const FrameReader&) = delete;
  FrameReader& operator=(const FrameReader&) = delete;

  /// True if a buffer is free for another picture.
  bool has_room() const;
  /// Starts to read back a picture of linear light. @throws std::logic_error if no buffer is free.
  void begin(const gpu::Texture& light, uint64_t ticket);
  /// The newest picture that has arrived, if any. Older pictures are discarded.
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

/// Connects a viewport that requests pictures with the GPU thread that draws them. Only the newest
/// request and the newest picture are kept. All functions may be called from any thread and block
/// only on the queue's own mutex.
class FrameQueue {
 public:
  struct Request {
    uint64_t ticket = 0;
    Camera camera;
    RenderSettings settings;
  };

  /// Replaces a pending request. Returns the new request's ticket; tickets start at 1.
  uint64_t request(const Camera& camera, const RenderSettings& settings);
  /// Returns the newest picture that has not been taken yet, and removes it.
  /// @throws the exception passed to `fail`, once.
  std::optional<PackedFrame> take();
  /// True while the GPU thread has work or waits for a picture.
  bool is_busy() const;
  /// Claims the right to post one `pump` to the GPU thread. The claim ends when the pump starts or
  /// fails.
  bool claim_pump();
  void fail(std::exception_ptr error);

  /// GPU thread: collects pictures that have arrived, and draws the newest request if a buffer is
  /// free. `draw` returns the texture of the picture's light.
  void pump(FrameReader& reader, const std::function<const gpu::Texture&(const Request&)>& draw);

 private:
  mutable std::mutex mutex_;
  uint64_t last_ticket_ = 0;
  /// Tickets of the newest picture that was started, and of the newest that has arrived.
  uint64_t begun_ = 0;
  uint64_t arrived_ = 0;
  bool pump_waits_ = false;
  std::optional<Request> wanted_;
  std::optional<PackedFrame> finished_;
  std::exception_ptr error_;
};

}  // namespace snowbough::render
