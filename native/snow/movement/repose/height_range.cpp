#include "snow/movement/repose/height_range.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "base/simd.h"
#include "snow/movement/repose/window.h"

namespace snowbough::snow {
namespace {

/// Extremes over the columns of a block: heights, and differences of thickness.
struct HeightExtremes {
  std::array<float, kReposeBlock> low{}, high{}, step{};
};

/// Adds a row of cells and those across their links; `height`: of the first cell in the window.
SNOWBOUGH_WIDE void add_heights(const float* height, const uint8_t* __restrict forward,
                                HeightExtremes& extremes) {
  float* __restrict const low = extremes.low.data();
  float* __restrict const high = extremes.high.data();
  float* __restrict const step = extremes.step.data();
  std::array<int32_t, kReposeBlock> bits;
  std::array<float, kReposeBlock> own;
  for (int32_t i = 0; i < kReposeBlock; ++i) bits[i] = forward[i];
  for (int32_t i = 0; i < kReposeBlock; ++i) {
    own[i] = (bits[i] & kHasTexel) != 0 ? height[i] : 0.0f;
    low[i] = std::min(low[i], own[i]);
    high[i] = std::max(high[i], own[i]);
  }
  for (int32_t k = 0; k < kForwardLinks; ++k) {
    const float* const beside = height + TileWindow::step(k);
    for (int32_t i = 0; i < kReposeBlock; ++i) {
      const float there = beside[i];
      const float other = (bits[i] & (1 << k)) != 0 ? there : own[i];
      low[i] = std::min(low[i], other);
      high[i] = std::max(high[i], other);
      step[i] = std::max(step[i], std::abs(std::abs(own[i]) - std::abs(other)));
    }
  }
}

/// The same for a link across a seam.
void add_heights(float own, float other, HeightExtremes& extremes) {
  extremes.low[0] = std::min({extremes.low[0], own, other});
  extremes.high[0] = std::max({extremes.high[0], own, other});
  extremes.step[0] = std::max(extremes.step[0], std::abs(std::abs(own) - std::abs(other)));
}

/// Copies the map's heights to the window of a block; 0 outside the map.
void load_window(const ReposeLinks& links, int32_t block, const float* height,
                 TileWindow::Plane& window) {
  const int32_t size = links.resolution;
  const int32_t left = block % links.blocks_a_side * kReposeBlock;
  const int32_t first = block / links.blocks_a_side * kReposeBlock;
  const int32_t begin = std::max(left - 1, 0);
  const int32_t end = std::min(left + kReposeBlock + 1, size);
  for (int32_t row = 0; row < TileWindow::kRows; ++row) {
    float* const own = &window[TileWindow::at(-1, row)];
    if (first + row >= size || end - begin < kReposeBlock + 2) {
      std::fill_n(own, kReposeBlock + 2, 0.0f);
    }
    if (first + row >= size) continue;
    const size_t place =
        static_cast<size_t>(first + row) * static_cast<size_t>(size) + static_cast<size_t>(begin);
    std::copy_n(height + place, end - begin, own + (begin - left + 1));
  }
}

SNOWBOUGH_WIDE uint32_t highest_bits(const float* height, size_t pitch, glm::ivec2 size) {
  // Non-negative floats sort like their bits, which vectorise better.
  uint32_t high = 0;
  for (int32_t row = 0; row < size.y; ++row) {
    const float* const own = height + static_cast<size_t>(row) * pitch;
    for (int32_t i = 0; i < size.x; ++i) {
      const uint32_t bits = std::bit_cast<uint32_t>(own[i]) & 0x7FFFFFFFu;
      high = bits > high ? bits : high;
    }
  }
  return high;
}

}  // namespace

HeightRange find_height_range(const ReposeLinks& links, const std::vector<int32_t>& places,
                              int32_t block, const float* height) {
  TileWindow::Plane window;
  load_window(links, block, height, window);
  HeightExtremes extremes;
  for (int32_t row = 0; row < kReposeBlock; ++row) {
    add_heights(&window[TileWindow::at(0, row)], links.forward_of(block) + row * kReposeBlock,
                extremes);
  }
  const auto height_at = [&](int32_t texel) { return height[places[static_cast<size_t>(texel)]]; };
  const int32_t* ends = &links.end_begin[static_cast<size_t>(block)];
  for (int32_t e = ends[0]; e < ends[1]; ++e) {
    const ReposeLinks::End& end = links.ends[static_cast<size_t>(e)];
    if (end.sign > 0 || static_cast<size_t>(end.link) >= links.across.size()) continue;
    const int32_t other = links.across[static_cast<size_t>(end.link)].b;
    add_heights(height_at(end.texel), height_at(other), extremes);
  }
  const float low = *std::min_element(extremes.low.begin(), extremes.low.end());
  const float high = *std::max_element(extremes.high.begin(), extremes.high.end());
  const float step = *std::max_element(extremes.step.begin(), extremes.step.end());
  return {std::max(-low, high), step, high > 0.0f, low < 0.0f};
}

float highest_of(const float* height, size_t pitch, glm::ivec2 size) {
  return std::bit_cast<float>(highest_bits(height, pitch, size));
}

}  // namespace snowbough::snow
