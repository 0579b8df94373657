#include "snow/seams/seam_refinement.h"

#include <algorithm>
#include <cmath>

namespace snowbough::snow {
namespace {

/// Weight of a change of the map relative to a remaining difference, both relative to the height.
constexpr float kFineDamping = 0.0005f;
/// Maximum work for a factor, in multiplications.
constexpr int64_t kMaxFineWork = int64_t{1} << 26;
/// Maximum number of repeats for unknowns connected to texels at their limits.
constexpr int32_t kMaxLimited = 2;
/// Rounds of conjugate gradients if there is no factor.
constexpr int32_t kFineRounds = 30;

}  // namespace

SeamRefinement::SeamRefinement(std::shared_ptr<const SeamLayout> layout)
    : layout_(std::move(layout)),
      factor_(layout_->pattern()),
      values_(layout_->values(), 0.0f),
      reach_(layout_->values(), 0.0f),
      is_seen_(layout_->values(), 0) {}

/// Selects the marked texels.
void SeamRefinement::begin(const SeamMarks& marks, const SeamHeights& heights) {
  for (const int32_t i : texels_) reach_[i] = values_[i] = 0.0f;
  texels_.clear();
  for (const int32_t i : marks.texels()) {
    if (marks.mark(i) == 0.0f) continue;
    texels_.push_back(i);
    reach_[i] = marks.mark(i) * (std::fabs(heights.height[i]) + layout_->least_height());
  }
}

/// Calls visit(point, row) for the rows of the problem, and sums up their right-hand side.
template <typename Visit>
void SeamRefinement::for_each_row(const SeamMarks& marks, const SeamHeights& heights,
                                  const Visit& visit) {
  SeamRow row;
  for (const SeamMarks::Point& fine : marks.points()) {
    const SeamRow& point = layout_->point(fine.point);
    row.source = point.source;
    float gap = 0.0f;
    float reach = 0.0f;
    for (int32_t t = 0; t < kSeamTerms; ++t) {
      row.weight[t] = fine.share * point.weight[t] * reach_[point.source[t]];
      gap += point.weight[t] * heights.height[point.source[t]];
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
bool SeamRefinement::solve(const SeamMarks& marks, const SeamHeights& heights) {
  factor_.begin(texels_, kFineDamping);
  for_each_row(marks, heights, [&](int32_t point, const SeamRow& row) { factor_.add(point, row); });
  if (factor_.factorise(kMaxFineWork)) {
    factor_.solve(values_, 0.0f);
    return true;
  }
  std::fill(values_.begin(), values_.end(), 0.0f);
  std::vector<SeamRow> rows;
  for_each_row(marks, heights, [&](int32_t, const SeamRow& row) { rows.push_back(row); });
  solve_by_rounds(*layout_, rows, kFineDamping, kFineRounds, values_);
  return false;
}

/// Solves the problem again for its texels that still have a mark: the matrix is a part of the last
/// one, since their heights have not changed.
void SeamRefinement::solve_remaining(const SeamMarks& marks, const SeamHeights& heights) {
  begin(marks, heights);
  if (texels_.empty()) return;
  for_each_row(marks, heights, [](int32_t, const SeamRow&) {});
  factor_.keep(texels_);
  factor_.solve(values_, 0.0f);
}

/// A texel's height from the solution, unlimited and limited.
inline std::pair<float, float> SeamRefinement::solved_height(int32_t texel,
                                                             const SeamHeights& heights) const {
  const float height = heights.height[texel] - reach_[texel] * values_[texel];
  return {height, std::clamp(height, heights.lowest[texel], heights.highest[texel])};
}

/// Accepts the heights of components within their limits; texels beyond stay at their limits, and
/// the rest of their components remain. Returns whether any remain.
bool SeamRefinement::accept_within_limits(SeamMarks& marks, SeamHeights& heights) {
  const std::vector<int32_t> component = factor_.components();
  std::vector<int32_t> remaining;
  for (size_t k = 0; k < texels_.size(); ++k) {
    const auto [height, limited] = solved_height(texels_[k], heights);
    if (height == limited || std::exchange(is_seen_[component[k]], 1) != 0) continue;
    remaining.push_back(component[k]);
  }
  for (size_t k = 0; k < texels_.size(); ++k) {
    const int32_t texel = texels_[k];
    const auto [height, limited] = solved_height(texel, heights);
    if (is_seen_[component[k]] != 0 && height == limited) continue;
    heights.height[texel] = limited;
    marks.remove(texel);
  }
  for (const int32_t texel : remaining) is_seen_[texel] = 0;
  return !remaining.empty();
}

size_t SeamRefinement::run(SeamMarks& marks, SeamHeights& heights) {
  begin(marks, heights);
  const size_t count = texels_.size();
  if (count == 0) return 0;
  if (solve(marks, heights)) {
    for (int32_t trial = 0; trial < kMaxLimited; ++trial) {
      if (!accept_within_limits(marks, heights)) return count;
      solve_remaining(marks, heights);
      if (texels_.empty()) return count;
    }
  }
  for (const int32_t texel : texels_) {
    heights.height[texel] = solved_height(texel, heights).second;
  }
  return count;
}

int64_t SeamRefinement::bytes() const {
  return bytes_of_vectors(texels_, values_, reach_, is_seen_) + factor_.bytes();
}

}  // namespace snowbough::snow
