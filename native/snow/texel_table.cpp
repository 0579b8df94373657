#include "snow/texel_table.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "snow/charts.h"
#include "snow/uv_clip.h"

namespace snowbough::snow {
namespace {

constexpr int32_t kMinResolution = 64;
constexpr int32_t kMaxResolution = 8192;
/// How far coordinates may lie outside [0, 1]: what layout tools leave by rounding.
constexpr float kUvSlack = 1e-4f;
/// Triangles lower than this, in texels, have no area: rounding of their float UVs alone is more.
constexpr double kMinHeight = 1e-6;

void check_topology(const MapTopology& topology) {
  if (topology.resolution < kMinResolution || topology.resolution > kMaxResolution) {
    throw std::invalid_argument("resolution must be from 64 to 8192, not " +
                                std::to_string(topology.resolution));
  }
  if (topology.triangles.empty() || topology.triangles.size() % 3 != 0) {
    throw std::invalid_argument(
        "triangles must hold three vertex indices each, and at least one triangle");
  }
  if (topology.corner_uv.size() != topology.triangles.size()) {
    throw std::invalid_argument("uv must hold one coordinate a triangle corner: " +
                                std::to_string(topology.triangles.size()) + ", not " +
                                std::to_string(topology.corner_uv.size()));
  }
  for (const int32_t index : topology.triangles) {
    if (index < 0 || index >= topology.vertex_count) {
      throw std::invalid_argument("triangle index " + std::to_string(index) + " is out of range: " +
                                  std::to_string(topology.vertex_count) + " vertices");
    }
  }
  int64_t outside = 0;
  for (const glm::vec2 uv : topology.corner_uv) {
    const bool inside = uv.x >= -kUvSlack && uv.x <= 1.0f + kUvSlack && uv.y >= -kUvSlack &&
                        uv.y <= 1.0f + kUvSlack;
    if (!inside) ++outside;
  }
  if (outside > 0) {
    throw std::invalid_argument(
        std::to_string(outside) + " of " + std::to_string(topology.corner_uv.size()) +
        " texture coordinates lie outside [0, 1]: a snow map needs a UV layout "
        "that fits the unit square (pack the islands)");
  }
}

/// A triangle's UVs in texels, inside the map.
UvTriangle texel_triangle(const MapTopology& topology, int32_t triangle) {
  UvTriangle result;
  const auto size = static_cast<double>(topology.resolution);
  for (int32_t k = 0; k < 3; ++k) {
    const glm::vec2 uv = topology.corner_uv[3 * static_cast<size_t>(triangle) + k];
    result[k] = glm::dvec2(std::clamp(static_cast<double>(uv.x), 0.0, 1.0) * size,
                           std::clamp(static_cast<double>(uv.y), 0.0, 1.0) * size);
  }
  return result;
}

double cross(glm::dvec2 a, glm::dvec2 b) {
  return a.x * b.y - a.y * b.x;
}

bool is_degenerate(const UvTriangle& t) {
  const auto squared = [](glm::dvec2 d) { return d.x * d.x + d.y * d.y; };
  const double longest =
      std::max({squared(t[1] - t[0]), squared(t[2] - t[1]), squared(t[0] - t[2])});
  return std::abs(cross(t[1] - t[0], t[2] - t[0])) <= kMinHeight * std::sqrt(longest);
}

/// Triangles by the band of rows that they reach into: triangles of band b are
/// items[begin[b] .. begin[b + 1]), ascending.
struct Bands {
  int32_t rows_per_band = 1;
  std::vector<int64_t> begin;
  std::vector<int32_t> items;
};

Bands sort_into_bands(const std::vector<std::array<int32_t, 2>>& row_ranges, int32_t resolution) {
  Bands bands;
  // About 64 k texels a band keep its working arrays in the cache and small at any resolution.
  bands.rows_per_band = std::clamp(65536 / resolution, 1, resolution);
  const int32_t band_count = (resolution + bands.rows_per_band - 1) / bands.rows_per_band;
  bands.begin.assign(static_cast<size_t>(band_count) + 1, 0);
  const auto for_each_band = [&](const std::array<int32_t, 2>& rows, auto&& visit) {
    if (rows[0] > rows[1]) return;
    for (int32_t b = rows[0] / bands.rows_per_band; b <= rows[1] / bands.rows_per_band; ++b)
      visit(b);
  };
  for (const auto& rows : row_ranges) for_each_band(rows, [&](int32_t b) { ++bands.begin[b + 1]; });
  for (int32_t b = 0; b < band_count; ++b) bands.begin[b + 1] += bands.begin[b];
  bands.items.resize(static_cast<size_t>(bands.begin.back()));
  std::vector<int64_t> next(bands.begin.begin(), bands.begin.end() - 1);
  for (size_t t = 0; t < row_ranges.size(); ++t) {
    for_each_band(row_ranges[t],
                  [&](int32_t b) { bands.items[next[b]++] = static_cast<int32_t>(t); });
  }
  return bands;
}

/// Sorts a band's fragments by texel, keeping triangles ascending within one.
void sort_by_texel(std::vector<Fragment>& fragments, int32_t first_texel, int32_t texel_count,
                   std::vector<int32_t>& begin, std::vector<Fragment>& sorted) {
  begin.assign(static_cast<size_t>(texel_count) + 1, 0);
  for (const Fragment& f : fragments) ++begin[f.texel - first_texel + 1];
  for (int32_t i = 0; i < texel_count; ++i) begin[i + 1] += begin[i];
  std::vector<int32_t> next(begin.begin(), begin.end() - 1);
  sorted.resize(fragments.size());
  for (const Fragment& f : fragments) sorted[next[f.texel - first_texel]++] = f;
}

class TableBuilder {
 public:
  explicit TableBuilder(const MapTopology& topology)
      : topology_(topology), charts_(find_charts(topology)) {
    table_.resolution = topology.resolution;
    table_.chart_count = charts_.count;
    table_.fragment_begin.push_back(0);
    own_texels_.assign(static_cast<size_t>(charts_.count), 0);
  }

  TexelTable build() {
    cut_all_triangles();
    give_homeless_charts_a_texel();
    credit_displaced_fragments();
    scale_shares();
    return std::move(table_);
  }

 private:
  int32_t chart_of(int32_t triangle) const { return charts_.chart[triangle]; }

  void cut_all_triangles() {
    const auto triangle_count = static_cast<int32_t>(topology_.triangles.size() / 3);
    const int32_t resolution = topology_.resolution;
    std::vector<std::array<int32_t, 2>> row_ranges(static_cast<size_t>(triangle_count));
    for (int32_t t = 0; t < triangle_count; ++t) {
      const UvTriangle uv = texel_triangle(topology_, t);
      if (is_degenerate(uv)) {
        ++table_.degenerate_triangles;
        row_ranges[t] = {1, 0};
        continue;
      }
      const auto row = [&](double y) {
        return std::clamp(static_cast<int32_t>(std::floor(y)), 0, resolution - 1);
      };
      row_ranges[t] = {row(std::min({uv[0].y, uv[1].y, uv[2].y})),
                       row(std::max({uv[0].y, uv[1].y, uv[2].y}))};
    }
    const Bands bands = sort_into_bands(row_ranges, resolution);
    triangle_area_.assign(static_cast<size_t>(triangle_count), 0.0);

    std::vector<Fragment> fragments;
    std::vector<Fragment> sorted;
    std::vector<int32_t> begin;
    for (int32_t row = 0, band = 0; row < resolution; row += bands.rows_per_band, ++band) {
      const int32_t row_end = std::min(resolution, row + bands.rows_per_band);
      fragments.clear();
      for (int64_t i = bands.begin[band]; i < bands.begin[band + 1]; ++i) {
        const int32_t t = bands.items[i];
        cut_triangle(texel_triangle(topology_, t), t, resolution, row, row_end, fragments);
      }
      const int32_t texel_count = (row_end - row) * resolution;
      sort_by_texel(fragments, row * resolution, texel_count, begin, sorted);
      for (int32_t i = 0; i < texel_count; ++i) {
        if (begin[i] < begin[i + 1])
          add_texel(sorted.data() + begin[i], sorted.data() + begin[i + 1]);
      }
    }
    table_.overlap = covered_samples_ == 0
                         ? 0.0f
                         : static_cast<float>(static_cast<double>(shared_samples_) /
                                              static_cast<double>(covered_samples_));
  }

  /// The chart that covers most of a texel; of equals the lower number.
  int32_t find_owner(const Fragment* begin, const Fragment* end) {
    int32_t owner = chart_of(begin->triangle);
    const bool one_chart =
        std::all_of(begin, end, [&](const Fragment& f) { return chart_of(f.triangle) == owner; });
    if (one_chart) return owner;
    chart_areas_.clear();
    for (const Fragment* f = begin; f != end; ++f) {
      chart_areas_.push_back({chart_of(f->triangle), f->area});
    }
    std::stable_sort(chart_areas_.begin(), chart_areas_.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    double most = -1.0;
    for (size_t i = 0; i < chart_areas_.size();) {
      const int32_t chart = chart_areas_[i].first;
      double area = 0.0;
      for (; i < chart_areas_.size() && chart_areas_[i].first == chart; ++i) {
        area += chart_areas_[i].second;
      }
      if (area > most) {
        most = area;
        owner = chart;
      }
    }
    return owner;
  }

  void add_texel(const Fragment* begin, const Fragment* end) {
    uint64_t once = 0;
    uint64_t twice = 0;
    for (const Fragment* f = begin; f != end; ++f) {
      twice |= once & f->samples;
      once |= f->samples;
      triangle_area_[f->triangle] += f->area;
    }
    covered_samples_ += std::popcount(once);
    shared_samples_ += std::popcount(twice);

    const int32_t owner = find_owner(begin, end);
    own_.clear();
    for (const Fragment* f = begin; f != end; ++f) {
      if (chart_of(f->triangle) == owner) {
        own_.push_back(*f);
      } else {
        displaced_.push_back(*f);
      }
    }
    append_texel(owner, own_);
  }

  /// Appends an owned texel and its fragments (areas for now; scale_shares makes them shares).
  void append_texel(int32_t owner, const std::vector<Fragment>& own) {
    const TexelSample sample = find_sample(own);
    table_.texel.push_back(own.front().texel);
    table_.triangle.push_back(sample.triangle);
    table_.barycentric.push_back(sample.barycentric);
    table_.chart.push_back(owner);
    table_.coverage.push_back(sample.coverage);
    for (const Fragment& f : own) {
      table_.fragment_triangle.push_back(f.triangle);
      table_.fragment_share.push_back(static_cast<float>(f.area));
    }
    table_.fragment_begin.push_back(static_cast<int32_t>(table_.fragment_triangle.size()));
    ++own_texels_[owner];
  }

  struct TexelSample {
    int32_t triangle;
    glm::vec2 barycentric;
    float coverage;
  };

  /// Weights of the second and third corner.
  glm::dvec2 barycentric_at(int32_t triangle, glm::dvec2 point) const {
    const UvTriangle uv = texel_triangle(topology_, triangle);
    const glm::dvec2 a = uv[1] - uv[0];
    const glm::dvec2 b = uv[2] - uv[0];
    const glm::dvec2 p = point - uv[0];
    const double area = cross(a, b);
    return {cross(p, b) / area, cross(a, p) / area};
  }

  static double smallest_weight(glm::dvec2 weights) {
    return std::min({1.0 - weights.x - weights.y, weights.x, weights.y});
  }

  /// The fragment's triangle that holds the point best, if any does (within rounding).
  bool find_triangle(const std::vector<Fragment>& own, glm::dvec2 point,
                     TexelSample& sample) const {
    double best = -1e-9;
    bool found = false;
    for (const Fragment& f : own) {
      const glm::dvec2 weights = barycentric_at(f.triangle, point);
      const double least = smallest_weight(weights);
      if (least < best || (found && least <= best)) continue;
      best = least;
      found = true;
      sample.triangle = f.triangle;
      sample.barycentric = clamped(weights);
    }
    return found;
  }

  static glm::vec2 clamped(glm::dvec2 weights) {
    weights = glm::dvec2(std::clamp(weights.x, 0.0, 1.0), std::clamp(weights.y, 0.0, 1.0));
    const double sum = weights.x + weights.y;
    if (sum > 1.0) weights /= sum;
    return {static_cast<float>(weights.x), static_cast<float>(weights.y)};
  }

  TexelSample find_sample(const std::vector<Fragment>& own) const {
    TexelSample sample{};
    double area = 0.0;
    glm::dvec2 weighted(0.0);
    const Fragment* largest = &own.front();
    for (const Fragment& f : own) {
      area += f.area;
      weighted += f.area * f.centroid;
      if (f.area > largest->area) largest = &f;
    }
    sample.coverage = static_cast<float>(std::min(area, 1.0));
    const int32_t texel = own.front().texel;
    const glm::dvec2 centre(texel % table_.resolution + 0.5, texel / table_.resolution + 0.5);
    if (find_triangle(own, centre, sample)) return sample;
    if (find_triangle(own, weighted / area, sample)) return sample;
    sample.triangle = largest->triangle;
    sample.barycentric = clamped(barycentric_at(largest->triangle, largest->centroid));
    return sample;
  }

  /// Position of a texel among the owned ones. It must be there.
  size_t owned_index(int32_t texel) const {
    return static_cast<size_t>(std::lower_bound(table_.texel.begin(), table_.texel.end(), texel) -
                               table_.texel.begin());
  }

  /// Charts that own nothing take the texel they cover most, where its owner can spare it.
  void give_homeless_charts_a_texel() {
    std::vector<Fragment> homeless;
    for (const Fragment& f : displaced_) {
      if (own_texels_[chart_of(f.triangle)] == 0) homeless.push_back(f);
    }
    if (homeless.empty()) return;
    std::sort(homeless.begin(), homeless.end(), [&](const Fragment& a, const Fragment& b) {
      const int32_t chart_a = chart_of(a.triangle);
      const int32_t chart_b = chart_of(b.triangle);
      if (chart_a != chart_b) return chart_a < chart_b;
      return a.texel != b.texel ? a.texel < b.texel : a.triangle < b.triangle;
    });

    struct Claim {
      double area;
      size_t begin;
      size_t end;
    };
    // New owners by owned index, applied in one go below.
    std::vector<std::pair<size_t, std::vector<Fragment>>> takings;
    std::vector<bool> taken(table_.texel.size(), false);
    for (size_t begin = 0; begin < homeless.size();) {
      const int32_t chart = chart_of(homeless[begin].triangle);
      std::vector<Claim> claims;
      size_t end = begin;
      while (end < homeless.size() && chart_of(homeless[end].triangle) == chart) {
        Claim claim{0.0, end, end};
        while (claim.end < homeless.size() && chart_of(homeless[claim.end].triangle) == chart &&
               homeless[claim.end].texel == homeless[end].texel) {
          claim.area += homeless[claim.end++].area;
        }
        end = claim.end;
        claims.push_back(claim);
      }
      std::stable_sort(claims.begin(), claims.end(),
                       [](const Claim& a, const Claim& b) { return a.area > b.area; });
      bool settled = false;
      for (const Claim& claim : claims) {
        const size_t owned = owned_index(homeless[claim.begin].texel);
        if (taken[owned] || own_texels_[table_.chart[owned]] < 2) continue;
        taken[owned] = true;
        --own_texels_[table_.chart[owned]];
        ++own_texels_[chart];
        takings.emplace_back(owned, std::vector<Fragment>(homeless.begin() + claim.begin,
                                                          homeless.begin() + claim.end));
        settled = true;
        break;
      }
      if (!settled) ++table_.homeless_charts;
      begin = end;
    }
    hand_over(takings);
  }

  void hand_over(std::vector<std::pair<size_t, std::vector<Fragment>>>& takings) {
    if (takings.empty()) return;
    std::sort(takings.begin(), takings.end(),
              [](const auto& a, const auto& b) { return a.first < b.first; });
    const TexelTable before = std::move(table_);
    table_ = TexelTable{};
    table_.resolution = before.resolution;
    table_.chart_count = before.chart_count;
    table_.degenerate_triangles = before.degenerate_triangles;
    table_.homeless_charts = before.homeless_charts;
    table_.overlap = before.overlap;
    table_.fragment_begin.push_back(0);
    const std::vector<int32_t> counts = own_texels_;
    auto next = takings.begin();
    for (size_t i = 0; i < before.texel.size(); ++i) {
      const int32_t begin = before.fragment_begin[i];
      const int32_t end = before.fragment_begin[i + 1];
      if (next != takings.end() && next->first == i) {
        const glm::dvec2 centre(before.texel[i] % before.resolution + 0.5,
                                before.texel[i] / before.resolution + 0.5);
        for (int32_t f = begin; f < end; ++f) {
          displaced_.push_back({before.texel[i], before.fragment_triangle[f],
                                static_cast<double>(before.fragment_share[f]), centre, 0});
        }
        append_texel(chart_of(next->second.front().triangle), next->second);
        ++next;
        continue;
      }
      table_.texel.push_back(before.texel[i]);
      table_.triangle.push_back(before.triangle[i]);
      table_.barycentric.push_back(before.barycentric[i]);
      table_.chart.push_back(before.chart[i]);
      table_.coverage.push_back(before.coverage[i]);
      table_.fragment_triangle.insert(table_.fragment_triangle.end(),
                                      before.fragment_triangle.begin() + begin,
                                      before.fragment_triangle.begin() + end);
      table_.fragment_share.insert(table_.fragment_share.end(),
                                   before.fragment_share.begin() + begin,
                                   before.fragment_share.begin() + end);
      table_.fragment_begin.push_back(static_cast<int32_t>(table_.fragment_triangle.size()));
    }
    own_texels_ = counts;
    // What the new owners hold is displaced no longer.
    std::erase_if(displaced_, [&](const Fragment& f) {
      const size_t i = owned_index(f.texel);
      return table_.chart[i] == chart_of(f.triangle);
    });
  }

  /// Index of the chart's own texel nearest to a point; rows are searched outwards, the columns of
  /// a row by bisection.
  size_t nearest_own_texel(const std::vector<int32_t>& own, glm::dvec2 point) const {
    const int32_t resolution = table_.resolution;
    const auto home_row = static_cast<int32_t>(std::floor(point.y));
    double best = std::numeric_limits<double>::infinity();
    int32_t best_texel = -1;
    const auto consider = [&](int32_t texel) {
      const glm::dvec2 d = glm::dvec2(texel % resolution + 0.5, texel / resolution + 0.5) - point;
      const double squared = d.x * d.x + d.y * d.y;
      if (squared < best || (squared == best && texel < best_texel)) {
        best = squared;
        best_texel = texel;
      }
    };
    const auto search_row = [&](int32_t row) {
      const int64_t wanted = static_cast<int64_t>(row) * resolution + static_cast<int64_t>(point.x);
      const auto at = std::lower_bound(own.begin(), own.end(), wanted,
                                       [](int32_t texel, int64_t w) { return texel < w; });
      if (at != own.end() && *at / resolution == row) consider(*at);
      if (at != own.begin() && *(at - 1) / resolution == row) consider(*(at - 1));
    };
    for (int32_t distance = 0; distance <= resolution; ++distance) {
      const double nearest_possible = std::max(0.0, distance - 1.0);
      if (nearest_possible * nearest_possible > best) break;
      if (home_row - distance >= 0) search_row(home_row - distance);
      if (distance > 0 && home_row + distance < resolution) search_row(home_row + distance);
    }
    return owned_index(best_texel);
  }

  /// Fragments in texels of other charts go to their own chart's nearest texel.
  void credit_displaced_fragments() {
    if (displaced_.empty()) return;
    std::vector<std::vector<int32_t>> own(static_cast<size_t>(table_.chart_count));
    for (const Fragment& f : displaced_) own[chart_of(f.triangle)] = {-1};
    for (size_t i = 0; i < table_.texel.size(); ++i) {
      std::vector<int32_t>& texels = own[table_.chart[i]];
      if (!texels.empty()) texels.push_back(table_.texel[i]);
    }
    struct Credit {
      size_t owned;
      int32_t triangle;
      float area;
    };
    std::vector<Credit> credits;
    credits.reserve(displaced_.size());
    for (const Fragment& f : displaced_) {
      std::vector<int32_t>& texels = own[chart_of(f.triangle)];
      if (texels.front() == -1) texels.erase(texels.begin());
      // A homeless chart's area stays where it is.
      const size_t owned =
          texels.empty() ? owned_index(f.texel) : nearest_own_texel(texels, f.centroid);
      if (texels.empty()) texels.push_back(-1);
      credits.push_back({owned, f.triangle, static_cast<float>(f.area)});
    }
    std::stable_sort(credits.begin(), credits.end(), [](const Credit& a, const Credit& b) {
      return a.owned != b.owned ? a.owned < b.owned : a.triangle < b.triangle;
    });

    std::vector<int32_t> begin{0};
    std::vector<int32_t> triangle;
    std::vector<float> area;
    begin.reserve(table_.fragment_begin.size());
    triangle.reserve(table_.fragment_triangle.size() + credits.size());
    area.reserve(table_.fragment_triangle.size() + credits.size());
    std::vector<std::pair<int32_t, float>> merged;
    auto credit = credits.begin();
    for (size_t i = 0; i < table_.texel.size(); ++i) {
      merged.clear();
      for (int32_t f = table_.fragment_begin[i]; f < table_.fragment_begin[i + 1]; ++f) {
        merged.emplace_back(table_.fragment_triangle[f], table_.fragment_share[f]);
      }
      if (credit != credits.end() && credit->owned == i) {
        for (; credit != credits.end() && credit->owned == i; ++credit) {
          merged.emplace_back(credit->triangle, credit->area);
        }
        std::stable_sort(merged.begin(), merged.end(),
                         [](const auto& a, const auto& b) { return a.first < b.first; });
      }
      for (size_t m = 0; m < merged.size(); ++m) {
        if (m > 0 && merged[m].first == merged[m - 1].first) {
          area.back() += merged[m].second;
        } else {
          triangle.push_back(merged[m].first);
          area.push_back(merged[m].second);
        }
      }
      begin.push_back(static_cast<int32_t>(triangle.size()));
    }
    table_.fragment_begin = std::move(begin);
    table_.fragment_triangle = std::move(triangle);
    table_.fragment_share = std::move(area);
  }

  /// Areas become shares of their triangles. The sum of the cut areas is the divisor, not the
  /// triangle's own area, so that slivers, whose cuts round coarsely, sum to 1 as well.
  void scale_shares() {
    for (size_t f = 0; f < table_.fragment_share.size(); ++f) {
      const double whole = triangle_area_[table_.fragment_triangle[f]];
      table_.fragment_share[f] = static_cast<float>(table_.fragment_share[f] / whole);
    }
  }

  const MapTopology& topology_;
  const Charts charts_;
  TexelTable table_;
  /// Per triangle: the area of all its fragments in texels.
  std::vector<double> triangle_area_;
  /// Per chart: how many texels it owns.
  std::vector<int32_t> own_texels_;
  /// Fragments that lie in texels of other charts.
  std::vector<Fragment> displaced_;
  int64_t covered_samples_ = 0;
  int64_t shared_samples_ = 0;
  /// Scratch of add_texel.
  std::vector<Fragment> own_;
  std::vector<std::pair<int32_t, double>> chart_areas_;
};

}  // namespace

TexelTable build_texel_table(const MapTopology& topology) {
  check_topology(topology);
  return TableBuilder(topology).build();
}

}  // namespace snowbough::snow
