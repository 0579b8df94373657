#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "snow/seams/seam_pattern.h"
#include "snow/seams/seam_row.h"

namespace snowbough::snow {

/// Factorised sparse least-squares problems over the rows of a pattern: the values x of the
/// unknowns that minimise
///
///   sum over rows (wanted - sum of weight * x)^2 + damping * sum over unknowns x^2
///
/// A Cholesky factorisation of the normal matrix solves it directly, on one thread and always in
/// the same order: the same input gives the same bits. The cost depends on the problem's unknowns
/// and rows, not on the pattern's.
class SeamFactor {
 public:
  /// Unknowns are eliminated in the order of their numbers.
  explicit SeamFactor(std::shared_ptr<const SeamPattern> pattern);
  ~SeamFactor();
  SeamFactor(SeamFactor&& other) noexcept;

  /// A fill-reducing elimination order: per place, the unknown. An approximate minimum degree
  /// ordering: P. R. Amestoy, T. A. Davis, I. S. Duff, An Approximate Minimum Degree Ordering
  /// Algorithm, 1996; Eigen's AMDOrdering.
  static std::vector<int32_t> elimination_order(const std::vector<SeamRow>& rows, int32_t unknowns);

  /// Begins a problem over the pattern's unknowns `unknowns`, ascending. `damping`: more than 0.
  void begin(const std::vector<int32_t>& unknowns, float damping);
  /// Adds the pattern's row `number`. `row`: its sources, and their weights in this problem, 0 for
  /// unknowns outside it.
  void add(int32_t number, const SeamRow& row);
  /// `most_work`: maximum number of multiplications, counted beforehand.
  /// @return false if it would take more; `solve` is then not possible.
  bool factorise(int64_t most_work);
  /// Restricts the current problem to the unknowns `kept`, ascending, and factorises it without the
  /// other terms.
  /// @return false if there is no factor; `solve` is then not possible.
  bool keep(const std::vector<int32_t>& kept);

  /// `values`: per unknown of the pattern the sum of weight * wanted over its rows; the problem's
  /// entries are replaced by the solution. Intermediate values below `negligible` are treated as 0,
  /// and an unknown that no other reaches stays 0.
  void solve(std::vector<float>& values, float negligible) const;

  /// Per unknown of the problem, in their order: the last unknown connected to it by non-zero
  /// entries of the factor.
  std::vector<int32_t> components() const;

  /// Frees the memory that only factorising needs.
  void shrink();

  int64_t bytes() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace snowbough::snow
