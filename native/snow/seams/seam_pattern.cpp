#include "snow/seams/seam_pattern.h"

#include "base/group_by_key.h"

namespace snowbough::snow {
namespace {

/// Per unknown its terms, as row * kSeamTerms + number: those of unknown i are [begin[i], begin[i +
/// 1]) of term.
struct PatternTerms {
  std::vector<int32_t> begin;
  std::vector<int32_t> term;
};

PatternTerms terms_of(const std::vector<SeamRow>& rows, int32_t unknowns) {
  const auto for_each_term = [&](const auto& visit) {
    for (size_t r = 0; r < rows.size(); ++r) {
      for (int32_t t = 0; t < kSeamTerms && rows[r].source[t] < unknowns; ++t) {
        visit(rows[r].source[t], static_cast<int32_t>(r) * kSeamTerms + t);
      }
    }
  };
  PatternTerms terms;
  base::group_by_key(static_cast<size_t>(unknowns), for_each_term, terms.begin, terms.term);
  return terms;
}

}  // namespace

SeamPattern::SeamPattern(const std::vector<SeamRow>& rows, int32_t unknowns) {
  const PatternTerms terms = terms_of(rows, unknowns);
  // Per unknown: its entry in the last column that contains it.
  std::vector<int32_t> entry(static_cast<size_t>(unknowns), -1);
  begin_.reserve(static_cast<size_t>(unknowns) + 1);
  offset_.resize(rows.size() * kPairs);
  for (int32_t column = 0; column < unknowns; ++column) {
    const int32_t first = begin_.back();
    for (int32_t k = terms.begin[column]; k < terms.begin[column + 1]; ++k) {
      const int32_t r = terms.term[k] / kSeamTerms;
      const int32_t own = terms.term[k] % kSeamTerms;
      uint16_t* const offset = offset_.data() + static_cast<size_t>(r) * kPairs +
                               static_cast<size_t>(own) * static_cast<size_t>(own - 1) / 2;
      for (int32_t t = 0; t < own; ++t) {
        int32_t& at = entry[rows[r].source[t]];
        if (at < first) {
          at = static_cast<int32_t>(row_.size());
          row_.push_back(rows[r].source[t]);
        }
        offset[t] = static_cast<uint16_t>(at - first);
      }
    }
    begin_.push_back(static_cast<int32_t>(row_.size()));
    if (begin_.back() - first > kMaxOffset) is_complete_ = false;
  }
  row_.shrink_to_fit();
}

int64_t SeamPattern::bytes() const {
  return static_cast<int64_t>((begin_.capacity() + row_.capacity()) * sizeof(int32_t) +
                              offset_.capacity() * sizeof(uint16_t));
}

}  // namespace snowbough::snow
