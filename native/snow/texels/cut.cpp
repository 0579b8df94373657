#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <functional>
#include <span>

#include "base/group_by_key.h"
#include "base/parallel_for.h"
#include "snow/texels/texel_table_builder.h"

namespace snowbough::snow {
namespace {

/// Minimum height of a triangle in texels: rounding of its float UVs alone is larger.
constexpr double kMinHeight = 1e-6;

bool is_degenerate(const UvTriangle& t) {
  const glm::dvec2 a = t[1] - t[0];
  const glm::dvec2 b = t[2] - t[0];
  const auto squared = [](glm::dvec2 d) { return d.x * d.x + d.y * d.y; };
  const double longest =
      std::max({squared(t[1] - t[0]), squared(t[2] - t[1]), squared(t[0] - t[2])});
  return std::abs(a.x * b.y - a.y * b.x) <= kMinHeight * std::sqrt(longest);
}

/// Triangles by the bands of rows that they touch: the triangles of band b are items[begin[b] ..
/// begin[b + 1]), ascending.
struct Bands {
  int32_t rows_per_band = 1;
  std::vector<int64_t> begin;
  std::vector<int32_t> items;
};

Bands sort_into_bands(const std::vector<std::array<int32_t, 2>>& row_ranges, int32_t resolution) {
  Bands bands;
  // About 64 k texels per band keep its working arrays in the cache and small at any resolution.
  bands.rows_per_band = std::clamp(65536 / resolution, 1, resolution);
  const int32_t band_count = (resolution + bands.rows_per_band - 1) / bands.rows_per_band;
  const auto for_each_band = [&](const auto& visit) {
    for (size_t t = 0; t < row_ranges.size(); ++t) {
      const auto [low, high] = row_ranges[t];
      if (low > high) continue;
      for (int32_t b = low / bands.rows_per_band; b <= high / bands.rows_per_band; ++b) {
        visit(b, static_cast<int32_t>(t));
      }
    }
  };
  base::group_by_key(static_cast<size_t>(band_count), for_each_band, bands.begin, bands.items);
  return bands;
}

/// An owned texel; its fragments end at number fragment_end of the band.
struct BandTexel {
  int32_t texel;
  int32_t chart;
  TexelSample sample;
  int32_t fragment_end;
};

struct BandFragment {
  int32_t triangle;
  float area;
  glm::vec2 barycentric;
};

/// The texels of a band of rows, ascending.
struct BandTexels {
  std::vector<BandTexel> texels;
  std::vector<BandFragment> fragments;
  std::vector<Fragment> displaced;
  /// Per triangle of the band: its area in the band, in texels.
  std::vector<double> triangle_area;
  int64_t covered_samples = 0;
  int64_t shared_samples = 0;
};

/// Chart and area; the array is reused.
using ChartAreas = std::vector<std::pair<int32_t, double>>;

/// The chart that covers most of a texel; on a tie, the lower number.
int32_t find_owner(const TexelTableBuilder& builder, const Fragment* begin, const Fragment* end,
                   ChartAreas& areas) {
  int32_t owner = builder.chart_of(begin->triangle);
  const bool one_chart = std::all_of(
      begin, end, [&](const Fragment& f) { return builder.chart_of(f.triangle) == owner; });
  if (one_chart) return owner;
  areas.clear();
  for (const Fragment* f = begin; f != end; ++f) {
    areas.push_back({builder.chart_of(f->triangle), f->area});
  }
  std::stable_sort(areas.begin(), areas.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  double most = -1.0;
  for (size_t i = 0; i < areas.size();) {
    const int32_t chart = areas[i].first;
    double area = 0.0;
    for (; i < areas.size() && areas[i].first == chart; ++i) {
      area += areas[i].second;
    }
    if (area > most) {
      most = area;
      owner = chart;
    }
  }
  return owner;
}

/// Computes the texels of bands, one after the other.
class BandCutter {
 public:
  explicit BandCutter(const TexelTableBuilder& builder)
      : builder_(builder), sampler_(builder.topology) {}

  /// `triangles` touch the rows [row_begin, row_end), ascending.
  BandTexels cut(std::span<const int32_t> triangles, int32_t row_begin, int32_t row_end) {
    const int32_t resolution = builder_.topology.resolution;
    BandTexels band;
    cuts_.clear();
    for (const int32_t t : triangles) {
      band.triangle_area.push_back(cut_triangle(texel_triangle(builder_.topology, t), t, resolution,
                                                row_begin, row_end, cuts_));
    }
    first_texel_ = row_begin * resolution;
    const int32_t texel_count = (row_end - row_begin) * resolution;
    const size_t most = note_whole(texel_count) + cuts_.parts.size();
    sort_parts(texel_count);
    band.texels.reserve(most);
    band.fragments.reserve(most);
    for (int32_t i = 0, row = row_begin; row < row_end; ++row) {
      for (int32_t column = 0; column < resolution; ++column, ++i) {
        const int32_t triangle = whole_[i];
        if (part_begin_[i] < part_begin_[i + 1]) {
          add_parts(i, band);
        } else if (triangle >= 0) {
          const TexelSample sample = sampler_.whole(triangle, glm::dvec2(column + 0.5, row + 0.5));
          band.fragments.push_back({triangle, 1.0f, sample.barycentric});
          add_texel(i, builder_.chart_of(triangle), sample, band);
          band.covered_samples += 64;
        }
      }
    }
    return band;
  }

 private:
  /// Fills `whole_` and returns the number of whole texels; if several triangles cover one wholly,
  /// all but the first become parts.
  size_t note_whole(int32_t texel_count) {
    whole_.assign(static_cast<size_t>(texel_count), -1);
    size_t count = 0;
    for (const WholeRun& run : cuts_.whole) {
      for (int32_t texel = run.first_texel; texel < run.first_texel + run.count; ++texel) {
        int32_t& holder = whole_[texel - first_texel_];
        if (holder < 0) {
          holder = run.triangle;
          ++count;
        } else {
          cuts_.parts.push_back(whole_fragment(texel, run.triangle, builder_.topology.resolution));
        }
      }
    }
    return count;
  }

  void sort_parts(int32_t texel_count) {
    const auto for_parts = [&](const auto& visit) {
      for (const Fragment& f : cuts_.parts) visit(f.texel - first_texel_, f);
    };
    base::group_by_key(static_cast<size_t>(texel_count), for_parts, part_begin_, parts_);
  }

  /// Adds texel i of the band, whose fragments are the last so far.
  void add_texel(int32_t i, int32_t chart, const TexelSample& sample, BandTexels& band) const {
    BandTexel& texel = band.texels.emplace_back();
    texel.texel = first_texel_ + i;
    texel.chart = chart;
    texel.sample = sample;
    texel.fragment_end = static_cast<int32_t>(band.fragments.size());
  }

  /// Adds texel i of the band, which is only partly covered by at least one triangle.
  void add_parts(int32_t i, BandTexels& band) {
    texel_.assign(parts_.begin() + part_begin_[i], parts_.begin() + part_begin_[i + 1]);
    if (whole_[i] >= 0) {
      texel_.push_back(whole_fragment(first_texel_ + i, whole_[i], builder_.topology.resolution));
      std::sort(texel_.begin(), texel_.end(),
                [](const Fragment& a, const Fragment& b) { return a.triangle < b.triangle; });
    }
    uint64_t once = 0;
    uint64_t twice = 0;
    for (const Fragment& f : texel_) {
      twice |= once & f.samples;
      once |= f.samples;
    }
    band.covered_samples += std::popcount(once);
    band.shared_samples += std::popcount(twice);
    const int32_t owner =
        find_owner(builder_, texel_.data(), texel_.data() + texel_.size(), chart_areas_);
    auto own_end = texel_.begin();
    for (const Fragment& f : texel_) {
      if (builder_.chart_of(f.triangle) == owner) {
        *own_end++ = f;
      } else {
        band.displaced.push_back(f);
      }
    }
    texel_.erase(own_end, texel_.end());
    for (const Fragment& f : texel_) {
      band.fragments.push_back({f.triangle, static_cast<float>(f.area), sampler_.centroid(f)});
    }
    add_texel(i, owner, sampler_.of(texel_), band);
  }

  const TexelTableBuilder& builder_;
  TexelSampler sampler_;
  int32_t first_texel_ = 0;
  TriangleCuts cuts_;
  /// Per texel of the band: the first triangle that covers it wholly; -1: none.
  std::vector<int32_t> whole_;
  /// Parts of texel i of the band: [part_begin_[i], part_begin_[i + 1]).
  std::vector<int32_t> part_begin_;
  std::vector<Fragment> parts_;
  std::vector<Fragment> texel_;
  ChartAreas chart_areas_;
};

/// Concatenates the bands' texels into the table.
void join_bands(const std::vector<BandTexels>& bands, int32_t threads, TexelTable& table) {
  std::vector<size_t> first_texel{0};
  std::vector<size_t> first_fragment{0};
  for (const BandTexels& band : bands) {
    first_texel.push_back(first_texel.back() + band.texels.size());
    first_fragment.push_back(first_fragment.back() + band.fragments.size());
  }
  const size_t texels = first_texel.back();
  const size_t fragments = first_fragment.back();
  // In parallel: most of the time goes to new memory from the operating system.
  const std::array<std::function<void()>, 9> arrays{
      [&] { table.texel.resize(texels); },
      [&] { table.triangle.resize(texels); },
      [&] { table.barycentric.resize(texels); },
      [&] { table.chart.resize(texels); },
      [&] { table.coverage.resize(texels); },
      [&] { table.fragment_begin.resize(texels + 1); },
      [&] { table.fragment_triangle.resize(fragments); },
      [&] { table.fragment_share.resize(fragments); },
      [&] { table.fragment_barycentric.resize(fragments); }};
  base::parallel_for(threads, [&](size_t part, size_t parts) {
    for (size_t array = part; array < arrays.size(); array += parts) arrays[array]();
  });
  base::parallel_for(threads, [&](size_t part, size_t parts) {
    for (size_t b = part; b < bands.size(); b += parts) {
      size_t i = first_texel[b];
      for (const BandTexel& own : bands[b].texels) {
        table.texel[i] = own.texel;
        table.triangle[i] = own.sample.triangle;
        table.barycentric[i] = own.sample.barycentric;
        table.chart[i] = own.chart;
        table.coverage[i] = own.sample.coverage;
        ++i;
        table.fragment_begin[i] = static_cast<int32_t>(first_fragment[b]) + own.fragment_end;
      }
      size_t f = first_fragment[b];
      for (const BandFragment& own : bands[b].fragments) {
        table.fragment_triangle[f] = own.triangle;
        table.fragment_share[f] = own.area;
        table.fragment_barycentric[f] = own.barycentric;
        ++f;
      }
    }
  });
}

}  // namespace

void cut_map(TexelTableBuilder& builder, int32_t threads) {
  const auto triangle_count = static_cast<int32_t>(builder.topology.triangles.size() / 3);
  const int32_t resolution = builder.topology.resolution;
  std::vector<std::array<int32_t, 2>> row_ranges(static_cast<size_t>(triangle_count));
  for (int32_t t = 0; t < triangle_count; ++t) {
    const UvTriangle uv = texel_triangle(builder.topology, t);
    if (is_degenerate(uv)) {
      ++builder.table.degenerate_triangles;
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
  const auto band_count = static_cast<int32_t>(bands.begin.size()) - 1;
  const auto triangles_of = [&](int32_t band) {
    return std::span(bands.items)
        .subspan(static_cast<size_t>(bands.begin[band]),
                 static_cast<size_t>(bands.begin[band + 1] - bands.begin[band]));
  };

  std::vector<BandTexels> done(static_cast<size_t>(band_count));
  std::atomic<int32_t> next{0};
  threads = std::min(threads, band_count);
  base::parallel_for(threads, [&](size_t, size_t) {
    BandCutter cutter(builder);
    for (int32_t band = next++; band < band_count; band = next++) {
      const int32_t row = band * bands.rows_per_band;
      done[band] =
          cutter.cut(triangles_of(band), row, std::min(resolution, row + bands.rows_per_band));
    }
  });

  join_bands(done, threads, builder.table);
  for (const int32_t chart : builder.table.chart) ++builder.own_texels[chart];
  builder.triangle_area.assign(static_cast<size_t>(triangle_count), 0.0);
  int64_t covered_samples = 0;
  int64_t shared_samples = 0;
  for (int32_t band = 0; band < band_count; ++band) {
    const BandTexels& own = done[band];
    const auto triangles = triangles_of(band);
    for (size_t t = 0; t < triangles.size(); ++t) {
      builder.triangle_area[triangles[t]] += own.triangle_area[t];
    }
    builder.displaced.insert(builder.displaced.end(), own.displaced.begin(), own.displaced.end());
    covered_samples += own.covered_samples;
    shared_samples += own.shared_samples;
  }
  builder.table.overlap = covered_samples == 0
                              ? 0.0f
                              : static_cast<float>(static_cast<double>(shared_samples) /
                                                   static_cast<double>(covered_samples));
}

}  // namespace snowbough::snow
