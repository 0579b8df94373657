#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace snowbough::snow {

/// Two sides of a seam, each read between four texels.
inline constexpr int32_t kSeamTerms = 8;

/// One equation of a least-squares problem: a sum of weight * unknown. Sources ascend; those from
/// the number of unknowns on are none, and so fill up a row that has fewer terms.
struct SeamRow {
  std::array<int32_t, kSeamTerms> source{};
  std::array<float, kSeamTerms> weight{};
};

/// A sparse least-squares problem, factorised: which values x of the unknowns make
///
///   sum over rows (wanted - sum of weight * x)^2 + damping * sum over unknowns x^2
///
/// the least. A Cholesky factorisation of the normal matrix finds them at once, on one thread and
/// always in the same order: the same input gives the same bits.
class SeamFactor {
 public:
  SeamFactor();
  ~SeamFactor();
  SeamFactor(SeamFactor&& other) noexcept;
  SeamFactor& operator=(SeamFactor&& other) noexcept;

  /// In which order unknowns are best eliminated: per place, the unknown. An approximate minimum
  /// degree ordering: P. R. Amestoy, T. A. Davis, I. S. Duff, An Approximate Minimum Degree
  /// Ordering Algorithm, 1996; Eigen's AMDOrdering.
  static std::vector<int32_t> elimination_order(const std::vector<SeamRow>& rows, int32_t unknowns);

  /// `rows`: one an equation; unknowns are numbered in the order in which they are eliminated.
  /// `damping`: more than 0. `most_work`: in multiplications, which are counted before any is done.
  /// @return false, and cannot solve, where it would take more than that.
  bool compute(const std::vector<SeamRow>& rows, int32_t unknowns, float damping,
               int64_t most_work);

  /// Leaves only the unknowns `kept`, ascending, of the problem that was computed last: what it
  /// would be without the other terms. They are numbered anew in their order.
  /// @return false, and cannot solve, where there is no factor.
  bool keep(const std::vector<int32_t>& kept);

  /// `values`: per unknown the sum of weight * wanted over its rows; replaced by the solution.
  /// Below `negligible` a value is taken for 0 on its way, and an unknown that no other reaches
  /// stays 0.
  void solve(std::vector<float>& values, float negligible) const;

  /// Per unknown: the last one of those that hang together with it by rows that share unknowns.
  std::vector<int32_t> components() const;

  /// Gives back what only compute() works with.
  void shrink();

  /// Entries of the factor, 8 bytes each.
  int64_t entries() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace snowbough::snow
