// Repose: where snow that leaves the map leaves it.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "base/parallel_for.h"
#include "shaders/lib/texel_repose.h"
#include "snow/movement/repose/repose.h"

namespace snowbough::snow {
namespace {

constexpr int32_t kNoWay = std::numeric_limits<int32_t>::min();

}  // namespace

int32_t Repose::cell_of_wall(const RimLink& rim) const {
  return links_->cell_of(-1 - rim.number);
}

/// The next cell along the steepest link of the snow's surface; -1 - outlet, if it leads over one;
/// the cell itself in a hollow. Cells are numbered as by ReposeLinks::cell_of.
int32_t Repose::next_cell(int32_t cell) const {
  const int32_t block = cell / kTileCells;
  const int32_t inner = cell % kTileCells;
  const ReposeTile& tile = *tiles_[static_cast<size_t>(block)];
  const auto own = static_cast<size_t>(inner);
  const float top = tile.snow.top[own];
  float steepest = 0.0f;
  int32_t next = cell;
  // Limits grow with the distance, so their ratio with the fall ranks slopes.
  const auto consider = [&](float fall, float limit, int32_t to) {
    if (!(limit < kNoLink) || !(fall > steepest * limit)) return;
    steepest = fall / limit;
    next = to;
  };
  const int32_t column = inner % kReposeBlock;
  const int32_t row = inner / kReposeBlock;
  const int32_t side = links_->blocks_a_side;
  for (int32_t k = 0; k < kForwardLinks; ++k) {
    for (const int32_t sign : {1, -1}) {
      const int32_t x = column + sign * kForwardColumn[k];
      const int32_t y = row + sign * kForwardRow[k];
      const ReposeTile* other = &tile;
      int32_t other_block = block;
      if (((x | y) & ~(kReposeBlock - 1)) != 0) {
        const int32_t dx = x < 0 ? -1 : x / kReposeBlock;
        const int32_t dy = y < 0 ? -1 : y / kReposeBlock;
        const int32_t beside = block % side + dx;
        other_block = block + dy * side + dx;
        if (beside < 0 || beside >= side || other_block < 0 || other_block >= side * side) continue;
        other = tiles_[static_cast<size_t>(other_block)].get();
        if (other == nullptr) continue;
      }
      const int32_t at = (y & (kReposeBlock - 1)) * kReposeBlock + (x & (kReposeBlock - 1));
      const ReposeTile& giver = sign > 0 ? tile : *other;
      if (!giver.links.has_limits) continue;
      consider(top - other->snow.top[static_cast<size_t>(at)],
               giver.links.limit[static_cast<size_t>(k)][sign > 0 ? own : static_cast<size_t>(at)],
               other_block * kTileCells + at);
    }
  }
  const std::vector<RimLink>& rims = rims_[static_cast<size_t>(block)];
  const auto is_before = [](const RimLink& rim, int32_t at) { return rim.cell < at; };
  for (auto rim = std::lower_bound(rims.begin(), rims.end(), inner, is_before);
       rim != rims.end() && rim->cell == inner; ++rim) {
    consider(top - rim->bare, rim->limit, rim->number < 0 ? cell_of_wall(*rim) : -1 - rim->number);
  }
  if ((tile.ground.forward[own] & kAtSeam) == 0) return next;
  const int32_t* const ends = &links_->end_begin[static_cast<size_t>(block)];
  const auto lies_before = [](const ReposeLinks::End& end, int32_t at) { return end.cell < at; };
  const auto last = links_->ends.begin() + ends[1];
  for (auto end = std::lower_bound(links_->ends.begin() + ends[0], last, cell, lies_before);
       end != last && end->cell == cell; ++end) {
    if (static_cast<size_t>(end->link) >= across_.size()) continue;
    const auto& [a, b] = links_->across_cells[static_cast<size_t>(end->link)];
    const int32_t to = end->sign < 0 ? b : a;
    const ReposeTile* const other = tiles_[static_cast<size_t>(to / kTileCells)].get();
    if (other == nullptr) continue;
    consider(top - other->snow.top[static_cast<size_t>(to % kTileCells)],
             across_[static_cast<size_t>(end->link)].limit, to);
  }
  return next;
}

Repose::CellWays::Block& Repose::CellWays::block_of(int32_t cell) {
  auto& block = blocks[static_cast<size_t>(cell / kTileCells)];
  if (block == nullptr) block = std::make_unique_for_overwrite<Block>();
  if (std::exchange(block->run, run) != run) {
    block->end.fill(kNoWay);
    block->units.fill(0.0);
  }
  return *block;
}

void Repose::CellWays::begin(size_t count) {
  ++run;
  blocks.resize(count);
  ends.clear();
}

/// -1 - outlet, or the last cell. Surfaces only fall along a way, so that it ends.
int32_t Repose::CellWays::find(const Repose& repose, int32_t cell) {
  const auto end_of = [&](int32_t own) -> int32_t& {
    return block_of(own).end[static_cast<size_t>(own % kTileCells)];
  };
  passed.clear();
  while (end_of(cell) == kNoWay) {
    passed.push_back(cell);
    const int32_t next = repose.next_cell(cell);
    if (next < 0 || next == cell) {
      end_of(cell) = next;
      break;
    }
    cell = next;
  }
  const int32_t found = end_of(cell);
  for (const int32_t own : passed) end_of(own) = found;
  return found;
}

void Repose::CellWays::add(int32_t end, double units) {
  double& sum = block_of(end).units[static_cast<size_t>(end % kTileCells)];
  if (sum == 0.0) ends.push_back(end);
  sum += units;
}

const Repose::BareTexels& Repose::bare_texels() {
  if (!has_pose_) update_pose();
  if (has_bare_) return bare_;
  has_bare_ = true;
  const std::vector<int32_t>& places = table().texel;
  const size_t count = places.size();
  if (bare_.texel_of.empty()) {
    const auto side = static_cast<size_t>(links_->resolution);
    bare_.texel_of.assign(side * side, -1);
    for (size_t i = 0; i < count; ++i) {
      bare_.texel_of[static_cast<size_t>(places[i])] = static_cast<int32_t>(i);
    }
  }
  for (auto* plane : {&bare_.x, &bare_.y, &bare_.z, &bare_.up, &bare_.area}) plane->resize(count);
  std::vector<float> rest(2 * count);
  std::vector<uint8_t> two_sided(count);
  const ReposeSurface::Row all{bare_.x.data(),      bare_.y.data(),  bare_.z.data(),
                               rest.data(),         bare_.up.data(), bare_.area.data(),
                               rest.data() + count, two_sided.data()};
  constexpr size_t kRun = 4096;
  base::for_each_item((count + kRun - 1) / kRun, 1, [&](size_t run) {
    const size_t begin = run * kRun;
    surface_.texels(static_cast<int32_t>(begin),
                    static_cast<int32_t>(std::min(kRun, count - begin)), all.at(begin));
  });
  way_end_.assign(count, kNoWay);
  way_last_.assign(count, 0);
  return bare_;
}

int32_t Repose::next_down(int32_t texel, bool over_walls) const {
  const BareTexels& bare = bare_;
  const auto own = static_cast<size_t>(texel);
  if (!over_walls && shared::is_wall(bare.up[own])) return texel;
  float steepest = 0.0f;
  int32_t next = texel;
  const auto consider = [&](float x, float y, float z, int32_t to) {
    const float way = std::max(std::hypot(x - bare.x[own], y - bare.y[own]), 1e-6f);
    const float slope = (bare.z[own] - z) / way;
    if (!(slope > steepest)) return;
    steepest = slope;
    next = to;
  };
  const auto consider_texel = [&](int32_t to) {
    const auto i = static_cast<size_t>(to);
    consider(bare.x[i], bare.y[i], bare.z[i], to);
  };
  const int32_t place = table().texel[own];
  const int32_t column = place % links_->resolution;
  const int32_t row = place / links_->resolution;
  for (int32_t k = 0; k < kForwardLinks; ++k) {
    for (const int32_t sign : {1, -1}) {
      const int32_t x = column + sign * kForwardColumn[k];
      const int32_t y = row + sign * kForwardRow[k];
      if (x < 0 || y < 0 || x >= links_->resolution || y >= links_->resolution) continue;
      const int32_t giver = sign > 0 ? links_->cell_at(column, row) : links_->cell_at(x, y);
      if (((links_->forward[static_cast<size_t>(giver)] >> k) & 1) == 0) continue;
      const int32_t to = bare.texel_of[static_cast<size_t>(y * links_->resolution + x)];
      if (to >= 0) consider_texel(to);
    }
  }
  const int32_t* const ends = &links_->end_begin[static_cast<size_t>(links_->block_of(place))];
  const auto first = links_->ends.begin() + ends[0];
  const auto last = links_->ends.begin() + ends[1];
  const auto is_before = [](const ReposeLinks::End& end, int32_t t) { return end.texel < t; };
  for (auto end = std::lower_bound(first, last, texel, is_before);
       end != last && end->texel == texel; ++end) {
    const auto link = static_cast<size_t>(end->link);
    if (link >= across_.size()) {
      const glm::vec3 rim = surface_.point(links_->rims[link - across_.size()].point);
      consider(rim.x, rim.y, rim.z, -1 - end->link);
      continue;
    }
    const ReposeLinks::Across& across = links_->across[link];
    const int32_t to = end->sign < 0 ? across.b : across.a;
    if (!over_walls && shared::is_wall(bare.up[static_cast<size_t>(to)])) {
      const glm::vec3 seam = surface_.point(across.seam);
      consider(seam.x, seam.y, seam.z, -1 - end->link);
    } else {
      consider_texel(to);
    }
  }
  return next;
}

Repose::Release Repose::way_down(int32_t texel) {
  bare_texels();
  std::vector<int32_t> passed;
  int32_t at = texel;
  // Each step leads further down, so that the way ends.
  while (way_end_[static_cast<size_t>(at)] == kNoWay) {
    passed.push_back(at);
    const int32_t next = next_down(at);
    if (next < 0 || next == at) {
      way_end_[static_cast<size_t>(at)] = next;
      way_last_[static_cast<size_t>(at)] = at;
      break;
    }
    at = next;
  }
  const int32_t found = way_end_[static_cast<size_t>(at)];
  const int32_t last = way_last_[static_cast<size_t>(at)];
  for (const int32_t own : passed) {
    way_end_[static_cast<size_t>(own)] = found;
    way_last_[static_cast<size_t>(own)] = last;
  }
  const bool is_wall = shared::is_wall(bare_.up[static_cast<size_t>(last)]);
  return {found < 0 ? -1 - found : is_wall ? Release::kOffWall : Release::kInHollow, last, 0.0};
}

/// Lists what has fallen over outlets, what was cut above them, and what has left walls.
void Repose::collect_releases(const std::vector<Written>& written) {
  const auto unit = static_cast<double>(surface_.unit());
  std::vector<double> fallen(outlet_count(), 0.0);
  std::vector<int32_t> texel(outlet_count(), -1);
  ways_.begin(tiles_.size());
  for (const int32_t block : chosen_) {
    for (const RimLink& rim : rims_[static_cast<size_t>(block)]) {
      if (rim.number < 0) {
        if (rim.fallen > 0.0) ways_.add(cell_of_wall(rim), rim.fallen);
        continue;
      }
      texel[static_cast<size_t>(rim.number)] = rim.texel;
      fallen[static_cast<size_t>(rim.number)] += rim.fallen;
    }
  }
  for (const int32_t block : chosen_) {
    for (const auto& [cell, units] : tiles_[static_cast<size_t>(block)]->outlets.cuts) {
      const int32_t end = ways_.find(*this, block * kTileCells + cell);
      if (end < 0) {
        fallen[static_cast<size_t>(-1 - end)] += static_cast<double>(units);
      } else {
        ways_.add(end, static_cast<double>(units));
      }
    }
  }
  for (const int32_t end : ways_.ends) {
    const int32_t side = links_->blocks_a_side;
    const int32_t last = end % kTileCells;
    const int32_t column = end / kTileCells % side * kReposeBlock + last % kReposeBlock;
    const int32_t row = end / kTileCells / side * kReposeBlock + last / kReposeBlock;
    const bool is_wall =
        tiles_[static_cast<size_t>(end / kTileCells)]->snow.is_wall(static_cast<size_t>(last));
    releases_.push_back({is_wall ? Release::kOffWall : Release::kInHollow,
                         texel_at(table(), row * links_->resolution + column),
                         ways_.block_of(end).units[static_cast<size_t>(last)] * unit});
  }
  for (size_t i = 0; i < fallen.size(); ++i) {
    if (fallen[i] > 0.0) {
      releases_.push_back({static_cast<int32_t>(i), texel[i], fallen[i] * unit});
    }
  }
  for (const Written& own : written) {
    releases_.insert(releases_.end(), own.releases.begin(), own.releases.end());
  }
}

}  // namespace snowbough::snow
