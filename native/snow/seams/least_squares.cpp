#include "snow/seams/least_squares.h"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>

namespace snowbough::snow {
namespace {

/// A sparse matrix column by column: the entries of column j are [begin[j], begin[j + 1]).
struct Columns {
  std::vector<int32_t> begin;
  std::vector<int32_t> row;
  std::vector<float> value;

  int32_t count() const { return static_cast<int32_t>(begin.size()) - 1; }
};

/// Makes the upper half of normal matrices. Keeps its memory from one to the next.
class NormalMatrix {
 public:
  void make(const std::vector<SeamRow>& rows, int32_t unknowns, float damping) {
    const size_t most = find_terms(rows, unknowns);
    place_.assign(static_cast<size_t>(unknowns), -1);
    if (upper_.row.size() < most) {
      upper_.row.resize(most);
      upper_.value.resize(most);
    }
    upper_.begin.assign(1, 0);
    next_ = 0;
    for (int32_t column = 0; column < unknowns; ++column) {
      const int32_t first = next_;
      open(column, damping);
      place_[column] = first;
      for (int32_t k = term_begin_[column]; k < term_begin_[column + 1]; ++k) {
        add(rows[static_cast<size_t>(term_[k] / kSeamTerms)], term_[k] % kSeamTerms, first);
      }
      upper_.begin.push_back(next_);
    }
  }

  /// Leaves the unknowns `kept` only, ascending.
  void keep(const std::vector<int32_t>& kept) {
    place_.assign(static_cast<size_t>(upper_.count()), -1);
    for (size_t k = 0; k < kept.size(); ++k) place_[kept[k]] = static_cast<int32_t>(k);
    next_ = 0;
    for (size_t k = 0; k < kept.size(); ++k) {
      const int32_t begin = upper_.begin[kept[k]];
      const int32_t end = upper_.begin[kept[k] + 1];
      upper_.begin[k] = next_;
      for (int32_t e = begin; e < end; ++e) {
        const int32_t row = place_[upper_.row[e]];
        if (row >= 0) open(row, upper_.value[e]);
      }
    }
    upper_.begin[kept.size()] = next_;
    upper_.begin.resize(kept.size() + 1);
  }

  /// The diagonal and what lies above it; rows of a column in no order. Room may be left behind the
  /// last entry.
  const Columns& upper() const { return upper_; }

 private:
  /// Lists each unknown's terms, row * kSeamTerms + number. Returns how many entries the matrix has
  /// at most.
  size_t find_terms(const std::vector<SeamRow>& rows, int32_t unknowns) {
    const auto for_each_term = [&](const auto& work) {
      for (size_t r = 0; r < rows.size(); ++r) {
        for (int32_t t = 0; t < kSeamTerms && rows[r].source[t] < unknowns; ++t) {
          work(rows[r].source[t], static_cast<int32_t>(r) * kSeamTerms + t);
        }
      }
    };
    size_t most = static_cast<size_t>(unknowns);
    // Shifted by one place, so that the second walk leaves the beginnings where they belong.
    term_begin_.assign(static_cast<size_t>(unknowns) + 2, 0);
    for_each_term([&](int32_t unknown, int32_t term) {
      ++term_begin_[unknown + 2];
      most += static_cast<size_t>(term % kSeamTerms);
    });
    std::partial_sum(term_begin_.begin(), term_begin_.end(), term_begin_.begin());
    term_.resize(static_cast<size_t>(term_begin_.back()));
    for_each_term([&](int32_t unknown, int32_t term) { term_[term_begin_[unknown + 1]++] = term; });
    return most;
  }

  /// A new entry of the column in hand.
  void open(int32_t row, float value) {
    upper_.row[next_] = row;
    upper_.value[next_++] = value;
  }

  /// Adds what the row's terms up to `term`, which is the column's, give. The column's entries
  /// begin at `first`.
  void add(const SeamRow& row, int32_t term, int32_t first) {
    for (int32_t t = 0; t <= term; ++t) {
      const int32_t other = row.source[t];
      const float part = row.weight[term] * row.weight[t];
      if (place_[other] >= first) {
        upper_.value[place_[other]] += part;
      } else {
        place_[other] = next_;
        open(other, part);
      }
    }
  }

  std::vector<int32_t> term_begin_;
  std::vector<int32_t> term_;
  /// Per unknown: its entry in the last column that has it.
  std::vector<int32_t> place_;
  int32_t next_ = 0;
  Columns upper_;
};

/// The factors L D L^T of a matrix, row by row of L: T. A. Davis, Algorithm 849: A Concise Sparse
/// Cholesky Factorization Package, 2005. L without its diagonal of ones.
class Cholesky {
 public:
  /// Finds where L has entries; returns how many multiplications its entries take.
  int64_t analyse(const Columns& upper) {
    const int32_t size = upper.count();
    parent_.assign(static_cast<size_t>(size), -1);
    seen_in_.resize(static_cast<size_t>(size));
    entries_.assign(static_cast<size_t>(size), 0);
    for (int32_t k = 0; k < size; ++k) {
      seen_in_[k] = k;
      for (int32_t e = upper.begin[k]; e < upper.begin[k + 1]; ++e) {
        for (int32_t i = upper.row[e]; seen_in_[i] != k; i = parent_[i]) {
          if (parent_[i] < 0) parent_[i] = k;
          ++entries_[i];
          seen_in_[i] = k;
        }
      }
    }
    lower_.begin.assign(1, 0);
    int64_t work = 0;
    int64_t end = 0;
    for (const int32_t count : entries_) {
      work += int64_t{count} * count;
      end += count;
      lower_.begin.push_back(static_cast<int32_t>(std::min<int64_t>(end, INT32_MAX)));
    }
    return work;
  }

  /// Returns false where the matrix has no factors.
  bool factorise(const Columns& upper) {
    const int32_t size = upper.count();
    lower_.row.resize(static_cast<size_t>(lower_.begin.back()));
    lower_.value.resize(lower_.row.size());
    diagonal_.resize(static_cast<size_t>(size));
    sums_.assign(static_cast<size_t>(size), 0.0f);
    path_.resize(static_cast<size_t>(size));
    entries_.assign(static_cast<size_t>(size), 0);
    for (int32_t k = 0; k < size; ++k) {
      const int32_t first = find_row(upper, k);
      float d = std::exchange(sums_[k], 0.0f);
      for (int32_t at = first; at < size; ++at) {
        const int32_t i = path_[at];
        const float sum = std::exchange(sums_[i], 0.0f);
        const float entry = sum / diagonal_[i];
        const int32_t end = lower_.begin[i] + entries_[i];
        for (int32_t e = lower_.begin[i]; e < end; ++e) {
          sums_[lower_.row[e]] -= lower_.value[e] * sum;
        }
        d -= entry * sum;
        lower_.row[end] = k;
        lower_.value[end] = entry;
        ++entries_[i];
      }
      diagonal_[k] = d;
      if (d == 0.0f) return false;
    }
    return true;
  }

  /// Rows of a column ascend.
  const Columns& lower() const { return lower_; }
  const std::vector<float>& diagonal() const { return diagonal_; }

 private:
  /// Takes the matrix's column k into sums_, and lists which entries row k of L has, in an order in
  /// which they can be found: path_ from the number returned on.
  int32_t find_row(const Columns& upper, int32_t k) {
    const int32_t size = upper.count();
    int32_t first = size;
    seen_in_[k] = k;
    sums_[k] = 0.0f;
    for (int32_t e = upper.begin[k]; e < upper.begin[k + 1]; ++e) {
      int32_t i = upper.row[e];
      sums_[i] += upper.value[e];
      int32_t length = 0;
      for (; seen_in_[i] != k; i = parent_[i]) {
        path_[length++] = i;
        seen_in_[i] = k;
      }
      while (length > 0) path_[--first] = path_[--length];
    }
    return first;
  }

  Columns lower_;
  std::vector<float> diagonal_;
  /// Of the elimination tree.
  std::vector<int32_t> parent_;
  /// Per column: the row in which it was last seen; the entries that it has so far.
  std::vector<int32_t> seen_in_;
  std::vector<int32_t> entries_;
  std::vector<float> sums_;
  std::vector<int32_t> path_;
};

}  // namespace

struct SeamFactor::State {
  NormalMatrix normal;
  Cholesky cholesky;
};

SeamFactor::SeamFactor() : state_(std::make_unique<State>()) {}
SeamFactor::~SeamFactor() = default;
SeamFactor::SeamFactor(SeamFactor&& other) noexcept = default;
SeamFactor& SeamFactor::operator=(SeamFactor&& other) noexcept = default;

std::vector<int32_t> SeamFactor::elimination_order(const std::vector<SeamRow>& rows,
                                                   int32_t unknowns) {
  NormalMatrix normal;
  normal.make(rows, unknowns, 0.0f);
  const Columns& upper = normal.upper();
  const Eigen::Map<const Eigen::SparseMatrix<float>> matrix(unknowns, unknowns, upper.begin.back(),
                                                            upper.begin.data(), upper.row.data(),
                                                            upper.value.data());
  Eigen::AMDOrdering<int>::PermutationType order;
  Eigen::AMDOrdering<int>()(matrix.selfadjointView<Eigen::Upper>(), order);
  return {order.indices().begin(), order.indices().end()};
}

bool SeamFactor::compute(const std::vector<SeamRow>& rows, int32_t unknowns, float damping,
                         int64_t most_work) {
  state_->normal.make(rows, unknowns, damping);
  if (state_->cholesky.analyse(state_->normal.upper()) > most_work) {
    state_ = std::make_unique<State>();
    return false;
  }
  return state_->cholesky.factorise(state_->normal.upper());
}

bool SeamFactor::keep(const std::vector<int32_t>& kept) {
  state_->normal.keep(kept);
  state_->cholesky.analyse(state_->normal.upper());
  return state_->cholesky.factorise(state_->normal.upper());
}

void SeamFactor::solve(std::vector<float>& values, float negligible) const {
  // Goes through few columns where snow lies on little of the surface.
  const Columns& lower = state_->cholesky.lower();
  const auto size = static_cast<int32_t>(values.size());
  for (int32_t j = 0; j < size; ++j) {
    const float x = values[j];
    if (std::fabs(x) < negligible) {
      values[j] = 0.0f;
      continue;
    }
    for (int32_t e = lower.begin[j]; e < lower.begin[j + 1]; ++e) {
      values[lower.row[e]] -= lower.value[e] * x;
    }
  }
  const std::vector<float>& diagonal = state_->cholesky.diagonal();
  for (int32_t j = size - 1; j >= 0; --j) {
    if (values[j] == 0.0f) continue;
    float x = values[j] / diagonal[j];
    for (int32_t e = lower.begin[j]; e < lower.begin[j + 1]; ++e) {
      x -= lower.value[e] * values[lower.row[e]];
    }
    values[j] = x;
  }
}

std::vector<int32_t> SeamFactor::components() const {
  // A column's first row is its parent in the elimination tree.
  const Columns& lower = state_->cholesky.lower();
  std::vector<int32_t> last(static_cast<size_t>(lower.count()));
  for (int32_t j = lower.count() - 1; j >= 0; --j) {
    const int32_t first = lower.begin[j];
    last[j] = first == lower.begin[j + 1] ? j : last[lower.row[first]];
  }
  return last;
}

void SeamFactor::shrink() {
  state_->normal = {};
}

int64_t SeamFactor::entries() const {
  return static_cast<int64_t>(state_->cholesky.lower().row.size());
}

}  // namespace snowbough::snow
