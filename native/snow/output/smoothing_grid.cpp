#include "snow/output/smoothing_grid.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/zeroed_array.h"

namespace snowbough::snow {
namespace {

constexpr int32_t kMaxLevels = 7;
constexpr int32_t kSmallestLevel = 8;
/// Maximum number of whole links per cell: each moves at most a fifth of a difference.
constexpr float kMaxLinks = 5.0f;

/// A link across a seam. a < b.
struct LooseLink {
  int32_t a;
  int32_t b;
  float weight;
  /// Sum of weight * closeness over its parts.
  float closeness;

  bool operator<(const LooseLink& other) const { return a != other.a ? a < other.a : b < other.b; }
};

LooseLink loose_link(int32_t one, int32_t other, float weight, float closeness) {
  return {std::min(one, other), std::max(one, other), weight, weight * closeness};
}

/// Merges equal links by adding their parts.
void merge(std::vector<LooseLink>& links) {
  std::stable_sort(links.begin(), links.end());
  size_t count = 0;
  for (const LooseLink& link : links) {
    if (count > 0 && !(links[count - 1] < link)) {
      links[count - 1].weight += link.weight;
      links[count - 1].closeness += link.closeness;
    } else {
      links[count++] = link;
    }
  }
  links.resize(count);
}

/// Number of a cell's links on the grid.
float grid_links(const SmoothingLevel& level, int32_t cell) {
  const uint16_t* const right = level.to_right() + cell;
  const uint16_t* const above = level.upwards() + cell;
  return static_cast<float>((right[0] != 0) + (right[-1] != 0) + (above[0] != 0) +
                            (above[-level.size] != 0));
}

/// Scales weights down so that no cell has more than kMaxLinks.
void limit_weights(const SmoothingLevel& level, std::vector<LooseLink>& links) {
  const auto size = static_cast<size_t>(level.size);
  const base::ZeroedArray<float> sums(size * size);
  float* const loose = sums.data();
  for (const LooseLink& link : links) {
    loose[link.a] += link.weight;
    loose[link.b] += link.weight;
  }
  const auto room = [&](int32_t cell) {
    return std::min(1.0f, (kMaxLinks - grid_links(level, cell)) / std::max(loose[cell], 1e-6f));
  };
  for (LooseLink& link : links) {
    const float part = std::min(room(link.a), room(link.b));
    link.weight *= part;
    link.closeness *= part;
  }
}

/// Stores every link at both ends.
void lay_links(SmoothingLevel& level, std::vector<LooseLink>& links) {
  merge(links);
  limit_weights(level, links);
  const auto cells = static_cast<size_t>(level.size) * static_cast<size_t>(level.size);
  std::vector<int32_t> count(cells, 0);
  for (const LooseLink& link : links) ++count[link.a], ++count[link.b];
  std::vector<int32_t> next(cells, 0);
  level.link_row.assign(static_cast<size_t>(level.size) + 1, 0);
  int32_t total = 0;
  for (size_t i = 0; i < cells; ++i) {
    if (count[i] == 0) continue;
    level.link_cell.push_back(static_cast<int32_t>(i));
    level.link_begin.push_back(total);
    ++level.link_row[i / static_cast<size_t>(level.size) + 1];
    next[i] = total;
    total += count[i];
  }
  level.link_begin.push_back(total);
  for (size_t y = 1; y < level.link_row.size(); ++y) level.link_row[y] += level.link_row[y - 1];
  level.link_other.resize(static_cast<size_t>(total));
  level.link_weight.resize(static_cast<size_t>(total));
  level.link_closeness.resize(static_cast<size_t>(total));
  for (const LooseLink& link : links) {
    for (const auto& [own, other] : {std::pair(link.a, link.b), std::pair(link.b, link.a)}) {
      const auto at = static_cast<size_t>(next[own]++);
      level.link_other[at] = other;
      level.link_weight[at] = link.weight;
      level.link_closeness[at] = link.weight > 0.0f ? link.closeness / link.weight : 0.0f;
    }
  }
}

float closeness_of(float length) {
  return length > 0.0f ? 1.0f / (length * length) : 0.0f;
}

/// The links of one axis: within runs on the grid, at their ends to the texels of the first ghost.
/// Both sides of a seam contribute half a link each.
void link_texels(const TexelTable& table, const SeamTable& seams, int axis, SmoothingLevel& level,
                 std::vector<LooseLink>& loose) {
  const TexelLines& lines = axis == 0 ? seams.u : seams.v;
  std::vector<uint16_t>& links = axis == 0 ? level.right : level.above;
  std::vector<int32_t> texel_at(static_cast<size_t>(lines.length), -1);
  for (size_t i = 0; i < lines.place.size(); ++i) {
    texel_at[lines.place[i]] = static_cast<int32_t>(i);
  }
  const auto length = [&](int32_t i) { return seams.texel_size[i][axis]; };
  for (size_t i = 0; i < lines.place.size(); ++i) {
    const int32_t next = texel_at[lines.place[i] + 1];
    if (next < 0) continue;
    const float mean = 0.5f * (length(static_cast<int32_t>(i)) + length(next));
    links[table.texel[i] + table.resolution] = rounded_half(closeness_of(mean));
  }
  for (size_t g = 0; g < lines.ghost_place.size(); g += kFilterReach) {
    const int32_t place = lines.ghost_place[g];
    const bool is_begin = g / kFilterReach % 2 == 0;
    const int32_t own = texel_at[place + (is_begin ? 1 : -1)];
    for (int32_t t = lines.ghosts.begin[g]; t < lines.ghosts.begin[g + 1]; ++t) {
      const int32_t other = lines.ghosts.source[t];
      if (other == own) continue;
      loose.push_back(loose_link(table.texel[own], table.texel[other],
                                 0.5f * lines.ghosts.weight[t], closeness_of(length(own))));
    }
  }
}

/// Input for building a level from the finer one.
struct Cells {
  std::vector<int32_t> chart;
  std::vector<float> area;
  std::vector<LooseLink> loose;
};

/// The chart with the largest area in a block; -1 if there is none.
int32_t chart_of_block(const std::array<int32_t, 4>& children, const Cells& cells) {
  const auto is_first = [&](int32_t child) {
    return cells.chart[child] == cells.chart[children[0]];
  };
  if (std::all_of(children.begin() + 1, children.end(), is_first)) return cells.chart[children[0]];
  int32_t best = -1;
  float most = 0.0f;
  for (const int32_t child : children) {
    float area = 0.0f;
    for (const int32_t other : children) {
      if (cells.chart[other] == cells.chart[child]) area += cells.area[other];
    }
    if (cells.chart[child] >= 0 && (best < 0 || area > most)) {
      best = cells.chart[child];
      most = area;
    }
  }
  return best;
}

/// The neighbouring block with a cell's own chart, or -1.
int32_t block_beside(int32_t x, int32_t y, int32_t size, int32_t chart,
                     const std::vector<int32_t>& block_chart) {
  // Nearest first: across the side next to the cell.
  const int32_t side_x = x % 2 == 0 ? -1 : 1;
  const int32_t side_y = y % 2 == 0 ? -1 : 1;
  const std::array<std::pair<int32_t, int32_t>, 8> steps{{{side_x, 0},
                                                          {0, side_y},
                                                          {side_x, side_y},
                                                          {-side_x, 0},
                                                          {0, -side_y},
                                                          {-side_x, side_y},
                                                          {side_x, -side_y},
                                                          {-side_x, -side_y}}};
  for (const auto& [dx, dy] : steps) {
    const int32_t bx = x / 2 + dx;
    const int32_t by = y / 2 + dy;
    if (bx < 0 || by < 0 || bx >= size || by >= size) continue;
    if (block_chart[by * size + bx] == chart) return by * size + bx;
  }
  return -1;
}

/// Assigns every cell of `level` to a block; -1: none.
std::vector<int32_t> join_blocks(SmoothingLevel& level, const Cells& cells, Cells& blocks) {
  const int32_t size = level.size;
  const int32_t half = size / 2;
  blocks.chart.assign(static_cast<size_t>(half) * half, -1);
  blocks.area.assign(blocks.chart.size(), 0.0f);
  for (int32_t y = 0; y < half; ++y) {
    for (int32_t x = 0; x < half; ++x) {
      const int32_t first = 2 * y * size + 2 * x;
      blocks.chart[y * half + x] =
          chart_of_block({first, first + 1, first + size, first + size + 1}, cells);
    }
  }
  std::vector<int32_t> parent(cells.chart.size(), -1);
  level.joins.assign(cells.chart.size(), 0);
  for (int32_t i = 0; i < size * size; ++i) {
    const int32_t chart = cells.chart[i];
    if (chart < 0) continue;
    const int32_t x = i % size;
    const int32_t y = i / size;
    const int32_t own = y / 2 * half + x / 2;
    const bool is_own = x / 2 < half && y / 2 < half && blocks.chart[own] == chart;
    parent[i] = is_own ? own : block_beside(x, y, half, chart, blocks.chart);
    if (is_own) level.joins[i] = 1;
    if (!is_own && parent[i] >= 0) level.reassigned.push_back({i, parent[i]});
    if (parent[i] >= 0) blocks.area[parent[i]] += cells.area[i];
  }
  return parent;
}

/// The next coarser level: two parallel links make one whole link of twice the length.
SmoothingLevel coarsened(SmoothingLevel& level, const Cells& cells, Cells& blocks) {
  const int32_t size = level.size;
  const std::vector<int32_t> parent = join_blocks(level, cells, blocks);
  SmoothingLevel next;
  next.size = size / 2;
  std::vector<float> right(blocks.chart.size(), 0.0f);
  std::vector<float> above(blocks.chart.size(), 0.0f);
  const auto add = [&](int32_t i, int32_t j, float weight, float closeness) {
    const int32_t a = std::min(parent[i], parent[j]);
    const int32_t b = std::max(parent[i], parent[j]);
    if (a < 0 || a == b) return;
    if (b == a + 1 && b % next.size != 0) {
      right[a] += 0.125f * weight * closeness;
    } else if (b == a + next.size) {
      above[a] += 0.125f * weight * closeness;
    } else {
      blocks.loose.push_back(loose_link(a, b, 0.5f * weight, 0.25f * closeness));
    }
  };
  for (int32_t i = 0; i < size * size; ++i) {
    if (level.to_right()[i] != 0) add(i, i + 1, 1.0f, from_half(level.to_right()[i]));
    if (level.upwards()[i] != 0) add(i, i + size, 1.0f, from_half(level.upwards()[i]));
  }
  for (const LooseLink& link : cells.loose) {
    if (link.weight > 0.0f) add(link.a, link.b, link.weight, link.closeness / link.weight);
  }
  next.right.assign(static_cast<size_t>(next.size), 0);
  next.above.assign(static_cast<size_t>(next.size), 0);
  for (const float closeness : right) next.right.push_back(rounded_half(closeness));
  for (const float closeness : above) next.above.push_back(rounded_half(closeness));
  return next;
}

}  // namespace

SmoothingGrid build_smoothing_grid(const TexelTable& table, const SeamTable& seams) {
  const auto texels = static_cast<size_t>(table.resolution) * static_cast<size_t>(table.resolution);
  SmoothingGrid grid;
  grid.inverse_area.assign(texels, 0.0f);
  Cells cells{std::vector<int32_t>(texels, -1), std::vector<float>(texels, 0.0f), {}};
  for (size_t i = 0; i < table.texel.size(); ++i) {
    const float area = seams.texel_area[i];
    if (!(area > 1e-30f)) continue;
    grid.inverse_area[table.texel[i]] = 1.0f / area;
    cells.chart[table.texel[i]] = table.chart[i];
    cells.area[table.texel[i]] = area;
  }
  SmoothingLevel& first = grid.levels.emplace_back();
  first.size = table.resolution;
  first.right.assign(texels + static_cast<size_t>(first.size), 0);
  first.above.assign(texels + static_cast<size_t>(first.size), 0);
  link_texels(table, seams, 0, first, cells.loose);
  link_texels(table, seams, 1, first, cells.loose);
  lay_links(first, cells.loose);
  while (grid.levels.size() < kMaxLevels && grid.levels.back().size >= 2 * kSmallestLevel) {
    Cells blocks;
    SmoothingLevel next = coarsened(grid.levels.back(), cells, blocks);
    lay_links(next, blocks.loose);
    grid.levels.push_back(std::move(next));
    cells = std::move(blocks);
  }
  return grid;
}

}  // namespace snowbough::snow
