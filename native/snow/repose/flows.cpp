// The links of a block, and a round of snow along them.
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/simd.h"
#include "shaders/lib/texel_repose.h"
#include "snow/repose/repose.h"

#if defined(__GNUC__)
#define SNOWBOUGH_ROW SNOWBOUGH_WIDE __attribute__((flatten))
#else
#define SNOWBOUGH_ROW SNOWBOUGH_WIDE
#endif

namespace snowbough::snow {
namespace {

constexpr float kNoLink = std::numeric_limits<float>::infinity();

/// The flows of a row of cells to their neighbours, `step` cells away; returns the largest.
SNOWBOUGH_ROW float flow_row(int32_t cells, ptrdiff_t step, const float* __restrict top,
                             const float* __restrict gives, const float* __restrict limit,
                             const float* __restrict rate, float* __restrict flow,
                             float momentum) {
  float largest = 0.0f;
  for (int32_t i = 0; i < cells; ++i) {
    const float next = shared::link_flow(flow[i], top[i] - top[i + step], limit[i], rate[i],
                                         gives[i], gives[i + step], momentum);
    flow[i] = next;
    largest = std::max(largest, std::abs(next));
  }
  return largest;
}

/// Adds what a row's cells get: less of what they give, more of what `step` cells before them give.
SNOWBOUGH_ROW void gather_row(int32_t cells, ptrdiff_t step, const float* __restrict flow,
                              float* __restrict gain) {
  for (int32_t i = 0; i < cells; ++i) gain[i] += flow[i - step] - flow[i];
}

/// Adds the gains to what has come, and lifts the tops; returns the largest change.
SNOWBOUGH_ROW float move_row(int32_t cells, const float* __restrict gain,
                             double* __restrict moved, const float* __restrict held,
                             const float* __restrict z, const float* __restrict lift,
                             const float* __restrict share, float* __restrict top,
                             float* __restrict gives) {
  float largest = 0.0f;
  for (int32_t i = 0; i < cells; ++i) {
    moved[i] += static_cast<double>(gain[i]);
    const float now = held[i] + static_cast<float>(moved[i]);
    top[i] = z[i] + lift[i] * now;
    gives[i] = std::max(share[i] * now, 0.0f);
    largest = std::max(largest, std::abs(gain[i]));
  }
  return largest;
}

}  // namespace

Repose::Cells Repose::cells_of(int32_t block, const ReposeField& field) const {
  const int32_t column = block % links_.blocks_a_side * kReposeBlock;
  const int32_t row = block / links_.blocks_a_side * kReposeBlock;
  return {field.cell(column, row), std::min(kReposeBlock, links_.resolution - column),
          std::min(kReposeBlock, links_.resolution - row)};
}

void Repose::raise_tops(int32_t block, ReposeField& field) const {
  const Cells cells = cells_of(block, field);
  const float none[kReposeBlock] = {};
  for (int32_t row = 0; row < cells.rows; ++row) {
    const size_t at = cells.begin + static_cast<size_t>(row) * field.stride;
    move_row(cells.columns, none, field.moved.get() + at, field.held.get() + at,
             field.z.get() + at, field.lift.get() + at, field.share.get() + at,
             field.top.get() + at, field.gives.get() + at);
  }
}

/// Sets up the link from cell a to cell b and says whether snow starts to flow there.
bool Repose::set_up_link(const ReposeField& field, size_t a, size_t b, float& limit, float& rate,
                         BlockSlack& slack) const {
  limit = kNoLink;
  if (field.area[a] <= 0.0f || field.area[b] <= 0.0f) return false;
  const bool a_falls = (field.kind[a] & kWall) != 0;
  const bool b_falls = (field.kind[b] & kWall) != 0;
  const float bare = field.z[a] - field.z[b];
  // Nothing moves on walls, and what lies at the foot of one leans against it.
  if ((a_falls && b_falls) || (a_falls && bare >= 0.0f) || (b_falls && bare <= 0.0f)) return false;
  const auto depth = [&](size_t cell) {
    return (field.kind[cell] & kWall) != 0
               ? 0.0f
               : field.held[cell] * (surface_.unit() / field.area[cell]);
  };
  const float depth_a = depth(a);
  const float depth_b = depth(b);
  const float way_x = field.x[b] - field.x[a];
  const float way_y = field.y[b] - field.y[a];
  limit = shared::link_limit(
      way_x, way_y, way_x + depth_b * field.normal_x[b] - depth_a * field.normal_x[a],
      way_y + depth_b * field.normal_y[b] - depth_a * field.normal_y[a], slope_);
  rate = shared::link_rate(field.stiffness[a], field.stiffness[b]);
  const float bare_slack =
      slope_ * std::sqrt(way_x * way_x + way_y * way_y) - std::abs(bare);
  if (a_falls || b_falls) {
    slack.at_edges = std::min(slack.at_edges, bare_slack);
  } else {
    slack.inside = std::min(slack.inside, bare_slack);
    const float turn_x = field.normal_x[b] - field.normal_x[a];
    const float turn_y = field.normal_y[b] - field.normal_y[a];
    const float turn_z = field.normal_z[b] - field.normal_z[a];
    slack.turn =
        std::max(slack.turn, std::sqrt(turn_x * turn_x + turn_y * turn_y + turn_z * turn_z));
  }
  return shared::link_flow(0.0f, field.top[a] - field.top[b], limit, rate, field.gives[a],
                           field.gives[b], 0.0f) != 0.0f;
}

bool Repose::set_up_ends(int32_t block, const ReposeField& field, BlockSlack& slack) {
  bool starts = false;
  const int32_t* ends = &links_.end_begin[static_cast<size_t>(block)];
  const auto cell_of = [&](int32_t texel) {
    return field.cell_of(object_->table.texel[static_cast<size_t>(texel)]);
  };
  for (int32_t e = ends[0]; e < ends[1]; ++e) {
    const ReposeLinks::End& end = links_.ends[static_cast<size_t>(e)];
    if (end.sign > 0) continue;
    const auto link = static_cast<size_t>(end.link);
    const size_t a = cell_of(end.texel);
    if (link < links_.across.size()) {
      starts |= set_up_link(field, a, cell_of(links_.across[link].b), end_limit_[link],
                            end_rate_[link], slack);
      continue;
    }
    // Into the air: the rim itself is the lower point, and bare.
    const ReposeLinks::Rim& rim = links_.rims[link - links_.across.size()];
    end_limit_[link] = kNoLink;
    if (field.area[a] <= 0.0f || (field.kind[a] & kWall) != 0) continue;
    const glm::vec3 at = surface_.point(rim.triangle, rim.weights);
    const float depth = field.held[a] * (surface_.unit() / field.area[a]);
    const float way_x = at.x - field.x[a];
    const float way_y = at.y - field.y[a];
    end_limit_[link] = shared::link_limit(way_x, way_y, way_x - depth * field.normal_x[a],
                                          way_y - depth * field.normal_y[a], slope_);
    end_rate_[link] = shared::link_rate(field.stiffness[a], 0.0f);
    slack.at_edges =
        std::min(slack.at_edges, slope_ * std::sqrt(way_x * way_x + way_y * way_y) -
                                     std::abs(field.z[a] - at.z));
    starts |= field.top[a] - at.z > end_limit_[link] && field.gives[a] >= 1.0f;
  }
  return starts;
}

bool Repose::set_up_block(int32_t block, ReposeField& field) {
  const Cells cells = cells_of(block, field);
  for (int32_t k = 0; k < kForwardLinks; ++k) {
    for (int32_t row = 0; row < cells.rows; ++row) {
      float* limits = field.limit[k].get() + cells.begin + static_cast<size_t>(row) * field.stride;
      std::fill_n(limits, cells.columns, kNoLink);
    }
  }
  bool starts = false;
  BlockSlack slack{false, kNoLink, kNoLink, 0.0f};
  const int32_t left = block % links_.blocks_a_side;
  const int32_t first_row = block / links_.blocks_a_side * kReposeBlock;
  for (int32_t row = first_row; row < first_row + cells.rows; ++row) {
    const int32_t* run = &links_.run_begin[static_cast<size_t>(row * links_.blocks_a_side + left)];
    for (int32_t i = run[0]; i < run[1]; ++i) {
      const size_t a = field.cell_of(object_->table.texel[static_cast<size_t>(i)]);
      for (int32_t k = 0; k < kForwardLinks; ++k) {
        if (((links_.forward[static_cast<size_t>(i)] >> k) & 1) == 0) continue;
        const size_t b = a + static_cast<size_t>(field.step(k));
        starts |= set_up_link(field, a, b, field.limit[k][a], field.rate[k][a], slack);
      }
    }
  }
  starts |= set_up_ends(block, field, slack);
  slack_[static_cast<size_t>(block)] = slack;
  return starts;
}

bool Repose::flow_block(int32_t block, float momentum, ReposeField& field) {
  const Cells cells = cells_of(block, field);
  float largest = 0.0f;
  for (int32_t row = 0; row < cells.rows; ++row) {
    const size_t at = cells.begin + static_cast<size_t>(row) * field.stride;
    for (int32_t k = 0; k < kForwardLinks; ++k) {
      largest = std::max(
          largest, flow_row(cells.columns, field.step(k), field.top.get() + at,
                            field.gives.get() + at, field.limit[k].get() + at,
                            field.rate[k].get() + at, field.flow[k].get() + at, momentum));
    }
  }
  const int32_t* ends = &links_.end_begin[static_cast<size_t>(block)];
  const size_t across = links_.across.size();
  for (int32_t e = ends[0]; e < ends[1]; ++e) {
    const ReposeLinks::End& end = links_.ends[static_cast<size_t>(e)];
    if (end.sign > 0) continue;
    const auto link = static_cast<size_t>(end.link);
    const size_t a = field.cell_of(object_->table.texel[static_cast<size_t>(end.texel)]);
    float other_top = 0.0f;
    float other_gives = 0.0f;
    if (link < across) {
      const auto texel = static_cast<size_t>(links_.across[link].b);
      const size_t b = field.cell_of(object_->table.texel[texel]);
      other_top = field.top[b];
      other_gives = field.gives[b];
    } else {
      other_top = rim_top_[link - across];
    }
    end_flow_[link] =
        shared::link_flow(end_flow_[link], field.top[a] - other_top, end_limit_[link],
                          end_rate_[link], field.gives[a], other_gives, momentum);
    largest = std::max(largest, std::abs(end_flow_[link]));
  }
  return largest > 0.0f;
}

bool Repose::move_block(int32_t block, ReposeField& field) const {
  const Cells cells = cells_of(block, field);
  float gain[kReposeBlock][kReposeBlock] = {};
  for (int32_t row = 0; row < cells.rows; ++row) {
    const size_t at = cells.begin + static_cast<size_t>(row) * field.stride;
    for (int32_t k = 0; k < kForwardLinks; ++k) {
      gather_row(cells.columns, field.step(k), field.flow[k].get() + at, gain[row]);
    }
  }
  const int32_t* ends = &links_.end_begin[static_cast<size_t>(block)];
  for (int32_t e = ends[0]; e < ends[1]; ++e) {
    const ReposeLinks::End& end = links_.ends[static_cast<size_t>(e)];
    const int32_t place = object_->table.texel[static_cast<size_t>(end.texel)];
    gain[place / links_.resolution % kReposeBlock][place % links_.resolution % kReposeBlock] +=
        static_cast<float>(end.sign) * end_flow_[static_cast<size_t>(end.link)];
  }
  float largest = 0.0f;
  for (int32_t row = 0; row < cells.rows; ++row) {
    const size_t at = cells.begin + static_cast<size_t>(row) * field.stride;
    largest = std::max(
        largest, move_row(cells.columns, gain[row], field.moved.get() + at, field.held.get() + at,
                          field.z.get() + at, field.lift.get() + at, field.share.get() + at,
                          field.top.get() + at, field.gives.get() + at));
  }
  return largest > 0.0f;
}

/// Returns the units that left the surface: they fell over rims or onto walls.
double Repose::write_block(int32_t block, std::vector<float>& height,
                           const ReposeField& field) const {
  double lost = 0.0;
  const int32_t left = block % links_.blocks_a_side;
  const int32_t first_row = block / links_.blocks_a_side * kReposeBlock;
  for (int32_t row = first_row; row < std::min(first_row + kReposeBlock, links_.resolution);
       ++row) {
    const int32_t* run = &links_.run_begin[static_cast<size_t>(row * links_.blocks_a_side + left)];
    for (int32_t i = run[0]; i < run[1]; ++i) {
      const int32_t place = object_->table.texel[static_cast<size_t>(i)];
      const size_t cell = field.cell_of(place);
      const double moved = field.moved[cell];
      if (moved == 0.0 || (field.kind[cell] & kWall) != 0) continue;
      float& own = height[static_cast<size_t>(place)];
      const double depth =
          static_cast<double>(std::abs(own)) +
          moved * (static_cast<double>(surface_.unit()) / static_cast<double>(field.area[cell]));
      const auto now = static_cast<float>(std::max(depth, 0.0));
      own = (field.kind[cell] & kBack) != 0 ? -now : now;
      lost -= moved;
    }
  }
  return lost;
}

void Repose::clear_block(int32_t block, ReposeField& field) const {
  const Cells cells = cells_of(block, field);
  for (int32_t row = 0; row < cells.rows; ++row) {
    const size_t at = cells.begin + static_cast<size_t>(row) * field.stride;
    std::fill_n(field.area.get() + at, cells.columns, 0.0f);
    for (int32_t k = 0; k < kForwardLinks; ++k) {
      std::fill_n(field.flow[k].get() + at, cells.columns, 0.0f);
    }
  }
}

}  // namespace snowbough::snow
