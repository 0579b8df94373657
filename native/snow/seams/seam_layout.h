#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "snow/seams/seam_pattern.h"
#include "snow/seams/seam_row.h"
#include "snow/seams/seam_samples.h"

namespace snowbough::snow {

/// The texels and points of a SeamLevelling, renumbered: its unknowns come in the order in which a
/// factorisation eliminates them. It does not change from map to map.
///
/// Arrays with one value per texel have one more element at the end, 0, for points with fewer than
/// kSeamTerms terms.
class SeamLayout {
 public:
  /// Keeps no reference to `levelling`.
  explicit SeamLayout(const SeamLevelling& levelling);

  /// Index of each texel in the map; texels from unknowns() on are only read.
  const std::vector<int32_t>& texels() const { return texel_; }
  int32_t unknowns() const { return unknowns_; }
  /// Length of arrays with one value per texel.
  size_t values() const { return texel_.size() + 1; }
  float least_height() const { return least_height_; }
  const std::vector<SeamRow>& points() const { return points_; }
  const SeamRow& point(int32_t number) const { return points_[static_cast<size_t>(number)]; }
  /// The points that read an unknown.
  std::span<const int32_t> points_of(int32_t unknown) const {
    return {samples_.data() + sample_begin_[unknown], samples_.data() + sample_begin_[unknown + 1]};
  }
  /// Whether a point reads a texel that is no unknown.
  bool reads_foreign(int32_t point) const;
  /// Updates the copies of other charts' texels, which change with their own charts. `heights`: per
  /// texel.
  void refresh_foreign(std::vector<float>& heights) const;
  /// Of problems over the points.
  const std::shared_ptr<const SeamPattern>& pattern() const { return pattern_; }

  int64_t bytes() const;

 private:
  std::vector<int32_t> texel_;
  int32_t unknowns_;
  float least_height_;
  std::vector<SeamRow> points_;
  /// The points that read unknown i: [sample_begin_[i], sample_begin_[i + 1]) of samples_.
  std::vector<int32_t> sample_begin_;
  std::vector<int32_t> samples_;
  /// Texels that are only read because another chart owns them, and their index as that chart's.
  std::vector<std::pair<int32_t, int32_t>> foreign_;
  std::shared_ptr<const SeamPattern> pattern_;
};

/// The heights of a layout's texels in a map, in metres, and their range: the lowest and highest
/// heights read by the points that read a texel, or bare ground.
struct SeamHeights {
  explicit SeamHeights(const SeamLayout& layout)
      : height(layout.values(), 0.0f), lowest(height), highest(height) {}

  std::vector<float> height;
  std::vector<float> lowest;
  std::vector<float> highest;
};

/// Difference and sum of the heights of a point's sides, in metres.
struct SeamGap {
  float gap = 0.0f;
  float sum = 0.0f;
};

inline SeamGap seam_gap(const SeamRow& point, const std::vector<float>& heights) {
  SeamGap found;
  for (int32_t t = 0; t < kSeamTerms; ++t) {
    const float part = point.weight[t] * heights[point.source[t]];
    found.gap += part;
    found.sum += std::fabs(part);
  }
  return found;
}

/// Solves a problem over a layout's unknowns without a factor, see solve_by_gradients. `values`:
/// per texel the right-hand side; replaced by the solution.
void solve_by_rounds(const SeamLayout& layout, const std::vector<SeamRow>& rows, float damping,
                     int32_t rounds, std::vector<float>& values);

/// Memory of vectors, in bytes.
template <typename... Vectors>
int64_t bytes_of_vectors(const Vectors&... vectors) {
  return (int64_t{0} + ... + static_cast<int64_t>(vectors.capacity() * sizeof(vectors[0])));
}

}  // namespace snowbough::snow
