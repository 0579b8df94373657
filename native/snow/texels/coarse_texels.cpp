#include "snow/texels/coarse_texels.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "base/group_by_key.h"

namespace snowbough::snow {
namespace {

/// A texel belongs to a square at most this many squares away.
constexpr int32_t kFarthest = 6;
/// A square with less surface joins one beside it: links over rims and seams start a quarter of a
/// texel inside.
constexpr float kSliver = 0.3f;
/// Maps of fewer squares a side are not worth it.
constexpr int32_t kSmallest = 32;

class TexelJoiner {
 public:
  TexelJoiner(const TexelTable& fine, int32_t side)
      : fine_(fine),
        side_(side),
        shift_(std::countr_zero(static_cast<uint32_t>(side))),
        size_(fine.resolution / side),
        chart_(static_cast<size_t>(size_) * static_cast<size_t>(size_), -1),
        covered_(chart_.size(), 0.0f) {}

  std::optional<CoarseTexels> join() {
    find_charts();
    dissolve_slivers();
    if (!find_parents()) return std::nullopt;
    for (size_t i = 0; i + 1 < joined_.begin.size(); ++i) add_texel(i);
    joined_.table.fragment_begin.push_back(
        static_cast<int32_t>(joined_.table.fragment_triangle.size()));
    joined_.table.resolution = size_;
    joined_.table.chart_count = fine_.chart_count;
    return std::move(joined_);
  }

 private:
  int32_t place(int32_t texel) const { return fine_.texel[static_cast<size_t>(texel)]; }
  int32_t column(int32_t texel) const { return place(texel) % fine_.resolution; }
  int32_t row(int32_t texel) const { return place(texel) / fine_.resolution; }
  int32_t square_of(int32_t texel) const {
    return (row(texel) >> shift_) * size_ + (column(texel) >> shift_);
  }

  /// The chart with the largest part of each square.
  void find_charts() {
    const auto for_texels = [&](const auto& visit) {
      for (size_t i = 0; i < fine_.texel.size(); ++i) {
        const auto texel = static_cast<int32_t>(i);
        visit(square_of(texel), texel);
      }
    };
    std::vector<int32_t> begin;
    std::vector<int32_t> texels;
    base::group_by_key(chart_.size(), for_texels, begin, texels);
    for (size_t s = 0; s < chart_.size(); ++s) {
      const auto first = texels.begin() + begin[s];
      const auto last = texels.begin() + begin[s + 1];
      const auto chart = [&](int32_t texel) { return fine_.chart[static_cast<size_t>(texel)]; };
      float& most = covered_[s];
      for (auto own = first; own != last; ++own) {
        if (own != first && chart(*own) == chart_[s]) continue;
        float covered = 0.0f;
        for (auto other = own; other != last; ++other) {
          if (chart(*other) == chart(*own)) covered += fine_.coverage[static_cast<size_t>(*other)];
        }
        if (own != first && !(covered > most)) continue;
        most = covered;
        chart_[s] = chart(*own);
      }
    }
  }

  /// Takes the charts from slivers beside larger squares.
  void dissolve_slivers() {
    const std::vector<int32_t> charts = chart_;
    const float least = kSliver * static_cast<float>(side_ * side_);
    const auto is_large = [&](int32_t x, int32_t y, int32_t chart) {
      if (x < 0 || y < 0 || x >= size_ || y >= size_) return false;
      const auto s = static_cast<size_t>(y * size_ + x);
      return charts[s] == chart && covered_[s] >= least;
    };
    for (int32_t s = 0; s < size_ * size_; ++s) {
      int32_t& chart = chart_[static_cast<size_t>(s)];
      if (chart < 0 || covered_[static_cast<size_t>(s)] >= least) continue;
      for (int32_t i = 0; i < 9 && chart >= 0; ++i) {
        if (is_large(s % size_ + i % 3 - 1, s / size_ + i / 3 - 1, chart)) chart = -1;
      }
    }
  }

  /// The nearest square of a texel's chart; -1: none is near.
  int32_t nearest_square(int32_t texel) const {
    const int32_t own = square_of(texel);
    const int32_t chart = fine_.chart[static_cast<size_t>(texel)];
    if (chart_[static_cast<size_t>(own)] == chart) return own;
    int32_t nearest = -1;
    int32_t least = 0;
    for (int32_t ring = 1; ring <= kFarthest && nearest < 0; ++ring) {
      for (int32_t y = own / size_ - ring; y <= own / size_ + ring; ++y) {
        for (int32_t x = own % size_ - ring; x <= own % size_ + ring; ++x) {
          if (x < 0 || y < 0 || x >= size_ || y >= size_) continue;
          if (chart_[static_cast<size_t>(y * size_ + x)] != chart) continue;
          // From the square's middle, in half texels.
          const int32_t dx = 2 * column(texel) + 1 - (2 * x + 1) * side_;
          const int32_t dy = 2 * row(texel) + 1 - (2 * y + 1) * side_;
          const int32_t away = dx * dx + dy * dy;
          if (nearest >= 0 && away >= least) continue;
          nearest = y * size_ + x;
          least = away;
        }
      }
    }
    return nearest;
  }

  bool find_parents() {
    joined_.parent.resize(fine_.texel.size());
    for (size_t i = 0; i < joined_.parent.size(); ++i) {
      joined_.parent[i] = nearest_square(static_cast<int32_t>(i));
      if (joined_.parent[i] < 0) return false;
    }
    // A square's texels may all belong to others.
    std::vector<int32_t> number(chart_.size(), -1);
    for (const int32_t square : joined_.parent) number[static_cast<size_t>(square)] = 0;
    for (size_t s = 0; s < number.size(); ++s) {
      if (number[s] < 0) continue;
      number[s] = static_cast<int32_t>(joined_.table.texel.size());
      joined_.table.texel.push_back(static_cast<int32_t>(s));
      joined_.table.chart.push_back(chart_[s]);
    }
    for (int32_t& parent : joined_.parent) parent = number[static_cast<size_t>(parent)];
    const auto for_texels = [&](const auto& visit) {
      for (size_t i = 0; i < joined_.parent.size(); ++i) {
        visit(joined_.parent[i], static_cast<int32_t>(i));
      }
    };
    base::group_by_key(joined_.table.texel.size(), for_texels, joined_.begin, joined_.texel);
    return true;
  }

  /// Sets coarse texel i from its texels.
  void add_texel(size_t i) {
    TexelTable& table = joined_.table;
    const auto first = joined_.texel.begin() + joined_.begin[i];
    const auto last = joined_.texel.begin() + joined_.begin[i + 1];
    float covered = 0.0f;
    int64_t columns = 0;
    int64_t rows = 0;
    for (auto own = first; own != last; ++own) {
      covered += fine_.coverage[static_cast<size_t>(*own)];
      columns += column(*own);
      rows += row(*own);
    }
    const int64_t count = last - first;
    int32_t middle = *first;
    int64_t least = -1;
    for (auto own = first; own != last; ++own) {
      const int64_t dx = count * column(*own) - columns;
      const int64_t dy = count * row(*own) - rows;
      const int64_t away = dx * dx + dy * dy;
      if (least >= 0 && away >= least) continue;
      least = away;
      middle = *own;
    }
    joined_.middle.push_back(middle);
    table.coverage.push_back(std::min(1.0f, covered / static_cast<float>(side_ * side_)));
    const int32_t triangle = fine_.triangle[static_cast<size_t>(middle)];
    glm::vec2 weights(0.0f);
    float alike = 0.0f;
    for (auto own = first; own != last; ++own) {
      if (fine_.triangle[static_cast<size_t>(*own)] != triangle) continue;
      weights += fine_.barycentric[static_cast<size_t>(*own)];
      alike += 1.0f;
    }
    table.triangle.push_back(triangle);
    table.barycentric.push_back(weights / alike);
    add_fragments(first, last);
  }

  /// Fragments of one triangle become one.
  void add_fragments(std::vector<int32_t>::const_iterator first,
                     std::vector<int32_t>::const_iterator last) {
    TexelTable& table = joined_.table;
    const auto begin = static_cast<ptrdiff_t>(table.fragment_triangle.size());
    table.fragment_begin.push_back(static_cast<int32_t>(begin));
    for (auto own = first; own != last; ++own) {
      const auto t = static_cast<size_t>(*own);
      for (int32_t g = fine_.fragment_begin[t]; g < fine_.fragment_begin[t + 1]; ++g) {
        const auto f = static_cast<size_t>(g);
        const auto known = std::find(table.fragment_triangle.begin() + begin,
                                     table.fragment_triangle.end(), fine_.fragment_triangle[f]);
        const float share = fine_.fragment_share[f];
        const glm::vec2 weights = fine_.fragment_barycentric[f];
        if (known == table.fragment_triangle.end()) {
          table.fragment_triangle.push_back(fine_.fragment_triangle[f]);
          table.fragment_share.push_back(share);
          table.fragment_barycentric.push_back(weights);
          continue;
        }
        const auto at = static_cast<size_t>(known - table.fragment_triangle.begin());
        float& whole = table.fragment_share[at];
        glm::vec2& mean = table.fragment_barycentric[at];
        whole += share;
        if (whole > 0.0f) mean += share / whole * (weights - mean);
      }
    }
  }

  const TexelTable& fine_;
  int32_t side_;
  /// Its logarithm: a division of each texel's column and row would take a third of all time.
  int shift_;
  int32_t size_;
  /// By square: its chart, -1: none; and how many texels that covers.
  std::vector<int32_t> chart_;
  std::vector<float> covered_;
  CoarseTexels joined_;
};

}  // namespace

std::optional<CoarseTexels> join_texels(const TexelTable& table, int32_t side) {
  if (table.resolution % side != 0 || table.resolution / side < kSmallest) return std::nullopt;
  return TexelJoiner(table, side).join();
}

}  // namespace snowbough::snow
