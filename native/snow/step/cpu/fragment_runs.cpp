#include "snow/step/cpu/fragment_runs.h"

#include <algorithm>
#include <numeric>
#include <span>
#include <utility>

#include "base/parallel_for.h"
#include "shaders/lib/snow_shared.h"

namespace snowbough::snow::cpu {
namespace {

/// Counts items by key.
class KeyCounts {
 public:
  explicit KeyCounts(size_t keys) : place_(keys, -1) {}

  void add(int32_t key) {
    if (place_[static_cast<size_t>(key)] < 0) {
      place_[static_cast<size_t>(key)] = 0;
      met_.push_back(key);
    }
    ++place_[static_cast<size_t>(key)];
  }
  /// Converts counts to offsets, keys ascending.
  void place() {
    std::sort(met_.begin(), met_.end());
    int32_t next = 0;
    for (const int32_t key : met_) next += std::exchange(place_[static_cast<size_t>(key)], next);
  }
  /// The next offset of a key.
  int32_t take(int32_t key) { return place_[static_cast<size_t>(key)]++; }
  void clear() {
    for (const int32_t key : met_) place_[static_cast<size_t>(key)] = -1;
    met_.clear();
  }

 private:
  std::vector<int32_t> place_;
  std::vector<int32_t> met_;
};

/// A fragment of the group being sorted.
struct Entry {
  int32_t fragment;
  int32_t triangle;
  int32_t square;
  uint16_t texel;
};

/// Sorts groups' fragments and finds their runs. One per thread.
class GroupSorter {
 public:
  GroupSorter(const TexelTable& table, std::span<const int32_t> order, size_t triangles)
      : table_(table),
        order_(order),
        squares_a_row_((table.resolution + kRunSquare - 1) / kRunSquare),
        squares_(static_cast<size_t>(squares_a_row_) * static_cast<size_t>(squares_a_row_)),
        triangles_(triangles) {}

  /// The fragments of a group by triangle, then by square.
  std::span<const Entry> sort(size_t group) {
    const size_t begin = group * shared::kTexelGroup;
    const auto texels =
        order_.subspan(begin, std::min<size_t>(shared::kTexelGroup, order_.size() - begin));
    sort_texels(texels);
    count_triangles();
    size_t count = 0;
    for (const int32_t i : texels) count += static_cast<size_t>(fragments_of(i));
    sorted_.resize(count);
    for (const Texel& texel : by_square_) {
      const int32_t end = table_.fragment_begin[static_cast<size_t>(texel.index) + 1];
      for (int32_t f = table_.fragment_begin[static_cast<size_t>(texel.index)]; f < end; ++f) {
        const int32_t triangle = table_.fragment_triangle[static_cast<size_t>(f)];
        sorted_[static_cast<size_t>(triangles_.take(triangle))] = {f, triangle, texel.square,
                                                                   texel.in_group};
      }
    }
    triangles_.clear();
    return sorted_;
  }

 private:
  struct Texel {
    int32_t index;
    int32_t square;
    uint16_t in_group;
  };

  int32_t fragments_of(int32_t i) const {
    return table_.fragment_begin[static_cast<size_t>(i) + 1] -
           table_.fragment_begin[static_cast<size_t>(i)];
  }

  int32_t square_of(int32_t i) const {
    const int32_t texel = table_.texel[static_cast<size_t>(i)];
    return texel / table_.resolution / kRunSquare * squares_a_row_ +
           texel % table_.resolution / kRunSquare;
  }

  void sort_texels(std::span<const int32_t> texels) {
    for (const int32_t i : texels) squares_.add(square_of(i));
    squares_.place();
    by_square_.resize(texels.size());
    for (size_t k = 0; k < texels.size(); ++k) {
      const int32_t square = square_of(texels[k]);
      by_square_[static_cast<size_t>(squares_.take(square))] = {texels[k], square,
                                                                static_cast<uint16_t>(k)};
    }
    squares_.clear();
  }

  void count_triangles() {
    for (const Texel& texel : by_square_) {
      const int32_t end = table_.fragment_begin[static_cast<size_t>(texel.index) + 1];
      for (int32_t f = table_.fragment_begin[static_cast<size_t>(texel.index)]; f < end; ++f) {
        triangles_.add(table_.fragment_triangle[static_cast<size_t>(f)]);
      }
    }
    triangles_.place();
  }

  const TexelTable& table_;
  std::span<const int32_t> order_;
  int32_t squares_a_row_;
  KeyCounts squares_;
  KeyCounts triangles_;
  std::vector<Texel> by_square_;
  std::vector<Entry> sorted_;
};

void widen(FragmentRuns::Run& run, glm::vec2 weights) {
  const float sum = weights.x + weights.y;
  run.least_b = std::min(run.least_b, weights.x);
  run.most_b = std::max(run.most_b, weights.x);
  run.least_c = std::min(run.least_c, weights.y);
  run.most_c = std::max(run.most_c, weights.y);
  run.least_sum = std::min(run.least_sum, sum);
  run.most_sum = std::max(run.most_sum, sum);
}

/// Writes a group's fragments from offset `at` on and appends its runs.
void write_group(const SceneObject& object, std::span<const Entry> entries, uint32_t first_triangle,
                 size_t at, FragmentRuns::Shared& all, std::vector<FragmentRuns::Run>& runs) {
  const Entry* last = nullptr;
  for (const Entry& entry : entries) {
    const auto f = static_cast<size_t>(entry.fragment);
    const glm::vec2 weights = object.table->fragment_barycentric[f];
    if (last == nullptr || entry.triangle != last->triangle || entry.square != last->square ||
        at - runs.back().begin == kMaxInRun) {
      const float sum = weights.x + weights.y;
      runs.push_back({static_cast<uint32_t>(entry.triangle) + first_triangle,
                      static_cast<uint32_t>(at), weights.x, weights.x, weights.y, weights.y, sum,
                      sum});
    }
    widen(runs.back(), weights);
    last = &entry;
    all.texel[at] = entry.texel;
    all.share[at] = object.table->fragment_share[f];
    all.weight_b[at] = weights.x;
    all.weight_c[at] = weights.y;
    if (!all.opacity.empty()) all.opacity[at] = object.fragment_opacity[f];
    ++at;
  }
}

}  // namespace

FragmentRuns make_fragment_runs(const SceneObject& object, const std::vector<int32_t>& order,
                                uint32_t first_triangle) {
  const TexelTable& table = *object.table;
  const size_t groups = (order.size() + shared::kTexelGroup - 1) / shared::kTexelGroup;
  std::vector<size_t> first_fragment(groups + 1, 0);
  for (size_t k = 0; k < order.size(); ++k) {
    const auto i = static_cast<size_t>(order[k]);
    first_fragment[k / shared::kTexelGroup + 1] +=
        static_cast<size_t>(table.fragment_begin[i + 1] - table.fragment_begin[i]);
  }
  std::partial_sum(first_fragment.begin(), first_fragment.end(), first_fragment.begin());

  FragmentRuns::Shared all;
  const size_t count = first_fragment.back();
  all.texel.resize(count);
  for (std::vector<float>* values : {&all.share, &all.weight_b, &all.weight_c}) {
    values->resize(count + kRunLanes - 1);
  }
  if (!object.fragment_opacity.empty()) all.opacity.resize(count);
  std::vector<std::vector<FragmentRuns::Run>> runs(groups);
  // Creating a sorter takes as long as sorting some groups.
  const size_t parts = std::min<size_t>(groups / 32 + 1, 4 * base::default_threads());
  base::for_each_item(parts, 1, [&](size_t part) {
    GroupSorter sorter(table, order, static_cast<size_t>(object.triangle_count()));
    for (size_t group = groups * part / parts; group < groups * (part + 1) / parts; ++group) {
      write_group(object, sorter.sort(group), first_triangle, first_fragment[group], all,
                  runs[group]);
    }
  });

  FragmentRuns result;
  result.group_begin.push_back(0);
  for (const std::vector<FragmentRuns::Run>& own : runs) {
    result.runs.insert(result.runs.end(), own.begin(), own.end());
    result.group_begin.push_back(static_cast<uint32_t>(result.runs.size()));
  }
  result.runs.push_back({0, static_cast<uint32_t>(count), 0, 0, 0, 0, 0, 0});
  result.part.resize(all.share.size());
  result.shared = std::make_shared<const FragmentRuns::Shared>(std::move(all));
  result.texel = result.shared->texel;
  result.share = result.shared->share;
  result.weight_b = result.shared->weight_b;
  result.weight_c = result.shared->weight_c;
  result.opacity = result.shared->opacity;
  return result;
}

FragmentRuns with_own_triangles(const FragmentRuns& other, uint32_t ahead) {
  FragmentRuns result = other;
  std::fill(result.part.begin(), result.part.end(), 0.0f);
  // The end marker has no triangle.
  for (auto run = result.runs.begin(); run + 1 < result.runs.end(); ++run) run->triangle += ahead;
  return result;
}

}  // namespace snowbough::snow::cpu
