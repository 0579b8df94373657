#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "gpu/resources.h"

namespace snowbough::render {

/// Ranges of whole numbers, from 0 up; new ones go into the first gap that fits.
class Ranges {
 public:
  /// Begin of a new range, which `add` would return.
  int32_t place_for(int32_t count) const;
  int32_t add(int32_t count);
  void remove(int32_t first, int32_t count);
  /// One past the highest number in use.
  int32_t end() const { return end_; }

 private:
  /// Counts of the gaps, by their first number.
  std::map<int32_t, int32_t> gaps_;
  int32_t end_ = 0;
};

/// A buffer for ranges of elements of one size, which grows and keeps its content. GPU thread.
class Arena {
 public:
  /// `most_bytes`: greatest size of the buffer.
  Arena(int64_t element_bytes, int64_t most_bytes)
      : element_bytes_(element_bytes), most_bytes_(most_bytes) {}

  bool has_room(size_t count) const;
  /// Adds `count` elements and returns the index of the first. @throws std::length_error without
  /// room.
  int32_t add(const void* elements, size_t count);
  template <typename Element>
  int32_t add(const std::vector<Element>& elements) {
    return add(elements.data(), elements.size());
  }
  void write(int32_t first, const void* elements, size_t count);
  void remove(int32_t first, size_t count) { ranges_.remove(first, static_cast<int32_t>(count)); }
  const gpu::Buffer& buffer() const { return buffer_; }
  /// Greatest number of elements.
  size_t most() const { return static_cast<size_t>(most_bytes_ / element_bytes_); }

 private:
  int64_t element_bytes_;
  int64_t most_bytes_;
  Ranges ranges_;
  gpu::Buffer buffer_{0};
};

/// Largest storage block of the driver in bytes, at most 2 GiB - 1.
int64_t largest_block();

}  // namespace snowbough::render
