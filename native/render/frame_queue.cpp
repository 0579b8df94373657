#include "render/frame_queue.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace snowbough::render {
namespace {

constexpr int32_t kLocalSize = 8;

bool has_passed(GLsync fence) {
  const GLenum state = glClientWaitSync(fence, 0, 0);
  return state == GL_ALREADY_SIGNALED || state == GL_CONDITION_SATISFIED;
}

}  // namespace

PixelBuffer::PixelBuffer(int64_t bytes) : bytes_(bytes) {
  constexpr GLbitfield kMapped = GL_MAP_READ_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
  glCreateBuffers(1, &id_);
  glNamedBufferStorage(id_, bytes, nullptr, kMapped | GL_CLIENT_STORAGE_BIT);
  words_ = static_cast<const uint32_t*>(glMapNamedBufferRange(id_, 0, bytes, kMapped));
  if (words_ == nullptr) {
    glDeleteBuffers(1, &id_);
    throw std::runtime_error(
        "the GPU has no memory for pictures of this size: make the window smaller");
  }
}

PixelBuffer::~PixelBuffer() {
  if (id_ != 0) glDeleteBuffers(1, &id_);
}

FrameReader::FrameReader() = default;

FrameReader::~FrameReader() {
  for (const Slot& slot : slots_) {
    if (slot.fence != nullptr) glDeleteSync(slot.fence);
  }
}

bool FrameReader::has_room() const {
  return std::any_of(slots_.begin(), slots_.end(),
                     [](const Slot& slot) { return slot.fence == nullptr; });
}

void FrameReader::begin(const gpu::Texture& light, uint64_t ticket) {
  const auto slot = std::find_if(slots_.begin(), slots_.end(),
                                 [](const Slot& each) { return each.fence == nullptr; });
  if (slot == slots_.end()) throw std::logic_error("no buffer is free for another picture");
  const int32_t width = light.width(), height = light.height();
  if (words_.width() != width || words_.height() != height) {
    words_ = gpu::Texture(GL_R32UI, width, height);
  }
  pack_.use();
  pack_.bind_texture("light", light);
  pack_.bind_image("words", words_, GL_WRITE_ONLY);
  pack_.dispatch(gpu::group_count(width, kLocalSize), gpu::group_count(height, kLocalSize));
  glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);

  const int64_t bytes = int64_t{4} * width * height;
  if (slot->pixels.bytes() != bytes) slot->pixels = PixelBuffer(bytes);
  glBindBuffer(GL_PIXEL_PACK_BUFFER, slot->pixels.id());
  words_.read(0, GL_RED_INTEGER, GL_UNSIGNED_INT, bytes, nullptr);
  glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
  slot->fence = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
  glFlush();
  slot->ticket = ticket;
  slot->width = width;
  slot->height = height;
}

std::optional<PackedFrame> FrameReader::arrived() {
  Slot* newest = nullptr;
  for (Slot& slot : slots_) {
    if (slot.fence == nullptr || !has_passed(slot.fence)) continue;
    glDeleteSync(std::exchange(slot.fence, nullptr));
    if (newest == nullptr || slot.ticket > newest->ticket) newest = &slot;
  }
  if (newest == nullptr) return std::nullopt;
  const uint32_t* words = newest->pixels.words();
  const auto count = static_cast<ptrdiff_t>(newest->pixels.bytes() / 4);
  return PackedFrame{newest->ticket, newest->width, newest->height, {words, words + count}};
}

uint64_t FrameQueue::request(const Camera& camera, const RenderSettings& settings) {
  const std::scoped_lock lock(mutex_);
  wanted_ = Request{++last_ticket_, camera, settings};
  return last_ticket_;
}

std::optional<PackedFrame> FrameQueue::take() {
  const std::scoped_lock lock(mutex_);
  if (error_ != nullptr) std::rethrow_exception(std::exchange(error_, nullptr));
  return std::exchange(finished_, std::nullopt);
}

bool FrameQueue::is_busy() const {
  const std::scoped_lock lock(mutex_);
  return wanted_.has_value() || begun_ > arrived_;
}

bool FrameQueue::claim_pump() {
  const std::scoped_lock lock(mutex_);
  return !std::exchange(pump_waits_, true);
}

void FrameQueue::fail(std::exception_ptr error) {
  const std::scoped_lock lock(mutex_);
  pump_waits_ = false;
  // Keep only the first error: it causes the others.
  if (error_ == nullptr) error_ = std::move(error);
}

void FrameQueue::pump(FrameReader& reader,
                      const std::function<const gpu::Texture&(const Request&)>& draw) {
  {
    const std::scoped_lock lock(mutex_);
    pump_waits_ = false;
  }
  if (std::optional<PackedFrame> frame = reader.arrived()) {
    const std::scoped_lock lock(mutex_);
    arrived_ = std::max(arrived_, frame->ticket);
    finished_ = std::move(frame);
  }
  if (!reader.has_room()) return;
  std::optional<Request> next;
  {
    const std::scoped_lock lock(mutex_);
    next = std::exchange(wanted_, std::nullopt);
    if (!next) return;
    begun_ = next->ticket;
  }
  try {
    reader.begin(draw(*next), next->ticket);
  } catch (...) {
    const std::scoped_lock lock(mutex_);
    arrived_ = next->ticket;  // it never will
    throw;
  }
}

}  // namespace snowbough::render
