#include "snow/seams/seam_marks.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace snowbough::snow {
namespace {

/// Allowed difference of the sides as a fraction of the height at a seam, and the additional
/// fraction at which a texel participates fully; heights under least_height count as least_height.
constexpr float kLevelWithin = 0.008f;
constexpr float kLevelFade = 0.002f;

}  // namespace

SeamMarks::SeamMarks(std::shared_ptr<const SeamLayout> layout)
    : layout_(std::move(layout)),
      index_(layout_->points().size(), -1),
      mark_(layout_->values(), 0.0f) {
  active_bits_.resize(index_.size());
  marked_bits_.resize(static_cast<size_t>(layout_->unknowns()));
}

void SeamMarks::clear() {
  for (const SnowPoint& of : snow_) index_[of.point] = -1;
  snow_.clear();
  foreign_.clear();
  is_first_ = true;
}

void SeamMarks::add_point(int32_t point) {
  const auto at = static_cast<int32_t>(snow_.size());
  snow_.push_back({point, 0.0f});
  index_[point] = at;
  if (layout_->reads_foreign(point)) foreign_.push_back(at);
}

void SeamMarks::update(const std::vector<float>& heights) {
  for (const int32_t texel : marked_) mark_[texel] = 0.0f;
  if (is_first_) {
    for (SnowPoint& of : snow_) mark_texels(of, heights);
  } else {
    // Unchanged points have no mark: those with one have changed.
    for (const int32_t at : changed_) mark_texels(snow_[at], heights);
  }
  is_first_ = false;
  marked_bits_.take(marked_);
  select_points();
}

void SeamMarks::mark_texels(SnowPoint& of, const std::vector<float>& heights) {
  const SeamRow& point = layout_->point(of.point);
  const SeamGap found = seam_gap(point, heights);
  of.height = std::max(0.5f * found.sum, layout_->least_height());
  const float over = std::fabs(found.gap) / of.height - kLevelWithin;
  const float mark = std::min(over / kLevelFade, 1.0f);
  if (mark <= 0.0f) return;
  for (const int32_t texel : point.source) {
    if (texel >= layout_->unknowns()) continue;
    marked_bits_.add(texel);
    mark_[texel] = std::max(mark_[texel], mark);
  }
}

void SeamMarks::select_points() {
  for (const int32_t texel : marked_) {
    for (const int32_t point : layout_->points_of(texel)) {
      if (index_[point] >= 0) active_bits_.add(index_[point]);
    }
  }
  active_bits_.take(changed_);
  points_.clear();
  for (const int32_t at : changed_) {
    const SnowPoint& of = snow_[at];
    float share = 0.0f;
    for (const int32_t texel : layout_->point(of.point).source) {
      share = std::max(share, mark_[texel]);
    }
    points_.push_back({of.point, share / of.height});
  }
  changed_.insert(changed_.end(), foreign_.begin(), foreign_.end());
}

int64_t SeamMarks::bytes() const {
  return bytes_of_vectors(snow_, index_, foreign_, changed_, mark_, marked_, points_);
}

}  // namespace snowbough::snow
