#include "image/rle_file.h"

#include <half.h>

#include <algorithm>
#include <cstring>
#include <numeric>
#include <utility>
#include <vector>

#include "image/atomic_file.h"
#include "image/rle_line.h"

namespace snowbough::image {
namespace {

/// Converts image rows to the file's lines: channel by channel, sorted by name.
class LineMaker {
 public:
  LineMaker(const ExrLayout& layout, const float* pixels)
      : layout_(layout), pixels_(pixels), channel_(layout.channels.size()) {
    std::iota(channel_.begin(), channel_.end(), size_t{0});
    std::sort(channel_.begin(), channel_.end(),
              [&](size_t a, size_t b) { return layout.channels[a] < layout.channels[b]; });
    const size_t sample = layout.type == ExrPixelType::kHalf ? sizeof(half) : sizeof(float);
    size_ = sample * static_cast<size_t>(layout.width) * channel_.size();
    const bool rows_are_lines = channel_.size() == 1 && layout.type == ExrPixelType::kFloat;
    if (!rows_are_lines) line_.resize(size_);
  }

  size_t size() const { return size_; }

  /// Line `y` from the top (the image's last row first); valid until the next call.
  const uint8_t* line(int32_t y) {
    const size_t count = static_cast<size_t>(layout_.width) * channel_.size();
    const float* row = pixels_ + count * static_cast<size_t>(layout_.height - 1 - y);
    if (line_.empty()) return reinterpret_cast<const uint8_t*>(row);
    uint8_t* out = line_.data();
    for (const size_t channel : channel_) {
      for (size_t at = channel; at < count; at += channel_.size()) {
        out = layout_.type == ExrPixelType::kHalf ? put(half(row[at]).bits(), out)
                                                  : put(row[at], out);
      }
    }
    return line_.data();
  }

 private:
  template <typename Sample>
  static uint8_t* put(Sample sample, uint8_t* out) {
    std::memcpy(out, &sample, sizeof sample);
    return out + sizeof sample;
  }

  const ExrLayout& layout_;
  const float* pixels_;
  std::vector<size_t> channel_;
  size_t size_ = 0;
  /// Empty if rows can be used directly: one channel of floats.
  std::vector<uint8_t> line_;
};

}  // namespace

void write_rle_file(const std::string& path, const ExrLayout& layout, std::string header,
                    const float* pixels) {
  constexpr size_t kWriteBytes = size_t{1} << 18;
  AtomicFile file(path);
  std::string pending = std::move(header);
  const uint64_t table = pending.size();
  std::vector<uint64_t> places(static_cast<size_t>(layout.height));
  pending.append(places.size() * sizeof(uint64_t), '\0');

  LineMaker lines(layout, pixels);
  RleLinePacker packer;
  uint64_t written = 0;
  for (int32_t y = 0; y < layout.height; ++y) {
    places[static_cast<size_t>(y)] = written + pending.size();
    const uint8_t* line = lines.line(y);
    const bool shorter = packer.pack(line, lines.size());
    const size_t size = shorter ? packer.packed_size() : lines.size();
    const int32_t start[2] = {y, static_cast<int32_t>(size)};
    pending.append(reinterpret_cast<const char*>(start), sizeof start);
    pending.append(reinterpret_cast<const char*>(shorter ? packer.packed() : line), size);
    if (pending.size() >= kWriteBytes || y + 1 == layout.height) {
      file.write(pending);
      written += pending.size();
      pending.clear();
    }
  }
  file.overwrite(table,
                 {reinterpret_cast<const char*>(places.data()), places.size() * sizeof(uint64_t)});
  file.publish();
}

}  // namespace snowbough::image
