#include "snow/repose/slack.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <limits>
#include <optional>

#include "base/simd.h"
#include "shaders/lib/texel_repose.h"
#include "snow/repose/window.h"

namespace snowbough::snow {
namespace {

constexpr float kNoLink = std::numeric_limits<float>::infinity();

/// A texel's bare surface.
struct Bare {
  glm::vec3 point{0.0f};
  float steep = 0.0f;
  float curvature = 0.0f;
  float column = 0.0f;
  /// 1: has a surface; 0: none.
  float there = 0.0f;
  /// 1: a wall; 0: none.
  float wall = 0.0f;
  float side = 1.0f;

  explicit Bare(const ReposeSurface::Texel& texel)
      : point(texel.point),
        steep(shared::bare_slope(texel.up)),
        curvature(texel.curvature),
        column(shared::column_height(std::abs(texel.normal.z))),
        there(texel.area > 0.0f ? 1.0f : 0.0f),
        side(shared::snow_side(0.0f, texel.up, texel.two_sided)) {
    wall = shared::is_wall(side * texel.up) ? 1.0f : 0.0f;
  }
};

/// The cells of a window; see Bare. `unfit`: 1 for a wall, or snow on the other side.
struct alignas(64) BarePlanes {
  TileWindow::Plane x{}, y{}, z{}, steep{}, curvature{}, column{}, there{}, unfit{};

  void set(size_t at, const Bare& bare, float own_side) {
    x[at] = bare.point.x;
    y[at] = bare.point.y;
    z[at] = bare.point.z;
    steep[at] = bare.steep;
    curvature[at] = bare.curvature;
    column[at] = bare.column;
    there[at] = bare.there;
    unfit[at] = bare.side == own_side ? bare.wall : 1.0f;
  }
};

/// Extremes over the columns of a block's links.
struct Extremes {
  std::array<float, kReposeBlock> inside, column, turn, unfit;

  Extremes() {
    inside.fill(kNoLink);
    column.fill(0.0f);
    turn.fill(0.0f);
    unfit.fill(0.0f);
  }
};

/// Adds the links from a row of cells to those `step` cells away, if `linked` is 1, else 0. Calls
/// limit(i, j, way, fall) for the limit of a link.
template <typename Limit>
[[gnu::always_inline]] inline void add_links(const BarePlanes& bare, size_t at, int32_t step,
                                             const float* __restrict linked, Extremes& extremes,
                                             const Limit& limit) {
  const float* const x = bare.x.data() + at;
  const float* const y = bare.y.data() + at;
  const float* const z = bare.z.data() + at;
  const float* const column = bare.column.data() + at;
  const float* const there = bare.there.data() + at;
  const float* const unfit = bare.unfit.data() + at;
  float* __restrict const inside = extremes.inside.data();
  float* __restrict const highest = extremes.column.data();
  float* __restrict const turn = extremes.turn.data();
  float* __restrict const any_unfit = extremes.unfit.data();
  for (int32_t i = 0; i < kReposeBlock; ++i) {
    const int32_t j = i + step;
    const float way_x = x[j] - x[i];
    const float way_y = y[j] - y[i];
    const float falls = z[i] - z[j];
    const float way = std::sqrt(way_x * way_x + way_y * way_y);
    const float margin = limit(i, j, way, falls) - std::abs(falls);
    const float open = std::min(std::min(there[i], there[j]), linked[i]);
    const float own = open > 0.0f ? margin : kNoLink;
    inside[i] = own < inside[i] ? own : inside[i];
    highest[i] = std::max(highest[i], open * std::max(column[i], column[j]));
    turn[i] = std::max(turn[i], open * std::abs(column[i] - column[j]));
    any_unfit[i] = std::max(any_unfit[i], open * std::max(unfit[i], unfit[j]));
  }
}

SNOWBOUGH_WIDE void add_row(const BarePlanes& bare, size_t at, int32_t step,
                            const float* __restrict linked, const ReposeLimits& limits,
                            Extremes& extremes) {
  const float* const steep = bare.steep.data() + at;
  const float* const curvature = bare.curvature.data() + at;
  const float slope_at_rest = limits.slope;
  const float cohesion = limits.cohesion;
  add_links(bare, at, step, linked, extremes, [=](int32_t i, int32_t j, float way, float falls) {
    const float slope =
        shared::held_slope(slope_at_rest, cohesion, 0.5f * (curvature[i] + curvature[j]));
    return shared::link_limit(way, slope, falls, 0.5f * (steep[i] + steep[j]), shared::kLeadsDown);
  });
}

/// The same without cohesion, where the bare surface is nowhere steeper than kEven of the limit: no
/// link is limited to its share of the slope straight down. It divides nothing.
SNOWBOUGH_WIDE void add_gentle_row(const BarePlanes& bare, size_t at, int32_t step,
                                   const float* __restrict linked, const ReposeLimits& limits,
                                   Extremes& extremes) {
  const float even = shared::kEven * limits.slope;
  add_links(bare, at, step, linked, extremes,
            [=](int32_t, int32_t, float way, float) { return even * way; });
}

/// Finds the slack of a block.
class SlackFinder {
 public:
  SlackFinder(const ReposeSurface& surface, const ReposeLinks& links,
              const std::vector<int32_t>& places, int32_t block, const ReposeLimits& limits)
      : surface_(surface), links_(links), places_(places), block_(block), limits_(limits) {}

  BlockSlack find() {
    if (!load_block()) return {};
    load_beside();
    slack_.inside = slack_.at_edges = kNoLink;
    if (!add_links() || !add_ends()) return {};
    return slack_;
  }

 private:
  /// Returns whether snow can rest on all texels of the block.
  bool load_block() {
    bool is_first = true;
    bool rests = true;
    links_.for_texels(block_, places_, [&](int32_t texel, size_t cell) {
      if (!rests) return;
      const Bare bare(surface_.texel(texel));
      if (is_first) slack_.side = bare.side;
      is_first = false;
      const float steepest = shared::held_slope(limits_.slope, limits_.cohesion, bare.curvature);
      rests = bare.there == 0.0f ||
              (bare.wall == 0.0f && bare.side == slack_.side && bare.steep <= steepest);
      set(place_of(cell), bare);
    });
    return rests;
  }

  void set(size_t at, const Bare& bare) {
    planes_.set(at, bare, slack_.side);
    steepest_ = std::max(steepest_, bare.steep);
  }

  static size_t place_of(size_t cell) {
    const auto number = static_cast<int32_t>(cell);
    return TileWindow::at(number % kReposeBlock, number / kReposeBlock);
  }

  /// Loads the window's cells beside the block that have a texel.
  void load_beside() {
    const int32_t size = links_.resolution;
    const int32_t left = block_ % links_.blocks_a_side * kReposeBlock;
    const int32_t first = block_ / links_.blocks_a_side * kReposeBlock;
    const int32_t rows = std::min(TileWindow::kRows, size - first);
    for (int32_t row = 0; row < rows; ++row) {
      const int32_t begin = (first + row) * size;
      const int32_t* const run =
          &links_.run_begin[static_cast<size_t>(first + row) * links_.blocks_a_side +
                            block_ % links_.blocks_a_side];
      const auto load = [&](int32_t texel) {
        if (texel < 0 || texel >= static_cast<int32_t>(places_.size())) return;
        const int32_t column = places_[static_cast<size_t>(texel)] - begin;
        if (column < std::max(left - 1, 0) || column > std::min(left + kReposeBlock, size - 1)) {
          return;
        }
        set(TileWindow::at(column - left, row), Bare(surface_.texel(texel)));
      };
      load(run[0] - 1);
      load(run[1]);
      for (int32_t texel = run[0]; row == kReposeBlock && texel < run[1]; ++texel) load(texel);
    }
  }

  /// Returns whether all links are between texels on which snow can rest.
  bool add_links() {
    std::array<TileWindow::Plane, kForwardLinks> linked{};
    links_.for_texels(block_, places_, [&](int32_t texel, size_t cell) {
      const uint8_t forward = links_.forward[static_cast<size_t>(texel)];
      for (size_t k = 0; k < kForwardLinks; ++k) {
        linked[k][place_of(cell)] = static_cast<float>((forward >> k) & 1);
      }
    });
    Extremes extremes;
    const bool is_gentle = limits_.cohesion == 0.0f && steepest_ <= shared::kEven * limits_.slope;
    const auto add = is_gentle ? add_gentle_row : add_row;
    for (int32_t row = 0; row < kReposeBlock; ++row) {
      const size_t at = TileWindow::at(0, row);
      for (int32_t k = 0; k < kForwardLinks; ++k) {
        add(planes_, at, TileWindow::step(k), &linked[static_cast<size_t>(k)][at], limits_,
            extremes);
      }
    }
    slack_.inside = *std::min_element(extremes.inside.begin(), extremes.inside.end());
    slack_.column = *std::max_element(extremes.column.begin(), extremes.column.end());
    slack_.turn = *std::max_element(extremes.turn.begin(), extremes.turn.end());
    return *std::max_element(extremes.unfit.begin(), extremes.unfit.end()) == 0.0f;
  }

  /// The same for links across seams and over rims.
  bool add_ends() {
    const int32_t* ends = &links_.end_begin[static_cast<size_t>(block_)];
    for (int32_t e = ends[0]; e < ends[1]; ++e) {
      const ReposeLinks::End& end = links_.ends[static_cast<size_t>(e)];
      const Bare own(surface_.texel(end.texel));
      if (own.there == 0.0f) continue;
      const auto link = static_cast<size_t>(end.link);
      if (link >= links_.across.size()) {
        const glm::vec3 rim = surface_.point(links_.rims[link - links_.across.size()].point);
        slack_.at_edges = std::min(slack_.at_edges, margin(own, rim, own.curvature, own.steep));
        slack_.column = std::max(slack_.column, own.column);
        continue;
      }
      const auto [a, b] = links_.across[link].ends();
      const Bare other(surface_.texel(end.sign < 0 ? b : a));
      if (other.there == 0.0f) continue;
      if (other.wall != 0.0f || other.side != slack_.side) return false;
      if (end.sign > 0) continue;
      slack_.inside =
          std::min(slack_.inside, margin(own, other.point, 0.5f * (own.curvature + other.curvature),
                                         0.5f * (own.steep + other.steep)));
      slack_.column = std::max(slack_.column, std::max(own.column, other.column));
      slack_.turn = std::max(slack_.turn, std::abs(own.column - other.column));
    }
    return true;
  }

  float margin(const Bare& own, const glm::vec3& at, float curvature, float steep) const {
    const glm::vec3 way = at - own.point;
    const float slope = shared::held_slope(limits_.slope, limits_.cohesion, curvature);
    return shared::link_limit(std::sqrt(way.x * way.x + way.y * way.y), slope, way.z, steep,
                              shared::kAllLeadDown) -
           std::abs(way.z);
  }

  const ReposeSurface& surface_;
  const ReposeLinks& links_;
  const std::vector<int32_t>& places_;
  int32_t block_;
  const ReposeLimits& limits_;
  BlockSlack slack_;
  BarePlanes planes_;
  /// Of the cells in `planes_`.
  float steepest_ = 0.0f;
};

}  // namespace

BlockSlack find_slack(const ReposeSurface& surface, const ReposeLinks& links,
                      const std::vector<int32_t>& places, int32_t block,
                      const ReposeLimits& limits) {
  return SlackFinder(surface, links, places, block, limits).find();
}

}  // namespace snowbough::snow
