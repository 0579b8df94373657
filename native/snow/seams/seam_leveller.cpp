#include "snow/seams/seam_leveller.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace snowbough::snow {
namespace {

/// Weight of a change of the map relative to a remaining difference, both in metres.
constexpr float kDamping = 0.05f;
/// Maximum work for the factor, in multiplications (about two seconds).
constexpr int64_t kMaxWork = int64_t{1} << 29;
/// Rounds of conjugate gradients if there is no factor.
constexpr int32_t kRounds = 20;
/// Changes below this fraction of least_height are not propagated.
constexpr float kNegligible = 1e-5f;
/// Maximum number of repeats of the second problem for points that still differ too much: the fit
/// for the thinnest snow moves thicker snow beside it apart again.
constexpr int32_t kMaxRepeats = 3;
/// Fraction of the texels that may remain for another repeat: where snow ends on a seam, no heights
/// make the sides equal, and repeats do not help.
constexpr double kWorthRepeating = 0.95;

}  // namespace

SeamLeveller::SeamLeveller(const SeamLevelling& levelling)
    : layout_(std::make_shared<const SeamLayout>(levelling)),
      heights_(*layout_),
      marks_(layout_),
      refinement_(layout_),
      factor_(layout_->pattern()),
      values_(layout_->values(), 0.0f),
      is_bare_(layout_->values(), 0) {
  std::vector<int32_t> all(static_cast<size_t>(layout_->unknowns()));
  std::iota(all.begin(), all.end(), 0);
  factor_.begin(all, kDamping);
  const std::vector<SeamRow>& points = layout_->points();
  for (size_t p = 0; p < points.size(); ++p) factor_.add(static_cast<int32_t>(p), points[p]);
  factorised_ = factor_.factorise(kMaxWork);
  factor_.shrink();
}

/// Collects the map's points with snow, the range of each texel, and the right-hand side.
void SeamLeveller::collect_points() {
  std::fill(heights_.highest.begin(), heights_.highest.end(), 0.0f);
  std::fill(heights_.lowest.begin(), heights_.lowest.end(), 0.0f);
  std::fill(values_.begin(), values_.end(), 0.0f);
  marks_.clear();
  bare_.clear();
  const std::vector<float>& height = heights_.height;
  for (size_t p = 0; p < layout_->points().size(); ++p) {
    const SeamRow& point = layout_->points()[p];
    const SeamGap found = seam_gap(point, height);
    if (found.sum == 0.0f) continue;
    marks_.add_point(static_cast<int32_t>(p));
    float highest = 0.0f;
    float lowest = 0.0f;
    for (const int32_t texel : point.source) {
      highest = std::max(highest, height[texel]);
      lowest = std::min(lowest, height[texel]);
      if (height[texel] != 0.0f || texel >= layout_->unknowns()) continue;
      if (std::exchange(is_bare_[texel], 1) == 0) bare_.push_back(texel);
    }
    for (int32_t t = 0; t < kSeamTerms; ++t) {
      const int32_t texel = point.source[t];
      values_[texel] += point.weight[t] * found.gap;
      heights_.highest[texel] = std::max(heights_.highest[texel], highest);
      heights_.lowest[texel] = std::min(heights_.lowest[texel], lowest);
    }
  }
  add_bare_neighbours();
}

/// Adds the points without snow beside them that read a texel which changes for other points: their
/// other side must show the same rise. Points that read a texel with snow are already included.
void SeamLeveller::add_bare_neighbours() {
  for (const int32_t texel : bare_) {
    is_bare_[texel] = 0;
    for (const int32_t point : layout_->points_of(texel)) {
      if (!marks_.has_point(point)) marks_.add_point(point);
    }
  }
}

/// Solves the first problem.
void SeamLeveller::level_all() {
  if (factorised_) {
    factor_.solve(values_, kNegligible * layout_->least_height());
  } else {
    solve_by_rounds(*layout_, layout_->points(), kDamping, kRounds, values_);
  }
  for (int32_t i = 0; i < layout_->unknowns(); ++i) {
    heights_.height[i] =
        std::clamp(heights_.height[i] - values_[i], heights_.lowest[i], heights_.highest[i]);
  }
}

void SeamLeveller::run(std::vector<float>& map) {
  const std::vector<int32_t>& texels = layout_->texels();
  for (size_t i = 0; i < texels.size(); ++i) heights_.height[i] = map[texels[i]];
  collect_points();
  level_all();
  size_t left = 0;
  for (int32_t repeat = 0; repeat <= kMaxRepeats; ++repeat) {
    layout_->refresh_foreign(heights_.height);
    marks_.update(heights_.height);
    const size_t before = std::exchange(left, refinement_.run(marks_, heights_));
    if (left == 0) break;
    const double most = kWorthRepeating * static_cast<double>(before);
    if (repeat > 0 && static_cast<double>(left) > most) break;
  }
  for (int32_t i = 0; i < layout_->unknowns(); ++i) map[texels[i]] = heights_.height[i];
}

int64_t SeamLeveller::bytes() const {
  return bytes_of_vectors(heights_.height, heights_.lowest, heights_.highest, values_, bare_,
                          is_bare_) +
         layout_->bytes() + marks_.bytes() + refinement_.bytes() + factor_.bytes();
}

}  // namespace snowbough::snow
