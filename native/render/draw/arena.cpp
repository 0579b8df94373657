#include "render/draw/arena.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <utility>

namespace snowbough::render {

int32_t Ranges::place_for(int32_t count) const {
  for (const auto& [first, free] : gaps_) {
    if (free >= count) return first;
  }
  return end_;
}

int32_t Ranges::add(int32_t count) {
  const int32_t first = place_for(count);
  const auto gap = gaps_.find(first);
  if (gap == gaps_.end()) {
    end_ += count;
  } else {
    const int32_t left = gap->second - count;
    gaps_.erase(gap);
    if (left > 0) gaps_[first + count] = left;
  }
  return first;
}

void Ranges::remove(int32_t first, int32_t count) {
  if (count == 0) return;
  auto next = gaps_.lower_bound(first);
  if (next != gaps_.end() && next->first == first + count) {
    count += next->second;
    next = gaps_.erase(next);
  }
  if (next != gaps_.begin()) {
    const auto before = std::prev(next);
    if (before->first + before->second == first) {
      first = before->first;
      count += before->second;
      gaps_.erase(before);
    }
  }
  if (first + count == end_) {
    end_ = first;
  } else {
    gaps_[first] = count;
  }
}

bool Arena::has_room(size_t count) const {
  const auto added = static_cast<int64_t>(count);
  return added < std::numeric_limits<int32_t>::max() &&
         (ranges_.place_for(static_cast<int32_t>(added)) + added) * element_bytes_ <= most_bytes_;
}

int32_t Arena::add(const void* elements, size_t count) {
  if (!has_room(count)) throw std::length_error("the arena is full");
  const int32_t first = ranges_.add(static_cast<int32_t>(count));
  const int64_t needed = ranges_.end() * element_bytes_;
  if (buffer_.bytes() < needed) {
    gpu::Buffer larger = gpu::Buffer::unfilled(std::max(
        needed, std::min(2 * buffer_.bytes(), most_bytes_ / element_bytes_ * element_bytes_)));
    if (buffer_.bytes() > 0) {
      glCopyNamedBufferSubData(buffer_.id(), larger.id(), 0, 0, buffer_.bytes());
    }
    buffer_ = std::move(larger);
  }
  write(first, elements, count);
  return first;
}

void Arena::write(int32_t first, const void* elements, size_t count) {
  buffer_.write(first * element_bytes_, static_cast<int64_t>(count) * element_bytes_, elements);
}

int64_t largest_block() {
  GLint64 bytes = 0;
  glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &bytes);
  return std::min<int64_t>(bytes, std::numeric_limits<int32_t>::max());
}

}  // namespace snowbough::render
