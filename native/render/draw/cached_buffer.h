#pragma once

#include <cstdint>
#include <cstring>
#include <vector>

#include "gpu/resources.h"

namespace snowbough::render {

/// Replaces a buffer by a larger one if it has fewer than `bytes`. Its content is then undefined.
inline void make_room(gpu::Buffer& buffer, int64_t bytes) {
  if (buffer.bytes() < bytes) buffer = gpu::Buffer::unfilled(bytes + bytes / 4);
}

/// A buffer with a copy of a vector, uploaded only if the vector has changed.
template <typename Element>
class CachedBuffer {
 public:
  void update(const std::vector<Element>& elements) {
    const size_t bytes = elements.size() * sizeof(Element);
    if (elements.size() == kept_.size() &&
        (bytes == 0 || std::memcmp(elements.data(), kept_.data(), bytes) == 0)) {
      return;
    }
    make_room(buffer_, static_cast<int64_t>(bytes));
    buffer_.write(0, static_cast<int64_t>(bytes), elements.data());
    kept_ = elements;
  }
  const gpu::Buffer& buffer() const { return buffer_; }

 private:
  std::vector<Element> kept_;
  gpu::Buffer buffer_{0};
};

}  // namespace snowbough::render
