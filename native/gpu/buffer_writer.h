#pragma once

#include <cstdint>
#include <stdexcept>
#include <utility>
#include <vector>

#include "gpu/resources.h"

namespace snowbough::gpu {

/// Fills a buffer sequentially in small portions, so that its content need not be in memory as a
/// whole. GPU thread.
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

  /// Adds `count` elements, which the caller must fill before the next call. @throws
  /// std::length_error if the buffer has no room.
  Element* add(size_t count) {
    if (size() + count > capacity_) throw std::length_error("the buffer is full");
    if (staged_.size() + count > kStaged) write_staged();
    staged_.resize(staged_.size() + count);
    return staged_.data() + staged_.size() - count;
  }

  /// Returns the buffer, shrunk to the elements added.
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
  /// Few enough to still be in the CPU cache when they are copied.
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
