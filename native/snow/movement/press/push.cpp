#include "snow/movement/press/push.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <limits>
#include <map>
#include <queue>
#include <utility>

#include "shaders/lib/texel_repose.h"
#include "snow/movement/press/pile.h"

namespace snowbough::snow {
namespace {

/// By how much a way along the object's motion is shorter.
constexpr double kAhead = 0.9;
/// A horizontal part of the motion over this is that of a blade, which spreads snow ahead only.
constexpr double kBlade = 0.7;
/// Heaps within squares of this part of the radius spread as one.
constexpr double kSquareOfHeaps = 0.125;
/// Largest radius of the spread, in texels.
constexpr int32_t kMaxSpread = 24;

/// Calls visit(neighbour) for the texels linked with one.
template <typename Visit>
void for_linked(const PressedMap& map, int32_t texel, const Visit& visit) {
  const ReposeLinks& links = *map.links;
  const int32_t place = map.place(texel);
  const int32_t column = place % links.resolution;
  const int32_t row = place / links.resolution;
  const int32_t cell = links.cell_at(column, row);
  const auto is_inner = [](int32_t at) {
    return at % kReposeBlock > 0 && at % kReposeBlock < kReposeBlock - 1;
  };
  // Most lie in one block of a map with their neighbours.
  const bool is_near_border =
      !is_inner(column) || !is_inner(row) || std::max(column, row) + 1 >= links.resolution;
  for (int32_t k = 0; k < kForwardLinks; ++k) {
    for (const int32_t sign : {1, -1}) {
      const int32_t aside = sign * kForwardColumn[k];
      const int32_t up = sign * kForwardRow[k];
      int32_t giver = cell;
      if (is_near_border) {
        const int32_t x = column + aside;
        const int32_t y = row + up;
        if (x < 0 || y < 0 || x >= links.resolution || y >= links.resolution) continue;
        if (sign < 0) giver = links.cell_at(x, y);
      } else if (sign < 0) {
        giver += up * kReposeBlock + aside;
      }
      if (((links.forward[static_cast<size_t>(giver)] >> k) & 1) == 0) continue;
      const int32_t other = place + up * links.resolution + aside;
      const int32_t to = map.bare->texel_of[static_cast<size_t>(other)];
      if (to >= 0) visit(to);
    }
  }
  const int32_t* const range = &links.end_begin[static_cast<size_t>(links.block_of(place))];
  if (range[0] == range[1]) return;
  const auto last = links.ends.begin() + range[1];
  const auto is_before = [](const ReposeLinks::End& end, int32_t t) { return end.texel < t; };
  for (auto end = std::lower_bound(links.ends.begin() + range[0], last, texel, is_before);
       end != last && end->texel == texel; ++end) {
    const auto link = static_cast<size_t>(end->link);
    if (link >= links.across.size()) continue;
    visit(end->sign < 0 ? links.across[link].b : links.across[link].a);
  }
}

/// The nearest free texel of each covered one, found from the edge inwards (E. W. Dijkstra, A note
/// on two problems in connexion with graphs, 1959).
class NearestFree {
 public:
  NearestFree(const PressedMap& map, const std::vector<int32_t>& covered,
              const std::vector<PushedSnow>& pushed)
      : map_(map),
        covered_(covered),
        cost_(covered.size(), std::numeric_limits<double>::infinity()),
        goal_(covered.size(), -1),
        way_(covered.size(), glm::dvec3(0.0)) {
    std::vector<uint8_t> is_pushed(covered.size(), 0);
    for (const PushedSnow& snow : pushed) {
      const auto own = static_cast<size_t>(map_.number_of(snow.texel));
      way_[own] = snow.way;
      is_pushed[own] = 1;
    }
    for (size_t i = 0; i < covered.size(); ++i) {
      for_linked(map, covered[i], [&](int32_t free) {
        if (!map.is_covered(free) && map.is_ground(free)) offer(i, free, 0.0, free);
      });
    }
    // Other covered texels need no goal.
    for (size_t left = pushed.size(); left > 0 && !open_.empty();) {
      const double cost = open_.top().first;
      const int32_t texel = open_.top().second;
      open_.pop();
      const auto own = static_cast<size_t>(map_.number_of(texel));
      if (cost > cost_[own]) continue;
      left -= is_pushed[own];
      for_linked(map, texel, [&](int32_t other) {
        const int32_t inner = map.number_of(other);
        if (inner >= 0) offer(static_cast<size_t>(inner), texel, cost, goal_[own]);
      });
    }
  }

  /// -1: none.
  int32_t of(int32_t texel) const { return goal_[static_cast<size_t>(map_.number_of(texel))]; }

 private:
  /// A way from a covered texel over a neighbour from which the goal costs `cost`.
  void offer(size_t from, int32_t over, double cost, int32_t goal) {
    // No way is shorter than 0.
    if (!(cost < cost_[from])) return;
    const glm::dvec3 step = map_.point(over) - map_.point(covered_[from]);
    const double whole = cost + glm::length(step) - kAhead * glm::dot(step, way_[from]);
    if (!(whole < cost_[from])) return;
    cost_[from] = whole;
    goal_[from] = goal;
    open_.emplace(whole, covered_[from]);
  }

  using Entry = std::pair<double, int32_t>;
  const PressedMap& map_;
  const std::vector<int32_t>& covered_;
  std::vector<double> cost_;
  std::vector<int32_t> goal_;
  std::vector<glm::dvec3> way_;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open_;
};

/// Sums the units of each texel, ascending.
std::vector<PushedSnow> summed(std::vector<PushedSnow> heaps) {
  std::stable_sort(heaps.begin(), heaps.end(),
                   [](const PushedSnow& a, const PushedSnow& b) { return a.texel < b.texel; });
  std::vector<PushedSnow> sums;
  for (const PushedSnow& heap : heaps) {
    if (sums.empty() || sums.back().texel != heap.texel) {
      sums.push_back({heap.texel, 0, glm::dvec3(0.0)});
    }
    sums.back().units += heap.units;
    sums.back().way += static_cast<double>(heap.units) * heap.way;
  }
  for (PushedSnow& sum : sums) sum.way /= static_cast<double>(std::max<int64_t>(sum.units, 1));
  return sums;
}

/// Joins heaps in squares of the map that are small against the radius of their spread, at the
/// first of them.
std::vector<PushedSnow> joined(const PressedMap& map, const std::vector<PushedSnow>& heaps,
                               double radius) {
  if (heaps.empty()) return heaps;
  const double size = std::sqrt(std::max(map.area(heaps.front().texel), 1e-12));
  const auto side = static_cast<int32_t>(std::clamp(kSquareOfHeaps * radius / size, 1.0, 64.0));
  const int32_t resolution = map.links->resolution;
  std::map<int32_t, size_t> known;
  std::vector<PushedSnow> squares;
  for (const PushedSnow& heap : heaps) {
    const int32_t place = map.place(heap.texel);
    const int32_t square = place / resolution / side * resolution + place % resolution / side;
    const auto [at, is_new] = known.try_emplace(square, squares.size());
    if (is_new) {
      squares.push_back(heap);
      continue;
    }
    PushedSnow& sum = squares[at->second];
    const auto own = static_cast<double>(heap.units);
    const auto before = static_cast<double>(sum.units);
    sum.way = (before * sum.way + own * heap.way) / std::max(before + own, 1.0);
    sum.units += heap.units;
  }
  return squares;
}

/// The part of a map on which heaps spread.
class Window {
 public:
  Window(const PressedMap& map, const std::vector<int32_t>& covered,
         const std::vector<PushedSnow>& heaps, double reach)
      : map_(map), side_(map.links->resolution) {
    glm::ivec2 low(side_);
    glm::ivec2 high(-1);
    for (const PushedSnow& heap : heaps) {
      const int32_t margin = std::min(texels(heap.texel, reach), 2 * kMaxSpread);
      const glm::ivec2 at(map.place(heap.texel) % side_, map.place(heap.texel) / side_);
      low = glm::min(low, at - margin);
      high = glm::max(high, at + margin);
    }
    low_ = glm::max(low, glm::ivec2(0));
    size_ = glm::max(glm::min(high, glm::ivec2(side_ - 1)) - low_ + 1, glm::ivec2(0));
    takes_.assign(static_cast<size_t>(size_.x) * static_cast<size_t>(size_.y), kUnknown);
    for (const int32_t texel : covered) {
      const glm::ivec2 at = glm::ivec2(map.place(texel) % side_, map.place(texel) / side_) - low_;
      if (at.x < 0 || at.y < 0 || at.x >= size_.x || at.y >= size_.y) continue;
      takes_[static_cast<size_t>(at.y * size_.x + at.x)] = kNo;
    }
  }

  /// Spreads a heap over the free texels within a radius on the map and on the surface, in whole
  /// units; the remainder stays in the middle. `units`: by cell of the window.
  void spread(const PushedSnow& heap, double radius, bool ahead_only, std::vector<int64_t>& units) {
    const int32_t reach = std::min(texels(heap.texel, radius), kMaxSpread);
    const double range = std::min(radius, reach * size_of_texel(heap.texel));
    const glm::ivec2 centre(map_.place(heap.texel) % side_, map_.place(heap.texel) / side_);
    const glm::dvec3 middle = map_.point(heap.texel);
    const glm::ivec2 from = glm::max(centre - reach, low_);
    const glm::ivec2 to = glm::min(centre + reach, low_ + size_ - 1);
    parts_.clear();
    double whole = 0.0;
    for (int32_t y = from.y; y <= to.y; ++y) {
      for (int32_t x = from.x; x <= to.x; ++x) {
        const size_t cell = cell_at(x, y);
        if (!takes(cell, x, y)) continue;
        const int32_t own = map_.bare->texel_of[static_cast<size_t>(y * side_ + x)];
        const glm::dvec3 way = map_.point(own) - middle;
        const double weight = (1.0 - glm::dot(way, way) / (range * range)) * map_.area(own);
        if (!(weight > 0.0) || (ahead_only && glm::dot(way, heap.way) < 0.0)) continue;
        parts_.emplace_back(cell, weight);
        whole += weight;
      }
    }
    int64_t rest = heap.units;
    for (const auto& [cell, weight] : parts_) {
      const auto own = static_cast<int64_t>(static_cast<double>(heap.units) * (weight / whole));
      const int64_t given = std::min(own, rest);
      rest -= given;
      units[cell] += given;
    }
    units[cell_at(centre.x, centre.y)] += rest;
  }

  size_t cells() const { return takes_.size(); }
  int32_t texel(size_t cell) const {
    const auto at = static_cast<int32_t>(cell);
    return map_.bare
        ->texel_of[static_cast<size_t>((at / size_.x + low_.y) * side_ + low_.x + at % size_.x)];
  }

 private:
  static constexpr uint8_t kUnknown = 0;
  static constexpr uint8_t kYes = 1;
  static constexpr uint8_t kNo = 2;

  double size_of_texel(int32_t texel) const { return std::sqrt(std::max(map_.area(texel), 1e-12)); }
  int32_t texels(int32_t texel, double radius) const {
    return static_cast<int32_t>(std::clamp(std::ceil(radius / size_of_texel(texel)), 1.0, 1e4));
  }
  size_t cell_at(int32_t x, int32_t y) const {
    return static_cast<size_t>((y - low_.y) * size_.x + x - low_.x);
  }
  /// Whether snow may spread to a cell.
  bool takes(size_t cell, int32_t x, int32_t y) {
    if (takes_[cell] == kUnknown) {
      const int32_t own = map_.bare->texel_of[static_cast<size_t>(y * side_ + x)];
      takes_[cell] = own >= 0 && map_.is_ground(own) ? kYes : kNo;
    }
    return takes_[cell] == kYes;
  }

  const PressedMap& map_;
  int32_t side_;
  glm::ivec2 low_{0};
  glm::ivec2 size_{0};
  std::vector<uint8_t> takes_;
  std::vector<std::pair<size_t, double>> parts_;
};

}  // namespace

bool PressedMap::is_ground(int32_t texel) const {
  const double up = side(texel) * static_cast<double>(bare->up[static_cast<size_t>(texel)]);
  return area(texel) > 0.0 && !shared::is_wall(static_cast<float>(up));
}

void PressedMap::add(int32_t texel, int64_t units) const {
  float& own = height_at(texel);
  const double thickness =
      static_cast<double>(std::abs(own)) + static_cast<double>(units) * kPushUnit / area(texel);
  own = static_cast<float>(side(texel) * thickness);
}

std::vector<int32_t> spread_pushed(const PressedMap& map, const std::vector<int32_t>& covered,
                                   const std::vector<PushedSnow>& pushed, double radius,
                                   double slope, int64_t& kept) {
  const NearestFree nearest(map, covered, pushed);
  std::vector<PushedSnow> heaps;
  double fastest = 0.0;
  for (const PushedSnow& snow : pushed) {
    const int32_t goal = nearest.of(snow.texel);
    if (goal < 0) {
      kept += snow.units;
      continue;
    }
    heaps.push_back({goal, snow.units, snow.way});
    fastest = std::max(fastest, glm::length(snow.way));
  }
  heaps = summed(std::move(heaps));
  std::vector<int32_t> gains;
  if (slope > 0.0) {
    pile_ahead(map, heaps, radius, slope, gains);
    return gains;
  }
  if (radius <= 0.0) {
    for (const PushedSnow& heap : heaps) {
      map.add(heap.texel, heap.units);
      gains.push_back(heap.texel);
    }
    return gains;
  }
  heaps = joined(map, heaps, radius);
  Window window(map, covered, heaps, radius);
  std::vector<int64_t> units(window.cells(), 0);
  for (const PushedSnow& heap : heaps) window.spread(heap, radius, fastest > kBlade, units);
  for (size_t cell = 0; cell < units.size(); ++cell) {
    if (units[cell] <= 0) continue;
    gains.push_back(window.texel(cell));
    map.add(gains.back(), units[cell]);
  }
  return gains;
}

}  // namespace snowbough::snow
