#include "snow/seams/seam_leveller.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

#include "snow/seams/seam_gradients.h"

namespace snowbough::snow {
namespace {

/// Weight of a change of the map relative to a remaining difference: in the first problem (both in
/// metres), then in the second (both relative to the height).
constexpr float kDamping = 0.05f;
constexpr float kFineDamping = 0.0005f;
/// Allowed difference of the sides as a fraction of the height at a seam, and the additional
/// fraction at which a texel participates fully; heights under least_height count as least_height.
constexpr float kLevelWithin = 0.008f;
constexpr float kLevelFade = 0.002f;
/// Maximum work for a factor, in multiplications: for the one made once (about two seconds), and
/// for the one made for every map.
constexpr int64_t kMostWork = int64_t{1} << 29;
constexpr int64_t kMostFineWork = int64_t{1} << 26;
/// Maximum number of repeats of the second problem for points that still differ too much: the fit
/// for the thinnest snow moves thicker snow beside it apart again.
constexpr int32_t kMostRepeats = 3;
/// Fraction of the texels that may remain for another repeat: where snow ends on a seam, no heights
/// make the sides equal, and repeats do not help.
constexpr double kWorthRepeating = 0.95;
/// Maximum number of repeats of the second problem for unknowns connected to texels at their
/// limits.
constexpr int32_t kMostLimited = 2;
/// Rounds of conjugate gradients if there is no factor.
constexpr int32_t kRounds = 20;
constexpr int32_t kFineRounds = 30;
/// In the first problem, changes below this fraction of least_height are not propagated.
constexpr float kNegligible = 1e-5f;

/// Renumbers the points' texels, except the last number.
void renumber(std::vector<SeamRow>& points, const std::vector<int32_t>& number) {
  std::array<std::pair<int32_t, float>, kSeamTerms> terms;
  for (SeamRow& point : points) {
    for (int32_t t = 0; t < kSeamTerms; ++t) {
      terms[t] = {number[point.source[t]], point.weight[t]};
    }
    std::sort(terms.begin(), terms.end());
    for (int32_t t = 0; t < kSeamTerms; ++t) {
      std::tie(point.source[t], point.weight[t]) = terms[t];
    }
  }
}

}  // namespace

SeamLeveller::SeamLeveller(const SeamLevelling& levelling)
    : texel_(levelling.texel),
      unknowns_(levelling.unknowns),
      least_height_(levelling.least_height),
      points_(levelling.points),
      heights_(texel_.size() + 1, 0.0f),
      limits_(texel_.size() + 1, 0.0f),
      lower_limits_(texel_.size() + 1, 0.0f),
      values_(texel_.size() + 1, 0.0f),
      marks_(texel_.size() + 1, 0.0f),
      reach_(texel_.size() + 1, 0.0f),
      is_seen_(texel_.size() + 1, 0) {
  std::vector<int32_t> number(texel_.size() + 1);
  std::iota(number.begin(), number.end(), 0);
  renumber(points_, number);
  const std::vector<int32_t> order = SeamFactor::elimination_order(points_, unknowns_);
  for (int32_t k = 0; k < unknowns_; ++k) {
    number[order[k]] = k;
    texel_[k] = levelling.texel[order[k]];
  }
  renumber(points_, number);
  const auto own_end = levelling.texel.begin() + unknowns_;
  for (auto i = static_cast<size_t>(unknowns_); i < texel_.size(); ++i) {
    const auto own = std::lower_bound(levelling.texel.begin(), own_end, texel_[i]);
    if (own == own_end || *own != texel_[i]) continue;
    foreign_.emplace_back(static_cast<int32_t>(i), number[own - levelling.texel.begin()]);
  }
  sample_begin_.assign(static_cast<size_t>(unknowns_) + 2, 0);
  const auto for_each_sample = [&](const auto& visit) {
    for (size_t p = 0; p < points_.size(); ++p) {
      for (const int32_t texel : points_[p].source) {
        if (texel < unknowns_) visit(texel, static_cast<int32_t>(p));
      }
    }
  };
  // Shifted by one place, so that the second pass leaves the offsets in their final places.
  for_each_sample([&](int32_t texel, int32_t) { ++sample_begin_[texel + 2]; });
  std::partial_sum(sample_begin_.begin(), sample_begin_.end(), sample_begin_.begin());
  samples_.resize(static_cast<size_t>(sample_begin_.back()));
  for_each_sample([&](int32_t texel, int32_t p) { samples_[sample_begin_[texel + 1]++] = p; });
  residual_of_.assign(points_.size(), -1);
  marked_bits_.resize(static_cast<size_t>(unknowns_));
  active_bits_.resize(points_.size());
  pattern_ = std::make_shared<const SeamPattern>(points_, unknowns_);
  factor_.emplace(pattern_);
  fine_factor_.emplace(pattern_);
  std::iota(number.begin(), number.end(), 0);
  number.resize(static_cast<size_t>(unknowns_));
  factor_->begin(number, kDamping);
  for (size_t p = 0; p < points_.size(); ++p) factor_->add(static_cast<int32_t>(p), points_[p]);
  factorised_ = factor_->factorise(kMostWork);
  factor_->shrink();
}

inline SeamLeveller::SeamResidual SeamLeveller::residual_at(int32_t point) const {
  const SeamRow& row = points_[point];
  SeamResidual residual{point, true, 0.0f, 0.0f};
  for (int32_t t = 0; t < kSeamTerms; ++t) {
    const float part = row.weight[t] * heights_[row.source[t]];
    residual.gap += part;
    residual.height += std::fabs(part);
  }
  return residual;
}

void SeamLeveller::level_all() {
  std::fill(limits_.begin(), limits_.end(), 0.0f);
  std::fill(lower_limits_.begin(), lower_limits_.end(), 0.0f);
  std::fill(values_.begin(), values_.end(), 0.0f);
  for (const SeamResidual& residual : residuals_) residual_of_[residual.point] = -1;
  residuals_.clear();
  foreign_residuals_.clear();
  bare_.clear();
  for (size_t p = 0; p < points_.size(); ++p) {
    const SeamResidual residual = residual_at(static_cast<int32_t>(p));
    if (residual.height == 0.0f) continue;
    const SeamRow& point = points_[p];
    note(static_cast<int32_t>(p), residual);
    float limit = 0.0f;
    float lower_limit = 0.0f;
    for (const int32_t texel : point.source) {
      limit = std::max(limit, heights_[texel]);
      lower_limit = std::min(lower_limit, heights_[texel]);
      if (heights_[texel] != 0.0f || texel >= unknowns_) continue;
      if (std::exchange(is_seen_[texel], 1) == 0) bare_.push_back(texel);
    }
    for (int32_t t = 0; t < kSeamTerms; ++t) {
      values_[point.source[t]] += point.weight[t] * residual.gap;
      limits_[point.source[t]] = std::max(limits_[point.source[t]], limit);
      lower_limits_[point.source[t]] = std::min(lower_limits_[point.source[t]], lower_limit);
    }
  }
  note_bare_neighbours();
  if (factorised_) {
    factor_->solve(values_, kNegligible * least_height_);
  } else {
    solve_by_rounds(points_, kDamping, kRounds);
  }
  for (int32_t i = 0; i < unknowns_; ++i) {
    heights_[i] = std::clamp(heights_[i] - values_[i], lower_limits_[i], limits_[i]);
  }
  std::fill(values_.begin(), values_.end(), 0.0f);
}

/// Used instead of a factor.
void SeamLeveller::solve_by_rounds(const std::vector<SeamRow>& rows, float damping,
                                   int32_t rounds) {
  values_.resize(static_cast<size_t>(unknowns_));
  solve_by_gradients(rows, static_cast<int32_t>(heights_.size()), damping, rounds, values_);
  values_.resize(heights_.size(), 0.0f);
}

void SeamLeveller::note(int32_t point, const SeamResidual& residual) {
  const auto at = static_cast<int32_t>(residuals_.size());
  residuals_.push_back(residual);
  residual_of_[point] = at;
  if (reads_foreign(points_[point])) foreign_residuals_.push_back(at);
}

/// Adds the points without snow beside them that read a texel which changes for other points: their
/// other side must show the same rise. Points that read a texel with snow are already included.
void SeamLeveller::note_bare_neighbours() {
  for (const int32_t texel : bare_) {
    is_seen_[texel] = 0;
    for (int32_t k = sample_begin_[texel]; k < sample_begin_[texel + 1]; ++k) {
      const int32_t point = samples_[k];
      if (residual_of_[point] < 0) note(point, {point, true, 0.0f, 0.0f});
    }
  }
}

/// Updates the copies of other charts' texels, which change with their own charts.
void SeamLeveller::refresh_foreign() {
  for (const auto& [foreign, own] : foreign_) heights_[foreign] = heights_[own];
}

/// Marks the texels of points whose sides differ too much, and adds the points that read a marked
/// texel.
void SeamLeveller::mark() {
  for (const int32_t texel : marked_) marks_[texel] = 0.0f;
  marked_.clear();
  if (has_marks_) {
    // Unchanged points have no mark: those with one have changed.
    for (const int32_t at : changed_) mark_for(residuals_[at]);
  } else {
    for (SeamResidual& residual : residuals_) mark_for(residual);
  }
  has_marks_ = true;
  marked_bits_.take(marked_);
  activate_points();
}

void SeamLeveller::mark_for(SeamResidual& residual) {
  if (residual.may_differ) {
    residual = residual_at(residual.point);
    residual.height = std::max(0.5f * residual.height, least_height_);
  }
  const float over = std::fabs(residual.gap) / residual.height - kLevelWithin;
  const float mark = std::min(over / kLevelFade, 1.0f);
  if (mark <= 0.0f) return;
  for (const int32_t texel : points_[residual.point].source) {
    if (texel >= unknowns_) continue;
    marked_bits_.add(texel);
    marks_[texel] = std::max(marks_[texel], mark);
  }
}

void SeamLeveller::activate_points() {
  for (const int32_t texel : marked_) {
    for (int32_t k = sample_begin_[texel]; k < sample_begin_[texel + 1]; ++k) {
      const int32_t at = residual_of_[samples_[k]];
      if (at >= 0) active_bits_.add(at);
    }
  }
  for (const int32_t at : changed_) residuals_[at].may_differ = false;
  active_bits_.take(changed_);
  fine_points_.clear();
  for (const int32_t at : changed_) {
    const SeamResidual& residual = residuals_[at];
    float share = 0.0f;
    for (const int32_t texel : points_[residual.point].source) {
      share = std::max(share, marks_[texel]);
    }
    fine_points_.push_back({residual.point, share / residual.height});
  }
  changed_.insert(changed_.end(), foreign_residuals_.begin(), foreign_residuals_.end());
  for (const int32_t at : changed_) residuals_[at].may_differ = true;
}

bool SeamLeveller::reads_foreign(const SeamRow& point) const {
  const auto none = static_cast<int32_t>(texel_.size());
  return std::any_of(point.source.begin(), point.source.end(),
                     [&](int32_t texel) { return texel >= unknowns_ && texel < none; });
}

/// Change of a texel's height per unit of the second problem's solution.
inline float SeamLeveller::fine_reach(int32_t texel) const {
  return marks_[texel] * (std::fabs(heights_[texel]) + least_height_);
}

/// Selects the marked texels for the second problem.
void SeamLeveller::begin_refinement() {
  for (const int32_t i : fine_texels_) reach_[i] = values_[i] = 0.0f;
  fine_texels_.clear();
  for (const int32_t i : marked_) {
    if (marks_[i] == 0.0f) continue;
    fine_texels_.push_back(i);
    reach_[i] = fine_reach(i);
  }
}

/// Calls visit(point, row) for the rows of the second problem, and sums up their right-hand side.
template <typename Visit>
void SeamLeveller::for_each_fine_row(const Visit& visit) {
  SeamRow row;
  for (const FinePoint& fine : fine_points_) {
    const SeamRow& point = points_[fine.point];
    row.source = point.source;
    float gap = 0.0f;
    float reach = 0.0f;
    for (int32_t t = 0; t < kSeamTerms; ++t) {
      row.weight[t] = fine.share * point.weight[t] * reach_[point.source[t]];
      gap += point.weight[t] * heights_[point.source[t]];
      reach += reach_[point.source[t]];
    }
    if (reach == 0.0f) continue;
    for (int32_t t = 0; t < kSeamTerms; ++t) {
      values_[row.source[t]] += row.weight[t] * (fine.share * gap);
    }
    visit(fine.point, row);
  }
}

/// Returns whether the solution is exact.
bool SeamLeveller::solve_fine() {
  fine_factor_->begin(fine_texels_, kFineDamping);
  for_each_fine_row([&](int32_t point, const SeamRow& row) { fine_factor_->add(point, row); });
  if (fine_factor_->factorise(kMostFineWork)) {
    fine_factor_->solve(values_, 0.0f);
    return true;
  }
  std::fill(values_.begin(), values_.end(), 0.0f);
  std::vector<SeamRow> rows;
  for_each_fine_row([&](int32_t, const SeamRow& row) { rows.push_back(row); });
  solve_by_rounds(rows, kFineDamping, kFineRounds);
  return false;
}

/// Solves the second problem again for its texels that still have a mark: the matrix is a part of
/// the last one, since their heights have not changed.
void SeamLeveller::solve_remaining() {
  begin_refinement();
  if (fine_texels_.empty()) return;
  for_each_fine_row([](int32_t, const SeamRow&) {});
  fine_factor_->keep(fine_texels_);
  fine_factor_->solve(values_, 0.0f);
}

/// A texel's height from the second problem's solution, unlimited and limited.
inline std::pair<float, float> SeamLeveller::fine_height(int32_t texel) const {
  const float height = heights_[texel] - reach_[texel] * values_[texel];
  return {height, std::clamp(height, lower_limits_[texel], limits_[texel])};
}

/// Accepts the heights of components within their limits; texels beyond stay at their limits, and
/// the rest of their components remain. Accepted texels lose their mark. Returns whether any
/// remain.
bool SeamLeveller::accept_within_limits() {
  const std::vector<int32_t> component = fine_factor_->components();
  std::vector<int32_t> remaining;
  for (size_t k = 0; k < fine_texels_.size(); ++k) {
    const auto [height, limited] = fine_height(fine_texels_[k]);
    if (height == limited || std::exchange(is_seen_[component[k]], 1) != 0) continue;
    remaining.push_back(component[k]);
  }
  for (size_t k = 0; k < fine_texels_.size(); ++k) {
    const int32_t texel = fine_texels_[k];
    const auto [height, limited] = fine_height(texel);
    if (is_seen_[component[k]] != 0 && height == limited) continue;
    heights_[texel] = limited;
    marks_[texel] = 0.0f;
  }
  for (const int32_t texel : remaining) is_seen_[texel] = 0;
  return !remaining.empty();
}

size_t SeamLeveller::refine() {
  mark();
  begin_refinement();
  const size_t count = fine_texels_.size();
  if (count == 0) return 0;
  if (solve_fine()) {
    for (int32_t trial = 0; trial < kMostLimited; ++trial) {
      if (!accept_within_limits()) return count;
      solve_remaining();
      if (fine_texels_.empty()) return count;
    }
  }
  for (const int32_t texel : fine_texels_) heights_[texel] = fine_height(texel).second;
  return count;
}

void SeamLeveller::run(std::vector<float>& map) {
  for (size_t i = 0; i < texel_.size(); ++i) heights_[i] = map[texel_[i]];
  level_all();
  refresh_foreign();
  has_marks_ = false;
  size_t left = refine();
  for (int32_t repeat = 0; repeat < kMostRepeats && left > 0; ++repeat) {
    refresh_foreign();
    const size_t before = left;
    left = refine();
    if (static_cast<double>(left) > kWorthRepeating * static_cast<double>(before)) break;
  }
  for (int32_t i = 0; i < unknowns_; ++i) map[texel_[i]] = heights_[i];
}

int64_t SeamLeveller::bytes() const {
  const auto of = [](const auto& values) {
    return static_cast<int64_t>(values.capacity() * sizeof(values[0]));
  };
  return of(texel_) + of(points_) + of(heights_) + of(values_) + of(residuals_) + of(marks_) +
         of(reach_) + of(is_seen_) + of(bare_) + of(marked_) + of(sample_begin_) + of(samples_) +
         of(residual_of_) + of(foreign_residuals_) + of(changed_) + of(foreign_) +
         of(fine_texels_) + of(fine_points_) + of(limits_) + of(lower_limits_) + pattern_->bytes() +
         factor_->bytes() + fine_factor_->bytes();
}

}  // namespace snowbough::snow
