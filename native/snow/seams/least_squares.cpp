#include "snow/seams/least_squares.h"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <cmath>
#include <cstdint>
#include <utility>

namespace snowbough::snow {
/// The factors L D L^T of a matrix, row by row of L: T. A. Davis, Algorithm 849: A Concise Sparse
/// Cholesky Factorization Package, 2005. L without its unit diagonal. Arrays are per unknown of the
/// pattern; entries outside the problem are stale.
struct SeamFactor::State {
  explicit State(std::shared_ptr<const SeamPattern> shared)
      : pattern(std::move(shared)),
        size(pattern->unknowns()),
        is_in(static_cast<size_t>(size), 0),
        is_stale(static_cast<size_t>(size), 0) {}

  /// Finds the non-zero pattern of L; returns false if that takes too much work.
  bool analyse(int64_t most_work);
  /// Computes the stale rows of L and those that depend on them; returns false if there are no
  /// factors.
  bool factorise();

  std::shared_ptr<const SeamPattern> pattern;
  int32_t size;
  std::vector<int32_t> unknowns;
  std::vector<uint8_t> is_in;
  /// The unknowns when L's pattern was found: unknowns that have left since still have entries, 0.
  std::vector<int32_t> analysed;
  /// Whether an unknown's row of L must be recomputed.
  std::vector<uint8_t> is_stale;
  /// The matrix: per entry of the pattern, and the diagonal.
  std::vector<float> value;
  std::vector<float> own;

  /// Column j of L: count[j] entries from begin[j] on, rows ascending.
  std::vector<int32_t> begin;
  std::vector<int32_t> count;
  std::vector<int32_t> row;
  std::vector<float> lower;
  std::vector<float> diagonal;

  /// The entries of the problem's rows of L, in an order in which they can be computed; and each
  /// row's end.
  std::vector<int32_t> path;
  std::vector<int32_t> path_end;
  /// Of the elimination tree.
  std::vector<int32_t> parent;
  /// Per column: the last row that visited it.
  std::vector<int32_t> seen_in;
  std::vector<int32_t> scratch;
  /// All 0 between rows.
  std::vector<float> sums;
};

bool SeamFactor::State::analyse(int64_t most_work) {
  const auto all = static_cast<size_t>(size);
  parent.resize(all);
  seen_in.resize(all);
  count.resize(all);
  scratch.resize(all);
  path.clear();
  path_end.clear();
  analysed = unknowns;
  int64_t work = 0;
  for (const int32_t k : unknowns) {
    is_stale[k] = 1;
    int32_t first = size;
    parent[k] = -1;
    count[k] = 0;
    seen_in[k] = k;
    for (int32_t e = pattern->begin(k); e < pattern->begin(k + 1); ++e) {
      int32_t i = pattern->row(e);
      if (is_in[i] == 0) continue;
      int32_t length = 0;
      for (; seen_in[i] != k; i = parent[i]) {
        if (parent[i] < 0) parent[i] = k;
        work += 2 * ++count[i] - 1;  // what the square of the count grows by
        scratch[length++] = i;
        seen_in[i] = k;
      }
      while (length > 0) scratch[--first] = scratch[--length];
    }
    if (work > most_work) return false;
    path.insert(path.end(), scratch.begin() + first, scratch.end());
    path_end.push_back(static_cast<int32_t>(path.size()));
  }
  begin.resize(all);
  int32_t end = 0;
  for (const int32_t k : unknowns) {
    begin[k] = end;
    end += count[k];
  }
  row.resize(static_cast<size_t>(end));
  lower.resize(static_cast<size_t>(end));
  return true;
}

bool SeamFactor::State::factorise() {
  diagonal.resize(static_cast<size_t>(size));
  sums.resize(static_cast<size_t>(size), 0.0f);
  for (const int32_t k : analysed) count[k] = 0;
  int32_t at = 0;
  for (size_t u = 0; u < analysed.size(); ++u) {
    const int32_t k = analysed[u];
    if (std::exchange(is_stale[k], 0) == 0) {
      for (; at < path_end[u]; ++at) ++count[path[at]];
      continue;
    }
    if (parent[k] >= 0) is_stale[parent[k]] = 1;
    if (is_in[k] == 0) {
      for (; at < path_end[u]; ++at) lower[begin[path[at]] + count[path[at]]++] = 0.0f;
      continue;
    }
    for (int32_t e = pattern->begin(k); e < pattern->begin(k + 1); ++e) {
      const int32_t i = pattern->row(e);
      if (is_in[i] != 0) sums[i] = value[e];
    }
    float d = own[k];
    for (; at < path_end[u]; ++at) {
      const int32_t i = path[at];
      const float sum = std::exchange(sums[i], 0.0f);
      const int32_t end = begin[i] + count[i]++;
      row[end] = k;
      if (is_in[i] == 0) continue;
      const float entry = sum / diagonal[i];
      lower[end] = entry;
      d -= entry * sum;
      for (int32_t e = begin[i]; e < end; ++e) sums[row[e]] -= lower[e] * sum;
    }
    diagonal[k] = d;
    if (d == 0.0f) return false;
  }
  return true;
}

SeamFactor::SeamFactor(std::shared_ptr<const SeamPattern> pattern)
    : state_(std::make_unique<State>(std::move(pattern))) {}
SeamFactor::~SeamFactor() = default;
SeamFactor::SeamFactor(SeamFactor&& other) noexcept = default;

std::vector<int32_t> SeamFactor::elimination_order(const std::vector<SeamRow>& rows,
                                                   int32_t unknowns) {
  const SeamPattern pattern(rows, unknowns);
  std::vector<int32_t> begin{0};
  std::vector<int32_t> row;
  for (int32_t column = 0; column < unknowns; ++column) {
    row.push_back(column);
    for (int32_t e = pattern.begin(column); e < pattern.begin(column + 1); ++e) {
      row.push_back(pattern.row(e));
    }
    begin.push_back(static_cast<int32_t>(row.size()));
  }
  const std::vector<float> value(row.size(), 1.0f);
  const Eigen::Map<const Eigen::SparseMatrix<float>> matrix(unknowns, unknowns, begin.back(),
                                                            begin.data(), row.data(), value.data());
  Eigen::AMDOrdering<int>::PermutationType order;
  Eigen::AMDOrdering<int>()(matrix.selfadjointView<Eigen::Upper>(), order);
  return {order.indices().begin(), order.indices().end()};
}

void SeamFactor::begin(const std::vector<int32_t>& unknowns, float damping) {
  State& s = *state_;
  s.value.resize(static_cast<size_t>(s.pattern->entries()));
  s.own.resize(static_cast<size_t>(s.size));
  for (const int32_t k : s.unknowns) s.is_in[k] = 0;
  s.unknowns = unknowns;
  for (const int32_t k : s.unknowns) {
    s.is_in[k] = 1;
    s.own[k] = damping;
    std::fill(s.value.begin() + s.pattern->begin(k), s.value.begin() + s.pattern->begin(k + 1),
              0.0f);
  }
}

void SeamFactor::add(int32_t number, const SeamRow& row) {
  State& s = *state_;
  const uint16_t* offset = s.pattern->offsets(number);
  for (int32_t b = 0; b < kSeamTerms && row.source[b] < s.size; offset += b++) {
    const float weight = row.weight[b];
    if (weight == 0.0f) continue;
    s.own[row.source[b]] += weight * weight;
    float* const column = s.value.data() + s.pattern->begin(row.source[b]);
    for (int32_t a = 0; a < b; ++a) column[offset[a]] += weight * row.weight[a];
  }
}

bool SeamFactor::factorise(int64_t most_work) {
  return state_->pattern->is_complete() && state_->analyse(most_work) && state_->factorise();
}

bool SeamFactor::keep(const std::vector<int32_t>& kept) {
  State& s = *state_;
  for (const int32_t k : s.unknowns) s.is_in[k] = 0;
  for (const int32_t k : kept) s.is_in[k] = 1;
  for (const int32_t k : s.unknowns) s.is_stale[k] = s.is_in[k] == 0 ? 1 : 0;
  s.unknowns = kept;
  return s.factorise();
}

void SeamFactor::solve(std::vector<float>& values, float negligible) const {
  // Visits few columns if snow covers little of the surface.
  const State& s = *state_;
  for (const int32_t j : s.unknowns) {
    const float x = values[j];
    if (std::fabs(x) < negligible) {
      values[j] = 0.0f;
      continue;
    }
    const int32_t end = s.begin[j] + s.count[j];
    for (int32_t e = s.begin[j]; e < end; ++e) values[s.row[e]] -= s.lower[e] * x;
  }
  for (size_t u = s.unknowns.size(); u-- > 0;) {
    const int32_t j = s.unknowns[u];
    if (values[j] == 0.0f) continue;
    float x = values[j] / s.diagonal[j];
    const int32_t end = s.begin[j] + s.count[j];
    for (int32_t e = s.begin[j]; e < end; ++e) x -= s.lower[e] * values[s.row[e]];
    values[j] = x;
  }
}

std::vector<int32_t> SeamFactor::components() const {
  const State& s = *state_;
  std::vector<int32_t>& last = state_->scratch;
  std::vector<int32_t> components(s.unknowns.size());
  for (size_t u = s.unknowns.size(); u-- > 0;) {
    const int32_t j = s.unknowns[u];
    // A column's first row is its parent in the elimination tree.
    int32_t e = s.begin[j];
    const int32_t end = e + s.count[j];
    while (e < end && s.lower[e] == 0.0f) ++e;
    last[j] = e == end ? j : last[s.row[e]];
    components[u] = last[j];
  }
  return components;
}

void SeamFactor::shrink() {
  for (std::vector<float>* values : {&state_->value, &state_->own, &state_->sums}) {
    *values = std::vector<float>();
  }
  for (std::vector<int32_t>* values : {&state_->analysed, &state_->path, &state_->path_end,
                                       &state_->seen_in, &state_->scratch, &state_->parent}) {
    *values = std::vector<int32_t>();
  }
  state_->row.shrink_to_fit();
  state_->lower.shrink_to_fit();
}

int64_t SeamFactor::bytes() const {
  const State& s = *state_;
  auto sum = static_cast<int64_t>(s.is_in.capacity() + s.is_stale.capacity());
  for (const std::vector<float>* values : {&s.value, &s.own, &s.lower, &s.diagonal, &s.sums}) {
    sum += static_cast<int64_t>(values->capacity() * sizeof(float));
  }
  for (const std::vector<int32_t>* values :
       {&s.unknowns, &s.analysed, &s.begin, &s.count, &s.row, &s.path, &s.path_end, &s.parent,
        &s.seen_in, &s.scratch}) {
    sum += static_cast<int64_t>(values->capacity() * sizeof(int32_t));
  }
  return sum;
}

}  // namespace snowbough::snow
