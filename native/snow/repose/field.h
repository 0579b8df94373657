#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>

#include "snow/repose/links.h"

namespace snowbough::snow {

/// Numbers, all 0 at first. Memory that is never written to is never taken.
template <typename Number>
class LazyArray {
 public:
  LazyArray() = default;
  explicit LazyArray(size_t count)
      : data_(static_cast<Number*>(std::calloc(count, sizeof(Number)))) {
    if (data_ == nullptr) throw std::bad_alloc();
  }
  Number* get() const { return data_.get(); }
  Number& operator[](size_t i) const { return data_.get()[i]; }

 private:
  struct Free {
    void operator()(Number* data) const { std::free(data); }
  };
  std::unique_ptr<Number, Free> data_;
};

inline constexpr uint8_t kWall = 1;
inline constexpr uint8_t kBack = 2;

/// What the rounds of repose reckon with, cell by cell of one receiver's map with a border of one
/// cell around it. Used for one receiver after the other; between them `area` and the flows are 0
/// everywhere.
struct ReposeField {
  int32_t resolution = 0;
  size_t stride = 0;

  /// The bare surface: a point of it in metres, from the object's anchor, and its normal on the
  /// side of the snow; covered area in m2, 0 where there is none.
  LazyArray<float> x, y, z, normal_x, normal_y, normal_z, area;
  /// kWall: it holds nothing; kBack: snow lies or would lie against the normal.
  LazyArray<uint8_t> kind;
  /// Units of volume when the step began, and what has come since: whole numbers.
  LazyArray<float> held;
  LazyArray<double> moved;
  /// Height of the snow's surface in metres, how much a unit lifts it, and what a texel may give to
  /// one link: its share of what it holds.
  LazyArray<float> top, lift, share, gives, stiffness;
  /// Of the links to the forward neighbours: shared::link_limit (infinite: there is none), link_rate
  /// and link_flow.
  LazyArray<float> limit[kForwardLinks], rate[kForwardLinks], flow[kForwardLinks];

  explicit ReposeField(int32_t side)
      : resolution(side), stride(static_cast<size_t>(side) + 2) {
    const size_t cells = stride * stride;
    for (LazyArray<float>* plane : {&x, &y, &z, &normal_x, &normal_y, &normal_z, &area, &held, &top,
                                    &lift, &share, &gives, &stiffness}) {
      *plane = LazyArray<float>(cells);
    }
    for (int32_t k = 0; k < kForwardLinks; ++k) {
      limit[k] = LazyArray<float>(cells);
      rate[k] = LazyArray<float>(cells);
      flow[k] = LazyArray<float>(cells);
    }
    kind = LazyArray<uint8_t>(cells);
    moved = LazyArray<double>(cells);
  }

  size_t cell(int32_t column, int32_t row) const {
    return static_cast<size_t>(row + 1) * stride + static_cast<size_t>(column + 1);
  }
  size_t cell_of(int32_t place) const { return cell(place % resolution, place / resolution); }
  /// Cells from one to its neighbour k.
  ptrdiff_t step(int32_t k) const {
    return kForwardRow[k] * static_cast<ptrdiff_t>(stride) + kForwardColumn[k];
  }
};

}  // namespace snowbough::snow
