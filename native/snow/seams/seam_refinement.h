#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "snow/seams/least_squares.h"
#include "snow/seams/seam_layout.h"
#include "snow/seams/seam_marks.h"

namespace snowbough::snow {

/// The second problem of SeamLeveller: lowers the differences of marked points relative to their
/// height. Its matrix is factorised for each call.
///
/// No height leaves its range: it stays at its limit, and the texels connected to it are solved
/// once more.
class SeamRefinement {
 public:
  explicit SeamRefinement(std::shared_ptr<const SeamLayout> layout);

  /// Changes the heights of marked texels; texels whose height is accepted lose their mark. Returns
  /// the number of texels that were marked.
  size_t run(SeamMarks& marks, SeamHeights& heights);

  int64_t bytes() const;

 private:
  void begin(const SeamMarks& marks, const SeamHeights& heights);
  template <typename Visit>
  void for_each_row(const SeamMarks& marks, const SeamHeights& heights, const Visit& visit);
  bool solve(const SeamMarks& marks, const SeamHeights& heights);
  void solve_remaining(const SeamMarks& marks, const SeamHeights& heights);
  bool accept_within_limits(SeamMarks& marks, SeamHeights& heights);
  std::pair<float, float> solved_height(int32_t texel, const SeamHeights& heights) const;

  std::shared_ptr<const SeamLayout> layout_;
  SeamFactor factor_;
  /// The problem's texels, ascending.
  std::vector<int32_t> texels_;
  /// Per texel: right-hand side, then solution, 0 for texels outside the problem; and the change of
  /// its height per unit of the solution.
  std::vector<float> values_;
  std::vector<float> reach_;
  /// Per texel: scratch flags, all 0 between uses.
  std::vector<uint8_t> is_seen_;
};

}  // namespace snowbough::snow
