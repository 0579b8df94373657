#include "snow/step/cpu/occlusion/triangle_bins.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "base/parallel_for.h"
#include "snow/step/cpu/kernel.h"
#include "snow/step/cpu/occlusion/grid_triangle.h"

namespace snowbough::snow::cpu {
namespace {

/// Chunks per thread: some take longer than others.
constexpr int32_t kChunksAThread = 4;
constexpr int32_t kMaxBins = 255;

/// The line through two corners, positive on the triangle's side.
class EdgeLine {
 public:
  EdgeLine(const glm::dvec3& from, const glm::dvec3& to, double turn)
      : x_(from.x), y_(from.y), dx_(turn * (to.x - from.x)), dy_(turn * (to.y - from.y)) {}

  /// Whether a rectangle is on its other side.
  bool leaves_out(const glm::dvec2& low, const glm::dvec2& high) const {
    constexpr double kRounding = 1e-12;
    const double up = dx_ * ((dx_ > 0.0 ? high.y : low.y) - y_);
    const double right = dy_ * ((dy_ > 0.0 ? low.x : high.x) - x_);
    return up - right < -kRounding * (std::abs(up) + std::abs(right));
  }

 private:
  double x_;
  double y_;
  double dx_;
  double dy_;
};

/// The bins in which a triangle may show, more exactly than by its bounds.
class BinTest {
 public:
  BinTest(const glm::vec4* corners, glm::ivec2 low)
      : BinTest(shared::snapped(corners[0]), shared::snapped(corners[1]),
                shared::snapped(corners[2]), low) {}

  bool shows_in(int32_t x, int32_t y) const {
    const glm::dvec2 low = glm::dvec2(low_ + kBinSize * glm::ivec2(x, y)) + 0.5;
    const glm::dvec2 high = low + static_cast<double>(kBinSize - 1);
    return std::none_of(edges_.begin(), edges_.end(),
                        [&](const EdgeLine& edge) { return edge.leaves_out(low, high); });
  }

 private:
  BinTest(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, glm::ivec2 low)
      : BinTest(a, b, c, low, (b.x - a.x) * (c.y - a.y) < (b.y - a.y) * (c.x - a.x) ? -1.0 : 1.0) {}
  BinTest(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, glm::ivec2 low,
          double turn)
      : edges_{EdgeLine(a, b, turn), EdgeLine(b, c, turn), EdgeLine(c, a, turn)}, low_(low) {}

  std::array<EdgeLine, 3> edges_;
  glm::ivec2 low_;
};

/// Calls `work(x, y)` for the bins [low, high) in which the triangle may show.
template <typename Work>
inline void for_bins(const glm::vec4* corners, const PixelRect& pixels, glm::ivec2 low,
                     glm::ivec2 high, const Work& work) {
  // A triangle over few bins usually covers all of them.
  const bool by_bounds = high.x - low.x <= 2 && high.y - low.y <= 2;
  if (by_bounds) {
    for (int32_t y = low.y; y < high.y; ++y) {
      for (int32_t x = low.x; x < high.x; ++x) work(x, y);
    }
    return;
  }
  const BinTest test(corners, pixels.low);
  for (int32_t y = low.y; y < high.y; ++y) {
    for (int32_t x = low.x; x < high.x; ++x) {
      if (test.shows_in(x, y)) work(x, y);
    }
  }
}

size_t chunks_of(const TriangleBins::Input& input) {
  return static_cast<size_t>(kChunksAThread * input.threads);
}

int64_t chunk_begin(const TriangleBins::Input& input, size_t chunk) {
  return input.first + (input.end - input.first) * static_cast<int64_t>(chunk) /
                           static_cast<int64_t>(chunks_of(input));
}

}  // namespace

SNOWBOUGH_KERNEL void TriangleBins::count_chunk(const Input& input, size_t chunk) {
  int64_t* counts = bins_of(chunk);
  DrawList::Cursor cursor(input.draws);
  const int64_t end = chunk_begin(input, chunk + 1);
  for (int64_t draw = chunk_begin(input, chunk); draw < end; ++draw) {
    cursor.move_to(draw);
    const glm::vec4* corners = &input.corners[3 * static_cast<size_t>(cursor.triangle())];
    const PixelRect covered = covered_pixels(corners, input.pixels);
    Box& box = boxes_[static_cast<size_t>(draw - input.first)];
    box = {0, 0, 0, 0};
    if (covered.empty()) continue;
    const glm::ivec2 low = (covered.low - input.pixels.low) / kBinSize;
    const glm::ivec2 high = (covered.high - input.pixels.low - 1) / kBinSize + 1;
    box = {static_cast<uint8_t>(low.x), static_cast<uint8_t>(low.y), static_cast<uint8_t>(high.x),
           static_cast<uint8_t>(high.y)};
    for_bins(corners, input.pixels, low, high,
             [&](int32_t x, int32_t y) { ++counts[y * size_.x + x]; });
  }
}

/// Converts counts to offsets: by bin, then by chunk.
int64_t TriangleBins::place_chunks(size_t chunks) {
  const auto bins = static_cast<size_t>(size_.x * size_.y);
  bin_begin_.resize(bins + 1);
  int64_t next = 0;
  for (size_t bin = 0; bin < bins; ++bin) {
    bin_begin_[bin] = next;
    for (size_t chunk = 0; chunk < chunks; ++chunk) {
      int64_t& own = bins_of(chunk)[bin];
      next += std::exchange(own, next);
    }
  }
  bin_begin_[bins] = next;
  return next;
}

SNOWBOUGH_KERNEL void TriangleBins::fill_chunk(const Input& input, size_t chunk) {
  int64_t* next = bins_of(chunk);
  DrawList::Cursor cursor(input.draws);
  const int64_t end = chunk_begin(input, chunk + 1);
  for (int64_t draw = chunk_begin(input, chunk); draw < end; ++draw) {
    const auto number = static_cast<uint32_t>(draw - input.first);
    const Box box = boxes_[number];
    if (box.high_x == 0) continue;
    cursor.move_to(draw);
    for_bins(&input.corners[3 * static_cast<size_t>(cursor.triangle())], input.pixels,
             {box.low_x, box.low_y}, {box.high_x, box.high_y}, [&](int32_t x, int32_t y) {
               entries_[static_cast<size_t>(next[y * size_.x + x]++)] = number;
             });
  }
}

bool TriangleBins::sort(const Input& input) {
  size_ = (input.pixels.size() + kBinSize - 1) / kBinSize;
  if (size_.x > kMaxBins || size_.y > kMaxBins) {
    throw std::invalid_argument("a tile of " + std::to_string(input.pixels.size().x) + " x " +
                                std::to_string(input.pixels.size().y) + " pixels: draw at most " +
                                std::to_string(kMaxBins * kBinSize) + " per side at once");
  }
  if (input.end - input.first > std::max<int64_t>(input.most_entries, 1)) return false;
  const size_t chunks = chunks_of(input);
  const auto draws = static_cast<size_t>(input.end - input.first);
  if (boxes_.size() < draws) boxes_.resize(draws);
  chunk_bins_.assign(chunks * static_cast<size_t>(size_.x * size_.y), 0);
  base::for_each_item(
      chunks, 1, [&](size_t chunk) { count_chunk(input, chunk); }, input.threads);
  const int64_t total = place_chunks(chunks);
  if (total > input.most_entries && draws > 1) return false;
  if (entries_.size() < static_cast<size_t>(total)) entries_.resize(static_cast<size_t>(total));
  base::for_each_item(
      chunks, 1, [&](size_t chunk) { fill_chunk(input, chunk); }, input.threads);
  return true;
}

std::span<const uint32_t> TriangleBins::draws_in(glm::ivec2 bin) const {
  const auto i = static_cast<size_t>(bin.y * size_.x + bin.x);
  return {entries_.data() + bin_begin_[i], static_cast<size_t>(bin_begin_[i + 1] - bin_begin_[i])};
}

}  // namespace snowbough::snow::cpu
