#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

#include "snow/scene/projection.h"
#include "snow/step/cpu/occlusion/occlusion_scene.h"

namespace snowbough::snow::cpu {

/// Edge of a bin in pixels: its pixels stay in a core's cache while its triangles are drawn.
inline constexpr int32_t kBinSize = 64;

/// Sorts triangles into the squares of kBinSize pixels in which they may show. Counts, sums up and
/// fills, so that bins hold their triangles in drawing order for any number of threads. Keeps its
/// memory between uses. The bins are what threads share out: there is no way to draw without them.
class TriangleBins {
 public:
  struct Input {
    /// Three per triangle, of the triangle set-up.
    std::span<const glm::vec4> corners;
    const DrawList& draws;
    /// The draws to sort: [first, end).
    int64_t first;
    int64_t end;
    /// The rectangle that the bins divide, from its lower left.
    PixelRect pixels;
    int32_t threads;
    /// Maximum number of draws, and of entries of all bins, at four bytes each.
    int64_t most_entries;
  };

  /// Returns false, and sorts nothing, if that would take more than `most_entries` and there is
  /// more than one draw.
  /// @throws std::invalid_argument for a rectangle of more than 255 bins a side.
  bool sort(const Input& input);

  /// In columns and rows.
  glm::ivec2 size() const { return size_; }
  /// A bin's draws, counted from `first`, ascending.
  std::span<const uint32_t> draws_in(glm::ivec2 bin) const;

 private:
  /// Half-open rectangle of bins.
  struct Box {
    uint8_t low_x;
    uint8_t low_y;
    uint8_t high_x;
    uint8_t high_y;
  };

  void count_chunk(const Input& input, size_t chunk);
  void fill_chunk(const Input& input, size_t chunk);
  int64_t place_chunks(size_t chunks);
  int64_t* bins_of(size_t chunk) {
    return chunk_bins_.data() + chunk * static_cast<size_t>(size_.x * size_.y);
  }

  glm::ivec2 size_{0};
  /// Bounds of each draw, in bins.
  std::vector<Box> boxes_;
  /// Per chunk of draws and bin: the count, then the position of the chunk's next entry.
  std::vector<int64_t> chunk_bins_;
  std::vector<int64_t> bin_begin_;
  std::vector<uint32_t> entries_;
};

}  // namespace snowbough::snow::cpu
