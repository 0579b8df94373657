#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "snow/texel_draft.h"

namespace snowbough::snow {
namespace {

/// Triangles lower than this, in texels, have no area: rounding of their float UVs alone is more.
constexpr double kMinHeight = 1e-6;

bool is_degenerate(const UvTriangle& t) {
  const glm::dvec2 a = t[1] - t[0];
  const glm::dvec2 b = t[2] - t[0];
  const auto squared = [](glm::dvec2 d) { return d.x * d.x + d.y * d.y; };
  const double longest =
      std::max({squared(t[1] - t[0]), squared(t[2] - t[1]), squared(t[0] - t[2])});
  return std::abs(a.x * b.y - a.y * b.x) <= kMinHeight * std::sqrt(longest);
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

/// What the texels share while they are made: sums, and arrays that keep their memory.
struct Scratch {
  int64_t covered_samples = 0;
  int64_t shared_samples = 0;
  std::vector<Fragment> own;
  std::vector<std::pair<int32_t, double>> chart_areas;
};

/// The chart that covers most of a texel; of equals the lower number.
int32_t find_owner(const TexelDraft& draft, const Fragment* begin, const Fragment* end,
                   Scratch& scratch) {
  int32_t owner = draft.chart_of(begin->triangle);
  const bool one_chart = std::all_of(
      begin, end, [&](const Fragment& f) { return draft.chart_of(f.triangle) == owner; });
  if (one_chart) return owner;
  scratch.chart_areas.clear();
  for (const Fragment* f = begin; f != end; ++f) {
    scratch.chart_areas.push_back({draft.chart_of(f->triangle), f->area});
  }
  std::stable_sort(scratch.chart_areas.begin(), scratch.chart_areas.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  double most = -1.0;
  for (size_t i = 0; i < scratch.chart_areas.size();) {
    const int32_t chart = scratch.chart_areas[i].first;
    double area = 0.0;
    for (; i < scratch.chart_areas.size() && scratch.chart_areas[i].first == chart; ++i) {
      area += scratch.chart_areas[i].second;
    }
    if (area > most) {
      most = area;
      owner = chart;
    }
  }
  return owner;
}

void add_texel(TexelDraft& draft, const Fragment* begin, const Fragment* end, Scratch& scratch) {
  uint64_t once = 0;
  uint64_t twice = 0;
  for (const Fragment* f = begin; f != end; ++f) {
    twice |= once & f->samples;
    once |= f->samples;
    draft.triangle_area[f->triangle] += f->area;
  }
  scratch.covered_samples += std::popcount(once);
  scratch.shared_samples += std::popcount(twice);

  const int32_t owner = find_owner(draft, begin, end, scratch);
  scratch.own.clear();
  for (const Fragment* f = begin; f != end; ++f) {
    if (draft.chart_of(f->triangle) == owner) {
      scratch.own.push_back(*f);
    } else {
      draft.displaced.push_back(*f);
    }
  }
  append_texel(draft, owner, scratch.own);
}

}  // namespace

void cut_map(TexelDraft& draft) {
  const auto triangle_count = static_cast<int32_t>(draft.topology.triangles.size() / 3);
  const int32_t resolution = draft.topology.resolution;
  std::vector<std::array<int32_t, 2>> row_ranges(static_cast<size_t>(triangle_count));
  for (int32_t t = 0; t < triangle_count; ++t) {
    const UvTriangle uv = texel_triangle(draft.topology, t);
    if (is_degenerate(uv)) {
      ++draft.table.degenerate_triangles;
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
  draft.triangle_area.assign(static_cast<size_t>(triangle_count), 0.0);

  Scratch scratch;
  std::vector<Fragment> fragments;
  std::vector<Fragment> sorted;
  std::vector<int32_t> begin;
  for (int32_t row = 0, band = 0; row < resolution; row += bands.rows_per_band, ++band) {
    const int32_t row_end = std::min(resolution, row + bands.rows_per_band);
    fragments.clear();
    for (int64_t i = bands.begin[band]; i < bands.begin[band + 1]; ++i) {
      const int32_t t = bands.items[i];
      cut_triangle(texel_triangle(draft.topology, t), t, resolution, row, row_end, fragments);
    }
    const int32_t texel_count = (row_end - row) * resolution;
    sort_by_texel(fragments, row * resolution, texel_count, begin, sorted);
    for (int32_t i = 0; i < texel_count; ++i) {
      if (begin[i] < begin[i + 1])
        add_texel(draft, sorted.data() + begin[i], sorted.data() + begin[i + 1], scratch);
    }
  }
  draft.table.overlap = scratch.covered_samples == 0
                            ? 0.0f
                            : static_cast<float>(static_cast<double>(scratch.shared_samples) /
                                                 static_cast<double>(scratch.covered_samples));
}

}  // namespace snowbough::snow
