#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "snow/seams/seam_pattern.h"
#include "snow/seams/seam_row.h"

namespace snowbough::snow {

/// Sparse least-squares problems over the rows of a pattern, factorised: which values x of the
/// unknowns make
///
///   sum over rows (wanted - sum of weight * x)^2 + damping * sum over unknowns x^2
///
/// the least. A Cholesky factorisation of the normal matrix finds them at once, on one thread and
/// always in the same order: the same input gives the same bits. A problem takes as long as it has
/// unknowns and rows, however many the pattern has.
class SeamFactor {
 public:
  /// Unknowns are eliminated in the order of their numbers.
  explicit SeamFactor(std::shared_ptr<const SeamPattern> pattern);
  ~SeamFactor();
  SeamFactor(SeamFactor&& other) noexcept;
  SeamFactor& operator=(SeamFactor&& other) noexcept;

  /// In which order unknowns are best eliminated: per place, the unknown. An approximate minimum
  /// degree ordering: P. R. Amestoy, T. A. Davis, I. S. Duff, An Approximate Minimum Degree
  /// Ordering Algorithm, 1996; Eigen's AMDOrdering.
  static std::vector<int32_t> elimination_order(const std::vector<SeamRow>& rows, int32_t unknowns);

  /// Begins a problem of the pattern's unknowns `unknowns`, ascending. `damping`: more than 0.
  void begin(const std::vector<int32_t>& unknowns, float damping);
  /// Adds the pattern's row `number`. `row`: its sources, and the weights that they have in this
  /// problem, 0 for unknowns that are not in it.
  void add(int32_t number, const SeamRow& row);
  /// `most_work`: in multiplications, which are counted before any is done.
  /// @return false, and cannot solve, where it would take more than that.
  bool factorise(int64_t most_work);
  /// Leaves only the unknowns `kept`, ascending, of the problem in hand, and factorises what is
  /// left of it without the other terms.
  /// @return false, and cannot solve, where there is no factor.
  bool keep(const std::vector<int32_t>& kept);

  /// `values`: per unknown of the pattern the sum of weight * wanted over its rows;
  /// those of the problem are replaced by the solution. Below `negligible` a value is taken for 0
  /// on its way, and an unknown that no other reaches stays 0.
  void solve(std::vector<float>& values, float negligible) const;

  /// Per unknown of the problem, in their order: the last one of those that hang together with it
  /// by entries of the factor that are not 0.
  std::vector<int32_t> components() const;

  /// Gives back what only the making of a factor works with.
  void shrink();

  int64_t bytes() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace snowbough::snow
