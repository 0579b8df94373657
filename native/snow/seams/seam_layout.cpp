#include "snow/seams/seam_layout.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <tuple>

#include "base/group_by_key.h"
#include "snow/seams/least_squares.h"
#include "snow/seams/seam_gradients.h"

namespace snowbough::snow {
namespace {

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

SeamLayout::SeamLayout(const SeamLevelling& levelling)
    : texel_(levelling.texel),
      unknowns_(levelling.unknowns),
      least_height_(levelling.least_height),
      points_(levelling.points) {
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
  const auto for_each_sample = [&](const auto& visit) {
    for (size_t p = 0; p < points_.size(); ++p) {
      for (const int32_t texel : points_[p].source) {
        if (texel < unknowns_) visit(texel, static_cast<int32_t>(p));
      }
    }
  };
  base::group_by_key(static_cast<size_t>(unknowns_), for_each_sample, sample_begin_, samples_);
  pattern_ = std::make_shared<const SeamPattern>(points_, unknowns_);
}

bool SeamLayout::reads_foreign(int32_t number) const {
  const auto none = static_cast<int32_t>(texel_.size());
  const auto& source = point(number).source;
  return std::any_of(source.begin(), source.end(),
                     [&](int32_t texel) { return texel >= unknowns_ && texel < none; });
}

void SeamLayout::refresh_foreign(std::vector<float>& heights) const {
  for (const auto& [foreign, own] : foreign_) heights[foreign] = heights[own];
}

int64_t SeamLayout::bytes() const {
  return bytes_of_vectors(texel_, points_, sample_begin_, samples_, foreign_) + pattern_->bytes();
}

void solve_by_rounds(const SeamLayout& layout, const std::vector<SeamRow>& rows, float damping,
                     int32_t rounds, std::vector<float>& values) {
  values.resize(static_cast<size_t>(layout.unknowns()));
  solve_by_gradients(rows, static_cast<int32_t>(layout.values()), damping, rounds, values);
  values.resize(layout.values(), 0.0f);
}

}  // namespace snowbough::snow
