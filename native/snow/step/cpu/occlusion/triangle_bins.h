#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

#include "snow/scene/projection.h"
#include "snow/step/cpu/occlusion/occlusion_scene.h"

namespace snowbough::snow::cpu {

/// Edge of a bin in pixels: these stay in a core's cache while its triangles are drawn.
inline constexpr int32_t kBinSize = 64;

/// Which triangles may show in which square of kBinSize pixels. Counts, sums up and fills, so that
/// bins hold their triangles in drawing order whatever the number of threads. Keeps its memory from
/// one use to the next.
class TriangleBins {
 public:
  struct Input {
    /// Three a triangle, of the triangle set-up.
    std::span<const glm::vec4> corners;
    const DrawList& draws;
    /// The draws that are sorted: [first, end).
    int64_t first;
    int64_t end;
    /// The rectangle that the bins divide, from its lower left on.
    PixelRect pixels;
    int32_t threads;
    /// Most draws and most entries of all bins, which take four bytes each.
    int64_t most_entries;
  };

  /// Returns false, and sorts none, where that would take more than `most_entries` and there is
  /// more than one draw.
  /// @throws std::invalid_argument for a rectangle of more than 255 bins a side.
  bool sort(const Input& input);

  /// In columns and rows.
  glm::ivec2 size() const { return size_; }
  /// Draws of a bin, counted from `first`, ascending.
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
  /// Per draw, where its bounds lie.
  std::vector<Box> boxes_;
  /// Per chunk of draws and bin: how many, then where the chunk's next one goes.
  std::vector<int64_t> chunk_bins_;
  std::vector<int64_t> bin_begin_;
  std::vector<uint32_t> entries_;
};

}  // namespace snowbough::snow::cpu
