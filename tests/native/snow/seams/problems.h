#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "snow/seams/seam_samples.h"

// Small least-squares problems for the tests of levelling.
namespace snowbough::snow {

inline constexpr int64_t kAnyWork = int64_t{1} << 40;

/// A row with the terms {source, weight}, in ascending order, filled up with `none`.
inline SeamRow row(const std::vector<std::pair<int32_t, float>>& terms, int32_t none) {
  SeamRow made;
  made.source.fill(none);
  for (size_t t = 0; t < terms.size(); ++t) {
    made.source[t] = terms[t].first;
    made.weight[t] = terms[t].second;
  }
  return made;
}

struct Problem {
  std::vector<SeamRow> rows;
  int32_t unknowns;
  std::vector<float> wanted;

  /// The input of solve().
  std::vector<float> values() const {
    std::vector<float> sums(static_cast<size_t>(unknowns), 0.0f);
    for (size_t r = 0; r < rows.size(); ++r) {
      for (int32_t t = 0; t < kSeamTerms && rows[r].source[t] < unknowns; ++t) {
        sums[rows[r].source[t]] += rows[r].weight[t] * wanted[r];
      }
    }
    return sums;
  }
};

/// Rows of two to four terms over a dozen unknowns and one source that is not an unknown.
inline Problem random_problem(uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> number(-1.0f, 1.0f);
  Problem problem{{}, 12, {}};
  for (int r = 0; r < 30; ++r) {
    std::vector<std::pair<int32_t, float>> terms;
    for (int32_t i = 0; i <= 12; ++i) {
      if (random() % 4 == 0 && terms.size() < 4) terms.emplace_back(i, number(random));
    }
    problem.rows.push_back(row(terms, 13));
    problem.wanted.push_back(number(random));
  }
  return problem;
}

/// The normal equations solved by Gaussian elimination.
inline std::vector<float> dense_solution(const Problem& problem, float damping) {
  const auto n = static_cast<size_t>(problem.unknowns);
  std::vector<std::vector<double>> a(n, std::vector<double>(n + 1, 0.0));
  const std::vector<float> values = problem.values();
  for (size_t i = 0; i < n; ++i) {
    a[i][i] = damping;
    a[i][n] = values[i];
  }
  for (const SeamRow& r : problem.rows) {
    for (int32_t s = 0; s < kSeamTerms && r.source[s] < problem.unknowns; ++s) {
      for (int32_t t = 0; t < kSeamTerms && r.source[t] < problem.unknowns; ++t) {
        a[r.source[s]][r.source[t]] += static_cast<double>(r.weight[s]) * r.weight[t];
      }
    }
  }
  for (size_t k = 0; k < n; ++k) {
    for (size_t i = 0; i < n; ++i) {
      if (i == k) continue;
      const double part = a[i][k] / a[k][k];
      for (size_t j = k; j <= n; ++j) a[i][j] -= part * a[k][j];
    }
  }
  std::vector<float> solution;
  for (size_t i = 0; i < n; ++i) solution.push_back(static_cast<float>(a[i][n] / a[i][i]));
  return solution;
}

}  // namespace snowbough::snow
