#include "snow/level_seams.h"

#include <algorithm>
#include <cmath>

namespace snowbough::snow {

SeamLeveller::SeamLeveller(const SeamLevelling& levelling)
    : texel_(levelling.gaps.source),
      least_height_(levelling.least_height),
      points_(levelling.gaps.size()) {
  std::sort(texel_.begin(), texel_.end());
  texel_.erase(std::unique(texel_.begin(), texel_.end()), texel_.end());
  first_copy_ = texel_.size();
  // Per texel: its row of corrections, or -1.
  std::vector<int32_t> row(texel_.size(), -1);
  const auto index = [&](int32_t texel) {
    const auto end = texel_.begin() + static_cast<ptrdiff_t>(first_copy_);
    return static_cast<int32_t>(std::lower_bound(texel_.begin(), end, texel) - texel_.begin());
  };
  for (size_t i = 0; i < levelling.texel.size(); ++i) {
    row[index(levelling.texel[i])] = static_cast<int32_t>(i);
  }
  const WeightedRows& gaps = levelling.gaps;
  const WeightedRows& corrections = levelling.corrections;
  /// The weight by which a texel takes the point's difference; 0 if it does not.
  const auto correction = [&](int32_t texel, int32_t point) {
    if (row[texel] < 0) return 0.0f;
    const auto first = corrections.source.begin() + corrections.begin[row[texel]];
    const auto last = corrections.source.begin() + corrections.begin[row[texel] + 1];
    const auto found = std::lower_bound(first, last, point);
    return found != last && *found == point ? corrections.weight[found - corrections.source.begin()]
                                            : 0.0f;
  };
  scale_.resize(texel_.size(), 0.0f);
  for (size_t p = 0; p < gaps.size(); ++p) {
    // A side is read between four texels.
    for (int32_t t = gaps.begin[p]; t < gaps.begin[p + 1]; ++t) {
      const int32_t k = t - gaps.begin[p];
      int32_t source = index(gaps.source[t]);
      const float taken = correction(source, static_cast<int32_t>(p));
      if (taken != 0.0f && gaps.weight[t] != 0.0f) {
        // The same for all of a texel's points, but for rounding.
        if (scale_[source] == 0.0f) scale_[source] = taken / gaps.weight[t];
      } else {
        copy_of_.push_back(source);
        texel_.push_back(gaps.source[t]);
        source = static_cast<int32_t>(texel_.size()) - 1;
      }
      points_[p].source[k] = source;
      points_[p].weight[k] = gaps.weight[t];
    }
  }
  scale_.resize(texel_.size(), 0.0f);
  heights_.resize(texel_.size());
  changes_.resize(texel_.size(), 0.0f);
  texel_marks_.resize(texel_.size(), 0.0f);
}

void SeamLeveller::refresh_copies(std::vector<float>& heights) const {
  for (size_t i = 0; i < copy_of_.size(); ++i) heights[first_copy_ + i] = heights[copy_of_[i]];
}

inline void SeamLeveller::spread(const Point& point, float share,
                                 const std::vector<float>& heights) {
  float gap = 0.0f;
  for (size_t k = 0; k < kTerms; ++k) gap += point.weight[k] * heights[point.source[k]];
  gap *= share;
  for (size_t k = 0; k < kTerms; ++k) changes_[point.source[k]] += point.weight[k] * gap;
}

inline float SeamLeveller::changed(size_t texel, const std::vector<float>& heights) {
  const float change = scale_[texel] * changes_[texel];
  changes_[texel] = 0.0f;
  return std::max(0.0f, heights[texel] + change);
}

/// 0 where the sides differ by less than kLevelWithin of the height there, 1 at twice that.
float SeamLeveller::mark_of(const Point& point) const {
  float gap = 0.0f;
  float height = 0.0f;
  for (size_t k = 0; k < kTerms; ++k) {
    const float part = point.weight[k] * heights_[point.source[k]];
    gap += part;
    height += std::fabs(part);
  }
  const float allowed = kLevelWithin * std::max(height, least_height_);
  return std::clamp(2.0f * std::fabs(gap) / allowed - 1.0f, 0.0f, 1.0f);
}

/// Marks the texels that change for a point whose sides differ by too much.
void SeamLeveller::mark() {
  std::fill(texel_marks_.begin(), texel_marks_.end(), 0.0f);
  for (const Point& point : points_) {
    const float mark = mark_of(point);
    if (mark == 0.0f) continue;
    for (size_t k = 0; k < kTerms; ++k) {
      float& most = texel_marks_[point.source[k]];
      if (point.weight[k] != 0.0f && mark > most) most = mark;
    }
  }
  for (size_t i = 0; i < copy_of_.size(); ++i) texel_marks_[first_copy_ + i] = 0.0f;
  refresh_copies(texel_marks_);
}

/// Takes the points that look at a marked texel, and all texels that those look at.
void SeamLeveller::take_marked() {
  fine_points_.clear();
  fine_shares_.clear();
  fine_texels_.clear();
  for (const Point& point : points_) {
    float share = 0.0f;
    for (size_t k = 0; k < kTerms; ++k) {
      const float mark = texel_marks_[point.source[k]];
      if (point.weight[k] != 0.0f) share = std::max(share, mark);
    }
    if (share == 0.0f) continue;
    fine_points_.push_back(point);
    fine_shares_.push_back(share);
  }
  std::fill(texel_marks_.begin(), texel_marks_.end(), 0.0f);
  for (const Point& point : fine_points_) {
    for (const int32_t source : point.source) texel_marks_[source] = 1.0f;
  }
  for (size_t i = 0; i < first_copy_; ++i) {
    if (texel_marks_[i] > 0.0f) fine_texels_.push_back(static_cast<int32_t>(i));
  }
}

void SeamLeveller::run(std::vector<float>& map) {
  for (size_t i = 0; i < texel_.size(); ++i) heights_[i] = map[texel_[i]];
  for (const Point& point : points_) spread(point, 1.0f, heights_);
  for (size_t i = 0; i < first_copy_; ++i) heights_[i] = changed(i, heights_);
  refresh_copies(heights_);
  mark();
  take_marked();
  ahead_ = heights_;
  start_ = heights_;
  for (int32_t round = 0; round < kFineRounds; ++round) {
    for (size_t p = 0; p < fine_points_.size(); ++p)
      spread(fine_points_[p], fine_shares_[p], ahead_);
    for (const int32_t at : fine_texels_) {
      const auto texel = static_cast<size_t>(at);
      const float reach = kMostChange * (start_[texel] + least_height_);
      const float next = std::clamp(changed(texel, ahead_), std::max(0.0f, start_[texel] - reach),
                                    start_[texel] + reach);
      ahead_[texel] = std::max(0.0f, next + fine_momentum(round) * (next - heights_[texel]));
      heights_[texel] = next;
    }
    refresh_copies(ahead_);
  }
  std::fill(changes_.begin(), changes_.end(), 0.0f);
  for (size_t i = 0; i < first_copy_; ++i) map[texel_[i]] = heights_[i];
}

}  // namespace snowbough::snow
