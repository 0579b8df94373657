#include "snow/movement/repose/slack.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/simd.h"
#include "shaders/lib/texel_repose.h"
#include "snow/movement/repose/granular.h"

namespace snowbough::snow {
namespace {

constexpr int32_t kWindowColumns = kReposeBlock + 2;

/// A texel at the end of a link across a seam or over an open edge.
struct Bare {
  glm::vec3 point{0.0f};
  float steep = 0.0f;
  float curvature = 0.0f;
  float column = 0.0f;
  bool is_there = false;
  bool is_wall = false;
  float side = 1.0f;

  explicit Bare(const ReposeSurface::Texel& texel)
      : point(texel.point),
        steep(shared::bare_slope(texel.up)),
        curvature(texel.curvature),
        column(shared::column_height(std::abs(texel.normal.z))),
        is_there(texel.area > 0.0f),
        side(shared::snow_side(0.0f, texel.up, texel.two_sided)) {
    is_wall = shared::is_wall(side * texel.up);
  }
};

/// Converts a row's upward parts of normals to slopes, and of shading normals to column heights:
/// infinite where no snow can rest on `side`. Returns whether snow rests on all of the block's own
/// cells.
SNOWBOUGH_WIDE bool finish_row(const float* __restrict area, const float* __restrict curvature,
                               const uint8_t* __restrict two_sided, float side,
                               const ReposeLimits& limits, float* __restrict steep,
                               float* __restrict column) {
  constexpr float kUnfit = std::numeric_limits<float>::infinity();
  const float slope = limits.slope;
  const float cohesion = limits.cohesion;
  std::array<float, kWindowColumns> both;
  std::array<int32_t, kWindowColumns> is_over;
  for (int32_t i = 0; i < kWindowColumns; ++i) both[i] = two_sided[i] != 0 ? 1.0f : 0.0f;
  for (int32_t i = 0; i < kWindowColumns; ++i) {
    const float up = steep[i];
    const float own_side = ((both[i] > 0.0f) & (up < 0.0f)) ? -1.0f : 1.0f;
    const bool is_unfit = shared::is_wall(own_side * up) | (own_side != side);
    steep[i] = shared::bare_slope(up);
    column[i] = is_unfit ? kUnfit : shared::column_height(std::abs(column[i]));
    const bool rests = !is_unfit & (steep[i] <= shared::held_slope(slope, cohesion, curvature[i]));
    is_over[i] = ((area[i] > 0.0f) & !rests) ? 1 : 0;
  }
  int32_t any = 0;
  for (int32_t i = 1; i <= kReposeBlock; ++i) any |= is_over[i];
  return any == 0;
}

/// Extremes over the columns of a block's links.
struct Extremes {
  std::array<float, kReposeBlock> inside, column, turn;

  Extremes() {
    inside.fill(kNoLink);
    column.fill(0.0f);
    turn.fill(0.0f);
  }
};

using Limits = std::array<std::array<float, kReposeBlock>, kForwardLinks>;

/// Adds the links from a row of cells to those `step` cells away.
inline void add_links(const float* z, const float* columns, int32_t step,
                      const float* __restrict limit, float* __restrict inside,
                      float* __restrict highest, float* __restrict turn) {
  for (int32_t i = 0; i < kReposeBlock; ++i) {
    const float own = limit[i];
    const float column = columns[i];
    const float other = columns[i + step];
    const float margin = own - std::abs(z[i] - z[i + step]);
    const float high = std::max(column, other);
    const float apart = std::abs(column - other);
    const bool is_there = own < kNoLink;
    inside[i] = std::min(inside[i], margin);
    highest[i] = std::max(highest[i], is_there ? high : 0.0f);
    turn[i] = std::max(turn[i], is_there ? apart : 0.0f);
  }
}

/// The same for all links of the cells; `z`, `columns`: of the first.
SNOWBOUGH_WIDE_FLAT void add_row(const float* z, const float* columns, const Limits& limits,
                                 Extremes& extremes) {
  for (int32_t k = 0; k < kForwardLinks; ++k) {
    add_links(z, columns, TileWindow::step(k), limits[static_cast<size_t>(k)].data(),
              extremes.inside.data(), extremes.column.data(), extremes.turn.data());
  }
}

/// Finds the slack of a block.
class SlackFinder {
 public:
  SlackFinder(const ReposeSurface& surface, const ReposeLinks& links,
              const std::vector<int32_t>& places, int32_t block, const ReposeLimits& limits)
      : surface_(surface), links_(links), places_(places), block_(block), limits_(limits) {
    if (limits.is_granular) limits_.slope *= kGranularSure / shared::kEven;
    bare_.wall.fill(0.0f);
  }

  BlockSlack find() {
    find_side();
    for (int32_t row = 0; row < TileWindow::kRows; ++row) {
      if (!load_row(row)) return {};
    }
    slack_.inside = slack_.at_edges = kNoLink;
    if (!add_links() || !add_ends()) return {};
    return slack_;
  }

 private:
  /// The side of the block's first texel.
  void find_side() {
    bool is_first = true;
    links_.for_runs(block_, places_, [&](int32_t texel, int32_t, size_t) {
      if (is_first) slack_.side = Bare(surface_.texel(texel)).side;
      is_first = false;
    });
  }

  /// Loads a row of the window; returns whether snow can rest on all texels of the block in it.
  bool load_row(int32_t row) {
    const size_t at = TileWindow::at(-1, row);
    std::array<uint8_t, kWindowColumns> two_sided{};
    float* const curvature = &bare_.curvature[at];
    float* const steep = &bare_.steep[at];
    float* const area = &bare_.area[at];
    float* const column = &column_[at];
    const ReposeSurface::Row all{&bare_.x[at], &bare_.y[at], &bare_.z[at], column,
                                 steep,        area,         curvature,    two_sided.data()};
    bool is_defined = false;
    const auto clear = [&] {
      for (float* const plane : {all.x, all.y, all.z, column, steep, area, curvature}) {
        std::fill_n(plane, kWindowColumns, 0.0f);
      }
      is_defined = true;
    };
    links_.for_row_runs(block_, row, 1, places_, [&](int32_t first, int32_t count, int32_t i) {
      if (count < kWindowColumns && !is_defined) clear();
      is_defined = true;
      surface_.texels(first, count, all.at(static_cast<size_t>(i + 1)));
    });
    if (!is_defined) clear();
    const bool rests =
        finish_row(area, curvature, two_sided.data(), slack_.side, limits_, steep, column);
    return rests || row == kReposeBlock;
  }

  /// Returns whether all links are between texels on which snow can rest.
  bool add_links() {
    Extremes extremes;
    for (int32_t row = 0; row < kReposeBlock; ++row) {
      const size_t at = TileWindow::at(0, row);
      Limits limit;
      const std::array<float*, kForwardLinks> rows = {limit[0].data(), limit[1].data(),
                                                      limit[2].data(), limit[3].data()};
      find_link_limits(bare_, row, links_.forward_of(block_) + row * kReposeBlock, limits_,
                       rows.data());
      add_row(&bare_.z[at], &column_[at], limit, extremes);
    }
    slack_.inside = *std::min_element(extremes.inside.begin(), extremes.inside.end());
    slack_.column = *std::max_element(extremes.column.begin(), extremes.column.end());
    slack_.turn = *std::max_element(extremes.turn.begin(), extremes.turn.end());
    return slack_.column < std::numeric_limits<float>::infinity();
  }

  /// The same for links across seams and over open edges.
  bool add_ends() {
    const int32_t* ends = &links_.end_begin[static_cast<size_t>(block_)];
    for (int32_t e = ends[0]; e < ends[1]; ++e) {
      const ReposeLinks::End& end = links_.ends[static_cast<size_t>(e)];
      const Bare own(surface_.texel(end.texel));
      if (!own.is_there) continue;
      const auto link = static_cast<size_t>(end.link);
      if (link >= links_.across.size()) {
        const glm::vec3 edge = surface_.point(links_.open_edges[link - links_.across.size()].point);
        slack_.at_edges = std::min(slack_.at_edges, margin(own, edge, own.curvature, own.steep));
        slack_.column = std::max(slack_.column, own.column);
        continue;
      }
      const auto [a, b] = links_.across[link].ends();
      const Bare other(surface_.texel(end.sign < 0 ? b : a));
      if (!other.is_there) continue;
      if (other.is_wall || other.side != slack_.side) return false;
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
  ReposeLimits limits_;
  BlockSlack slack_;
  /// Walls are left out: no snow can rest on them.
  BareWindow bare_;
  /// shared::column_height; infinite where no snow can rest.
  TileWindow::Plane column_;
};

}  // namespace

BlockSlack find_slack(const ReposeSurface& surface, const ReposeLinks& links,
                      const std::vector<int32_t>& places, int32_t block,
                      const ReposeLimits& limits) {
  return SlackFinder(surface, links, places, block, limits).find();
}

}  // namespace snowbough::snow
