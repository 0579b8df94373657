#include "snow/seams/least_squares.h"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace snowbough::snow {
namespace {

using Matrix = Eigen::SparseMatrix<float>;

/// Makes the upper half of normal matrices, column by column: a product of Eigen's sparse matrices
/// would make both halves and sort them. Keeps its memory from one to the next.
class NormalMatrix {
 public:
  const Matrix& make(const std::vector<SeamRow>& rows, int32_t unknowns, float damping) {
    find_terms(rows, unknowns);
    sum_.resize(static_cast<size_t>(unknowns));
    seen_in_.assign(static_cast<size_t>(unknowns), -1);
    column_begin_.assign(1, 0);
    row_.clear();
    value_.clear();
    for (int32_t column = 0; column < unknowns; ++column) {
      const size_t first = row_.size();
      row_.push_back(column);
      sum_[column] = damping;
      seen_in_[column] = column;
      for (int32_t k = term_begin_[column]; k < term_begin_[column + 1]; ++k) {
        add(rows[static_cast<size_t>(term_[k] / kSeamTerms)], term_[k] % kSeamTerms, column);
      }
      for (size_t k = first; k < row_.size(); ++k) value_.push_back(sum_[row_[k]]);
      column_begin_.push_back(static_cast<int32_t>(row_.size()));
    }
    // Eigen's own ways of filling a matrix want the rows of a column to ascend; what this one is
    // for does not.
    matrix_.resize(unknowns, unknowns);
    matrix_.resizeNonZeros(static_cast<Eigen::Index>(row_.size()));
    std::copy(column_begin_.begin(), column_begin_.end(), matrix_.outerIndexPtr());
    std::copy(row_.begin(), row_.end(), matrix_.innerIndexPtr());
    std::copy(value_.begin(), value_.end(), matrix_.valuePtr());
    return matrix_;
  }

 private:
  /// Lists each unknown's terms, row * kSeamTerms + number.
  void find_terms(const std::vector<SeamRow>& rows, int32_t unknowns) {
    const auto for_each_term = [&](const auto& work) {
      for (size_t r = 0; r < rows.size(); ++r) {
        for (int32_t t = 0; t < kSeamTerms && rows[r].source[t] < unknowns; ++t) {
          work(rows[r].source[t], static_cast<int32_t>(r) * kSeamTerms + t);
        }
      }
    };
    // Shifted by one place, so that the second walk leaves the beginnings where they belong.
    term_begin_.assign(static_cast<size_t>(unknowns) + 2, 0);
    for_each_term([&](int32_t unknown, int32_t) { ++term_begin_[unknown + 2]; });
    std::partial_sum(term_begin_.begin(), term_begin_.end(), term_begin_.begin());
    term_.resize(static_cast<size_t>(term_begin_.back()));
    for_each_term([&](int32_t unknown, int32_t term) { term_[term_begin_[unknown + 1]++] = term; });
  }

  /// Adds what the row's terms up to `term`, which is the column's, give.
  void add(const SeamRow& row, int32_t term, int32_t column) {
    for (int32_t t = 0; t <= term; ++t) {
      const int32_t other = row.source[t];
      const float part = row.weight[term] * row.weight[t];
      if (seen_in_[other] == column) {
        sum_[other] += part;
      } else {
        seen_in_[other] = column;
        sum_[other] = part;
        row_.push_back(other);
      }
    }
  }

  std::vector<int32_t> term_begin_;
  std::vector<int32_t> term_;
  /// Per unknown: what the column in hand has in its row, if that row was seen in this column.
  std::vector<float> sum_;
  std::vector<int32_t> seen_in_;
  std::vector<int32_t> column_begin_;
  std::vector<int32_t> row_;
  std::vector<float> value_;
  Matrix matrix_;
};

/// Opens what Eigen keeps to itself.
struct Cholesky : Eigen::SimplicialLDLT<Matrix, Eigen::Upper, Eigen::NaturalOrdering<int>> {
  /// Without the diagonal of ones. Rows of a column ascend.
  const Matrix& lower() const { return m_matrix; }
  const Eigen::VectorXf& diagonal() const { return m_diag; }

  int64_t work() const {
    int64_t sum = 0;
    for (int j = 0; j < m_matrix.outerSize(); ++j) {
      const int64_t count = m_matrix.outerIndexPtr()[j + 1] - m_matrix.outerIndexPtr()[j];
      sum += count * count;
    }
    return sum;
  }
};

}  // namespace

struct SeamFactor::State {
  NormalMatrix normal;
  Cholesky cholesky;
};

SeamFactor::SeamFactor() : state_(std::make_unique<State>()) {}
SeamFactor::~SeamFactor() = default;

std::vector<int32_t> SeamFactor::elimination_order(const std::vector<SeamRow>& rows,
                                                   int32_t unknowns) {
  NormalMatrix normal;
  Eigen::AMDOrdering<int>::PermutationType order;
  Eigen::AMDOrdering<int>()(normal.make(rows, unknowns, 0.0f).selfadjointView<Eigen::Upper>(),
                            order);
  return {order.indices().begin(), order.indices().end()};
}

bool SeamFactor::compute(const std::vector<SeamRow>& rows, int32_t unknowns, float damping,
                         int64_t most_work) {
  const Matrix& normal = state_->normal.make(rows, unknowns, damping);
  state_->cholesky.analyzePattern(normal);
  if (state_->cholesky.work() > most_work) {
    state_ = std::make_unique<State>();
    return false;
  }
  state_->cholesky.factorize(normal);
  return state_->cholesky.info() == Eigen::Success;
}

void SeamFactor::solve(std::vector<float>& values, float negligible) const {
  // Eigen's own solution goes through every column, however little of the surface snow lies on.
  const Matrix& lower = state_->cholesky.lower();
  const int* begin = lower.outerIndexPtr();
  const int* row = lower.innerIndexPtr();
  const float* entry = lower.valuePtr();
  const auto size = static_cast<int32_t>(values.size());
  for (int32_t j = 0; j < size; ++j) {
    const float x = values[j];
    if (std::fabs(x) < negligible) {
      values[j] = 0.0f;
      continue;
    }
    for (int k = begin[j]; k < begin[j + 1]; ++k) values[row[k]] -= entry[k] * x;
  }
  const Eigen::VectorXf& diagonal = state_->cholesky.diagonal();
  for (int32_t j = size - 1; j >= 0; --j) {
    if (values[j] == 0.0f) continue;
    float x = values[j] / diagonal[j];
    for (int k = begin[j]; k < begin[j + 1]; ++k) x -= entry[k] * values[row[k]];
    values[j] = x;
  }
}

std::vector<int32_t> SeamFactor::components() const {
  // A column's first row is its parent in the elimination tree.
  const Matrix& lower = state_->cholesky.lower();
  std::vector<int32_t> last(static_cast<size_t>(lower.cols()));
  for (auto j = static_cast<int32_t>(lower.cols()) - 1; j >= 0; --j) {
    const int first = lower.outerIndexPtr()[j];
    last[j] = first == lower.outerIndexPtr()[j + 1] ? j : last[lower.innerIndexPtr()[first]];
  }
  return last;
}

void SeamFactor::shrink() {
  state_->normal = {};
}

int64_t SeamFactor::entries() const {
  return state_->cholesky.lower().data().size();
}

}  // namespace snowbough::snow
