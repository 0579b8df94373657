#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "snow/seams/number_set.h"
#include "snow/seams/seam_layout.h"

namespace snowbough::snow {

/// Finds the points of a map whose sides differ too much relative to their height, and marks the
/// unknowns that they read. A mark, over 0 to 1, is the participation of a texel in the refinement.
/// It grows continuously from 0 at the allowed difference, so that rounding differences do not
/// change the map.
class SeamMarks {
 public:
  /// A point that reads a marked texel, and the weight of its difference, per metre.
  struct Point {
    int32_t point;
    float share;
  };

  explicit SeamMarks(std::shared_ptr<const SeamLayout> layout);

  /// Begins a map: forgets the points of the last one.
  void clear();
  /// Adds a point that has snow beside it, or that reads a texel which changes for other points.
  void add_point(int32_t point);
  bool has_point(int32_t point) const { return index_[static_cast<size_t>(point)] >= 0; }

  /// Marks the texels again. Between two calls only the heights of marked texels and of other
  /// charts' texels may change.
  void update(const std::vector<float>& heights);
  /// The unknowns with a mark, possibly some that have lost it, ascending.
  const std::vector<int32_t>& texels() const { return marked_; }
  float mark(int32_t texel) const { return mark_[static_cast<size_t>(texel)]; }
  void remove(int32_t texel) { mark_[static_cast<size_t>(texel)] = 0.0f; }
  /// The points of the map that read a marked texel, ascending by when they were added.
  const std::vector<Point>& points() const { return points_; }

  int64_t bytes() const;

 private:
  struct SnowPoint {
    int32_t point;
    /// Mean height of its sides, at least least_height, when it was evaluated.
    float height;
  };

  void mark_texels(SnowPoint& of, const std::vector<float>& heights);
  void select_points();

  std::shared_ptr<const SeamLayout> layout_;
  std::vector<SnowPoint> snow_;
  /// Per point: its index in snow_; -1: none.
  std::vector<int32_t> index_;
  /// Indices into snow_: of points that read other charts' texels; of points that may have changed,
  /// those that read a marked texel first.
  std::vector<int32_t> foreign_;
  std::vector<int32_t> changed_;
  NumberSet active_bits_;
  bool is_first_ = true;
  /// Per texel.
  std::vector<float> mark_;
  std::vector<int32_t> marked_;
  NumberSet marked_bits_;
  std::vector<Point> points_;
};

}  // namespace snowbough::snow
