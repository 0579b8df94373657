#pragma once

#include <algorithm>
#include <cstdint>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

#include "shaders/lib/snow_shared.h"
#include "snow/scene/triangle_range.h"

namespace snowbough::snow::cpu {

/// The alpha masks that cut holes into triangles, as in the scene's buffers.
struct AlphaImages {
  std::span<const shared::AlphaTriangle> triangles;
  std::span<const shared::AlphaMaskHeader> masks;
  std::span<const uint32_t> bits;
};

/// The triangles to draw for occlusion.
struct OcclusionScene {
  /// Three per triangle, of the triangle set-up. A triangle with a corner that is not finite is not
  /// drawn.
  std::span<const glm::vec4> corners;
  /// Drawn in order, which decides between coincident surfaces.
  std::span<const TriangleRange> ranges;
  /// Only read for ranges with alpha.
  AlphaImages alpha;
};

/// Triangle ranges one after the other, in drawing order. A draw is an index into the result.
class DrawList {
 public:
  /// `ranges` live as long as the list.
  explicit DrawList(std::span<const TriangleRange> ranges) : ranges_(ranges), begin_{0} {
    for (const TriangleRange& range : ranges) begin_.push_back(begin_.back() + range.count);
  }

  int64_t size() const { return begin_.back(); }

  /// Finds the triangles of ascending draws.
  class Cursor {
   public:
    explicit Cursor(const DrawList& list) : list_(&list) {}

    /// Advances to `draw`, which must be below the list's size and not below the last one.
    void move_to(int64_t draw) {
      if (draw >= list_->begin_[at_ + 1]) skip_to(draw);
      triangle_ = list_->ranges_[at_].first + (draw - list_->begin_[at_]);
    }
    const TriangleRange& range() const { return list_->ranges_[at_]; }
    int64_t triangle() const { return triangle_; }

   private:
    void skip_to(int64_t draw) {
      const std::vector<int64_t>& begin = list_->begin_;
      const auto from = begin.begin() + static_cast<ptrdiff_t>(at_) + 1;
      at_ = static_cast<size_t>(std::upper_bound(from, begin.end(), draw) - begin.begin()) - 1;
    }

    const DrawList* list_;
    size_t at_ = 0;
    int64_t triangle_ = 0;
  };

 private:
  std::span<const TriangleRange> ranges_;
  /// First draw of each range, and the end.
  std::vector<int64_t> begin_;
};

}  // namespace snowbough::snow::cpu
