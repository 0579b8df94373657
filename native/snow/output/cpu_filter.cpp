#include "snow/output/cpu_filter.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "base/parallel_for.h"
#include "base/simd.h"
#include "snow/output/normals.h"

namespace snowbough::snow {
namespace {

inline float positive(float x) {
  return x > 0.0f ? x : 0.0f;
}

/// A tile's rows of texels, or less of them at the map's border: `pitch` from row to row.
struct TileRows {
  int32_t width;
  int32_t height;
  ptrdiff_t pitch;
};

/// Filters a tile whose first texel is at `from`, neighbours `stride` apart, but for the texels
/// whose scale is not below `end`: to go on in whole vectors costs less than to leave them out. The
/// weights follow from the scale of the two outer taps, each shared by the two texels beside it
/// (see smoothing.h). Returns 0 where all values in the tile are 0.
template <bool kAdd, int32_t kWidth>
[[gnu::always_inline]] inline uint32_t filter_rows(const float* __restrict from,
                                                   float* __restrict to,
                                                   const uint16_t* __restrict scale, int32_t end,
                                                   TileRows rows, ptrdiff_t stride) {
  constexpr auto kInnerOffset = static_cast<float>(kTapOffset[1]);
  constexpr auto kOuterOffset = static_cast<float>(kTapOffset[2]);
  constexpr auto kInnerWeight = static_cast<float>(kTapWeight[1] / kTapSum);
  constexpr auto kOuterWeight = static_cast<float>(kTapWeight[2] / kTapSum);
  const int32_t width = kWidth > 0 ? kWidth : rows.width;
  uint32_t bits = 0;
  for (int32_t row = 0; row < rows.height; ++row) {
    // The next tile's; a row of tiles is short for the processor to see by itself.
    __builtin_prefetch(scale + kTileWidth);
    for (const int32_t line : {0, kTileWidth / 2}) {
      __builtin_prefetch(from + kTileWidth + line + (stride == 1 ? 0 : kFilterReach * stride));
      __builtin_prefetch(to + kTileWidth + line, 1);
    }
    for (int32_t i = 0; i < width; ++i) {
      const float tap_scale = kFilterScaleStep * static_cast<float>(scale[i]);
      const float inner = kInnerOffset * tap_scale;
      const float outer = kOuterOffset * tap_scale;
      // A tap's part in a texel at distance d is what is left of 1 - |d - tap|; inner taps lie
      // between 0 and 1.4, outer ones between 0 and 3.3.
      const float w1 = kInnerWeight * (1.0f - std::fabs(1.0f - inner)) +
                       kOuterWeight * positive(1.0f - std::fabs(1.0f - outer));
      const float w2 = kInnerWeight * positive(inner - 1.0f) +
                       kOuterWeight * positive(1.0f - std::fabs(2.0f - outer));
      const float w3 = kOuterWeight * positive(1.0f - std::fabs(3.0f - outer));
      const float w4 = kOuterWeight * positive(outer - 3.0f);
      const float w0 = 1.0f - 2.0f * (w1 + w2 + w3 + w4);
      const float* at = from + i;
      const float sum =
          w0 * at[0] + w1 * (at[-stride] + at[stride]) + w2 * (at[-2 * stride] + at[2 * stride]) +
          w3 * (at[-3 * stride] + at[3 * stride]) + w4 * (at[-4 * stride] + at[4 * stride]);
      const float value = scale[i] >= end ? to[i] : kAdd ? 0.5f * (to[i] + sum) : sum;
      to[i] = value;
      bits |= std::bit_cast<uint32_t>(value);
    }
    from += rows.pitch;
    to += rows.pitch;
    scale += rows.pitch;
  }
  return bits;
}

template <bool kAdd>
[[gnu::always_inline]] inline uint32_t filter_any(const float* from, float* to,
                                                  const uint16_t* scale, int32_t end, TileRows rows,
                                                  ptrdiff_t stride) {
  return rows.width == kTileWidth
             ? filter_rows<kAdd, kTileWidth>(from, to, scale, end, rows, stride)
             : filter_rows<kAdd, 0>(from, to, scale, end, rows, stride);
}

SNOWBOUGH_WIDE uint32_t replace_tile(const float* from, float* to, const uint16_t* scale,
                                     int32_t end, TileRows rows, ptrdiff_t stride) {
  return filter_any<false>(from, to, scale, end, rows, stride);
}

SNOWBOUGH_WIDE uint32_t add_tile(const float* from, float* to, const uint16_t* scale, int32_t end,
                                 TileRows rows, ptrdiff_t stride) {
  return filter_any<true>(from, to, scale, end, rows, stride);
}

/// 0 where all values are 0.
SNOWBOUGH_WIDE uint32_t bits_of(const float* values, int32_t count) {
  uint32_t bits = 0;
  for (int32_t i = 0; i < count; ++i) bits |= std::bit_cast<uint32_t>(values[i]);
  return bits;
}

}  // namespace

CpuFilter::CpuFilter(const TexelTable& table, const SeamTable& seams, const SmoothingPlan& plan,
                     int32_t threads)
    : table_(table),
      seams_(seams),
      passes_(plan.passes),
      closing_passes_(plan.closing_passes),
      threads_(std::max(1, threads)),
      leveller_(closing_passes_ > 0 ? seams.levelling : SeamLevelling()),
      continuation_(table, seams),
      tiles_(table.resolution) {
  heights_.filled.assign(static_cast<size_t>(tiles_.count()), closing_passes_ == 0);
  if (closing_passes_ == 0) return;
  prepare(u_, seams.u, 1, plan.level_u);
  prepare(v_, seams.v, table.resolution, plan.level_v);
  const size_t ghosts = std::max(u_.ghosts.size(), v_.ghosts.size());
  for (Heights* heights : {&heights_, &next_}) {
    heights->margin = ptrdiff_t{kFilterReach} * table.resolution;
    heights->values.assign(static_cast<size_t>(heights->margin + zero_place()) + 1 + ghosts, 0.0f);
    heights->filled.assign(static_cast<size_t>(tiles_.count()), 0);
  }
}

void CpuFilter::prepare(Axis& axis, const TexelLines& lines, int32_t stride,
                        const std::vector<uint8_t>& level) {
  const auto texels = static_cast<int32_t>(table_.resolution) * table_.resolution;
  axis.stride = stride;
  axis.scale.assign(static_cast<size_t>(texels), kIrregular);
  axis.has_regular.assign(static_cast<size_t>(tiles_.count()), 0);
  // Per place of the line array: where its value is found; a ghost by its number.
  std::vector<int32_t> found(static_cast<size_t>(lines.length), zero_place());
  for (size_t i = 0; i < table_.texel.size(); ++i) found[lines.place[i]] = table_.texel[i];
  for (size_t g = 0; g < lines.ghost_place.size(); ++g) {
    const bool is_there = lines.ghosts.begin[g] != lines.ghosts.begin[g + 1];
    if (is_there) found[lines.ghost_place[g]] = zero_place() + 1 + static_cast<int32_t>(g);
  }
  for (size_t i = 0; i < table_.texel.size(); ++i) {
    const int32_t texel = table_.texel[i];
    const int32_t place = lines.place[i];
    // Runs lie further apart than the filter reaches: texels at both ends of it are of this run.
    const bool regular =
        found[place - kFilterReach] < texels && found[place + kFilterReach] < texels;
    if (regular) {
      axis.scale[texel] = filter_scale(level[i]);
      axis.has_regular[tiles_.of(texel)] = 1;
      continue;
    }
    const FilterWeights& weights = filter_levels()[level[i]];
    IrregularTexel irregular{texel, level[i], weights[0], {}};
    for (int32_t k = 1; k <= kFilterReach; ++k) {
      for (const int32_t side : {-1, 1}) {
        const int32_t tap = found[place + side * k];
        irregular.taps[2 * (k - 1) + (side > 0)] = tap;
        irregular.present += tap == zero_place() ? 0.0f : weights[k];
      }
    }
    axis.irregular.push_back(irregular);
  }
  const auto tile_of_irregular = [&](const IrregularTexel& irregular) {
    return tiles_.of(irregular.texel);
  };
  axis.irregular =
      sorted_by_tile(axis.irregular, tiles_.count(), tile_of_irregular, axis.irregular_begin);
  add_ghosts(axis, lines);
}

/// Gives the ghosts that irregular texels look at their places, in the order in which they are
/// looked at, and notes which tiles each tile looks at.
void CpuFilter::add_ghosts(Axis& axis, const TexelLines& lines) {
  // Per ghost of the lines: the last tile that it was noted for, and its place.
  std::vector<int32_t> noted_ghost(lines.ghost_place.size(), -1);
  std::vector<int32_t> place(lines.ghost_place.size(), 0);
  std::vector<int32_t> looked_at;
  axis.reads = TileReads(tiles_.count());
  for (int32_t tile = 0; tile < tiles_.count(); ++tile) {
    axis.reads.begin_tile();
    axis.reads.note(tile);
    const int32_t step = axis.stride == 1 ? 1 : tiles_.columns;
    const int32_t along = axis.stride == 1 ? tile % tiles_.columns : tile / tiles_.columns;
    if (along > 0) axis.reads.note(tile - step);
    if (along + 1 < (axis.stride == 1 ? tiles_.columns : tiles_.rows)) axis.reads.note(tile + step);
    for (int32_t i = axis.irregular_begin[tile]; i < axis.irregular_begin[tile + 1]; ++i) {
      for (int32_t& tap : axis.irregular[i].taps) {
        if (tap <= zero_place()) continue;
        const int32_t ghost = tap - zero_place() - 1;
        if (place[ghost] == 0) {
          looked_at.push_back(ghost);
          place[ghost] = zero_place() + static_cast<int32_t>(looked_at.size());
        }
        tap = place[ghost];
        if (std::exchange(noted_ghost[ghost], tile) == tile) continue;
        for (int32_t t = lines.ghosts.begin[ghost]; t < lines.ghosts.begin[ghost + 1]; ++t) {
          axis.reads.note(tiles_.of(table_.texel[lines.ghosts.source[t]]));
        }
      }
    }
  }
  const auto tile_of_ghost = [&](int32_t ghost) {
    return tiles_.of(table_.texel[lines.ghosts.source[lines.ghosts.begin[ghost]]]);
  };
  looked_at = sorted_by_tile(looked_at, tiles_.count(), tile_of_ghost, axis.ghost_begin);
  axis.ghost_reads = TileReads(tiles_.count());
  for (int32_t tile = 0; tile < tiles_.count(); ++tile) {
    axis.ghost_reads.begin_tile();
    for (int32_t g = axis.ghost_begin[tile]; g < axis.ghost_begin[tile + 1]; ++g) {
      const int32_t ghost = looked_at[g];
      axis.ghost_place.push_back(place[ghost]);
      for (int32_t t = lines.ghosts.begin[ghost]; t < lines.ghosts.begin[ghost + 1]; ++t) {
        const int32_t source = table_.texel[lines.ghosts.source[t]];
        axis.ghosts.source.push_back(source);
        axis.ghosts.weight.push_back(lines.ghosts.weight[t]);
        axis.ghost_reads.note(tiles_.of(source));
      }
      axis.ghosts.begin.push_back(static_cast<int32_t>(axis.ghosts.source.size()));
    }
  }
}

void CpuFilter::clear_tile(Heights& heights, int32_t tile) const {
  if (heights.filled[tile] == 0) return;
  heights.filled[tile] = 0;
  tiles_.for_each_row(
      tile, [&](int32_t first, int32_t count) { std::fill_n(heights.map() + first, count, 0.0f); });
}

void CpuFilter::load(const std::vector<float>& stored) {
  for (int32_t tile = 0; tile < tiles_.count(); ++tile) {
    uint32_t bits = 0;
    tiles_.for_each_row(
        tile, [&](int32_t first, int32_t count) { bits |= bits_of(stored.data() + first, count); });
    if (bits == 0) {
      clear_tile(heights_, tile);
      continue;
    }
    heights_.filled[tile] = 1;
    tiles_.for_each_row(tile, [&](int32_t first, int32_t count) {
      std::copy_n(stored.begin() + first, count, heights_.map() + first);
    });
  }
}

void CpuFilter::store(std::vector<float>& map) {
  // Where nothing is after smoothing, nothing was before.
  for (int32_t tile = 0; tile < tiles_.count(); ++tile) {
    if (heights_.filled[tile] == 0) continue;
    tiles_.for_each_row(tile, [&](int32_t first, int32_t count) {
      std::copy_n(heights_.map() + first, count, map.begin() + first);
    });
  }
}

void CpuFilter::for_each_tile_row(const std::function<void(int32_t row)>& work) const {
  base::parallel_for(threads_, [&](size_t part, size_t parts) {
    const auto rows = static_cast<size_t>(tiles_.rows);
    for (size_t row = rows * part / parts; row < rows * (part + 1) / parts; ++row) {
      work(static_cast<int32_t>(row));
    }
  });
}

void CpuFilter::fill_ghosts(const Axis& axis, Heights& from, int32_t row) const {
  float* const source = from.map();
  for (int32_t tile = row * tiles_.columns; tile < (row + 1) * tiles_.columns; ++tile) {
    const bool is_bare = !axis.ghost_reads.sees(tile, from.filled);
    for (int32_t g = axis.ghost_begin[tile]; g < axis.ghost_begin[tile + 1]; ++g) {
      float sum = 0.0f;
      for (int32_t t = axis.ghosts.begin[g]; t < axis.ghosts.begin[g + 1] && !is_bare; ++t) {
        sum += axis.ghosts.weight[t] * source[axis.ghosts.source[t]];
      }
      source[axis.ghost_place[g]] = sum;
    }
  }
}

uint32_t CpuFilter::filter_irregular(const Axis& axis, const Heights& from, Heights& to, bool add,
                                     int32_t tile) const {
  const float* const source = from.map();
  uint32_t bits = 0;
  for (int32_t i = axis.irregular_begin[tile]; i < axis.irregular_begin[tile + 1]; ++i) {
    const IrregularTexel& irregular = axis.irregular[i];
    const FilterWeights& w = filter_levels()[irregular.level];
    float sum = w[0] * source[irregular.texel];
    for (int32_t k = 1; k <= kFilterReach; ++k) {
      sum += w[k] * source[irregular.taps[2 * k - 2]];
      sum += w[k] * source[irregular.taps[2 * k - 1]];
    }
    float& target = to.map()[irregular.texel];
    target = add ? 0.5f * (target + sum / irregular.present) : sum / irregular.present;
    bits |= std::bit_cast<uint32_t>(target);
  }
  return bits;
}

void CpuFilter::filter_tile_row(const Axis& axis, const Heights& from, Heights& to, bool add,
                                int32_t row) const {
  for (int32_t tile = row * tiles_.columns; tile < (row + 1) * tiles_.columns; ++tile) {
    if (to.filled[tile] == 0) continue;
    uint32_t bits = 0;
    if (axis.has_regular[tile] != 0) {
      const int32_t first = tiles_.first_texel(tile);
      const TileRows rows{tiles_.width(tile), tiles_.height(tile), table_.resolution};
      bits =
          (add ? add_tile : replace_tile)(from.map() + first, to.map() + first,
                                          axis.scale.data() + first, kIrregular, rows, axis.stride);
    }
    to.filled[tile] = (bits | filter_irregular(axis, from, to, add, tile)) != 0;
  }
}

void CpuFilter::filter(const Axis& axis, Heights& from, Heights& to, bool add) const {
  for (int32_t tile = 0; tile < tiles_.count(); ++tile) {
    if (axis.reads.sees(tile, from.filled)) {
      to.filled[tile] = 1;
    } else if (!add) {
      clear_tile(to, tile);
    }
  }
  for_each_tile_row([&](int32_t row) { fill_ghosts(axis, from, row); });
  for_each_tile_row([&](int32_t row) { filter_tile_row(axis, from, to, add, row); });
}

void CpuFilter::smooth(std::vector<float>& map) {
  const std::scoped_lock lock(filtering_);
  if (closing_passes_ > 0) {
    load(map);
    for (int32_t pass = 0; pass < passes_; ++pass) {
      filter(u_, heights_, next_, false);
      filter(v_, next_, heights_, false);
    }
    for (int32_t pass = 0; pass < closing_passes_; ++pass) {
      filter(u_, heights_, next_, false);
      filter(v_, heights_, next_, true);
      std::swap(heights_, next_);
    }
    store(map);
  }
  continuation_.run(map, heights_.filled);
}

MapOutput CpuFilter::run(std::vector<float> map, const std::vector<SurfaceMetric>& metrics) {
  smooth(map);
  if (closing_passes_ > 0) {
    const std::scoped_lock lock(levelling_);
    leveller_.run(map);
  }
  MapOutput output;
  if (!metrics.empty()) {
    output.normal = normal_map(table_, seams_, metrics, map);
  }
  output.height = std::move(map);
  return output;
}

}  // namespace snowbough::snow
