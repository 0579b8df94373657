#pragma once

#include <cstdint>
#include <stdexcept>
#include <utility>
#include <vector>

#include "gpu/resources.h"

namespace snowbough::gpu {

/// Fills a buffer from its beginning on, a little at a time, so that what goes in need not lie in
/// memory as a whole beforehand. GPU thread.
template <typename Element>
class BufferWriter {
 public:
  BufferWriter() = default;
  /// A buffer of `capacity` elements. @throws as Buffer.
  explicit BufferWriter(size_t capacity)
      : capacity_(capacity),
        buffer_(Buffer::unfilled(static_cast<int64_t>(capacity * sizeof(Element)))) {}

  /// Number of elements so far.
  size_t size() const { return written_ + staged_.size(); }

  /// Adds `count` elements, to be filled in before the next call. @throws std::length_error where
  /// the buffer has no room.
  Element* add(size_t count) {
    if (size() + count > capacity_) throw std::length_error("a buffer is filled beyond its size");
    if (staged_.size() + count > kStaged) write_staged();
    staged_.resize(staged_.size() + count);
    return staged_.data() + staged_.size() - count;
  }

  /// The buffer, as large as what was added.
  Buffer into_buffer() {
    write_staged();
    if (written_ < capacity_) {
      const auto bytes = static_cast<int64_t>(written_ * sizeof(Element));
      Buffer exact = Buffer::unfilled(bytes);
      glCopyNamedBufferSubData(buffer_.id(), exact.id(), 0, 0, bytes);
      buffer_ = std::move(exact);
    }
    capacity_ = 0;
    written_ = 0;
    return std::move(buffer_);
  }

 private:
  /// So few that they are still in the processor's cache when they are copied.
  static constexpr size_t kStaged = (size_t{1} << 18) / sizeof(Element);

  void write_staged() {
    buffer_.write(static_cast<int64_t>(written_ * sizeof(Element)),
                  static_cast<int64_t>(staged_.size() * sizeof(Element)), staged_.data());
    written_ += staged_.size();
    staged_.clear();
  }

  size_t capacity_ = 0;
  size_t written_ = 0;
  Buffer buffer_;
  std::vector<Element> staged_;
};

}  // namespace snowbough::gpu
