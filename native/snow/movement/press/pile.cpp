#include "snow/movement/press/pile.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <limits>

#include "shaders/lib/texel_repose.h"

namespace snowbough::snow {
namespace {

/// Texels around one that show where a blade is.
constexpr int32_t kAround = 6;
/// Half the widest strip, in texels.
constexpr int32_t kWidest = 8;
/// Texels a side of the squares that a strip is made of, and strips of fewer texels have single
/// ones.
constexpr int32_t kSquare = 4;
/// A strip is this much longer than its heap, and longer again if it proves too short.
constexpr double kLonger = 1.25;
constexpr int kMaxTries = 6;

/// Columns on either side for maps that are not even.
constexpr double kUneven = 2.0;

/// Snow that goes into one strip.
struct Pile {
  int32_t texel = 0;
  int64_t units = 0;
  glm::dvec3 way{0.0};
};

/// A square of texels of a strip.
struct PileCell {
  /// Of its first texel.
  glm::ivec2 at{0};
  /// Height of the snow over the falling plane through the strip's beginning, in metres; and the
  /// volume in m3 that raises it by a metre.
  double level = 0.0;
  double capacity = 0.0;
};

glm::ivec2 pixel_of(const PressedMap& map, int32_t texel) {
  return {map.place(texel) % map.links->resolution, map.place(texel) / map.links->resolution};
}

int32_t texel_on(const PressedMap& map, const glm::ivec2& at) {
  const int32_t side = map.links->resolution;
  if (at.x < 0 || at.y < 0 || at.x >= side || at.y >= side) return -1;
  return map.bare->texel_of[static_cast<size_t>(at.y * side + at.x)];
}

/// The horizontal way to the next column or row of the map; 0 if there is none.
glm::dvec2 next_on_map(const PressedMap& map, int32_t texel, const glm::ivec2& step) {
  for (const int32_t sign : {1, -1}) {
    const int32_t other = texel_on(map, pixel_of(map, texel) + sign * step);
    if (other < 0) continue;
    return static_cast<double>(sign) * glm::dvec2(map.point(other) - map.point(texel));
  }
  return glm::dvec2(0.0);
}

/// The horizontal unit vector away from the covered texels around one; the motion's where they lie
/// ahead, or on all sides.
glm::dvec2 away_from_covered(const PressedMap& map, int32_t texel, const glm::dvec2& motion) {
  glm::dvec2 away(0.0);
  for (int32_t y = -kAround; y <= kAround; y += 2) {
    for (int32_t x = -kAround; x <= kAround; x += 2) {
      const int32_t other = texel_on(map, pixel_of(map, texel) + glm::ivec2(x, y));
      if (other >= 0 && map.is_covered(other))
        away += glm::dvec2(map.point(texel) - map.point(other));
    }
  }
  const double length = glm::length(away);
  return glm::dot(away, motion) > 0.1 * length ? away / length : motion;
}

/// Collects snow whose texels lie in one square of the map, `width` texels wide.
std::vector<Pile> collect_piles(const PressedMap& map, const std::vector<PushedSnow>& pushed,
                                int32_t width) {
  const auto square_of = [&](const PushedSnow& snow) {
    const glm::ivec2 square = pixel_of(map, snow.texel) / width;
    return square.y * map.links->resolution + square.x;
  };
  std::vector<PushedSnow> sorted = pushed;
  std::stable_sort(sorted.begin(), sorted.end(), [&](const PushedSnow& a, const PushedSnow& b) {
    return square_of(a) < square_of(b);
  });
  std::vector<Pile> piles;
  for (size_t begin = 0, end = 0; begin < sorted.size(); begin = end) {
    Pile pile;
    glm::dvec3 middle(0.0);
    while (end < sorted.size() && square_of(sorted[end]) == square_of(sorted[begin])) {
      const auto weight = static_cast<double>(sorted[end].units);
      pile.units += sorted[end].units;
      pile.way += weight * sorted[end].way;
      middle += weight * map.point(sorted[end].texel);
      ++end;
    }
    middle /= static_cast<double>(pile.units);
    const auto nearest = std::min_element(sorted.begin() + static_cast<ptrdiff_t>(begin),
                                          sorted.begin() + static_cast<ptrdiff_t>(end),
                                          [&](const PushedSnow& a, const PushedSnow& b) {
                                            return glm::distance(map.point(a.texel), middle) <
                                                   glm::distance(map.point(b.texel), middle);
                                          });
    pile.texel = nearest->texel;
    piles.push_back(pile);
  }
  return piles;
}

/// Calls visit(texel) for the free texels of a square.
template <typename Visit>
void for_texels_of(const PressedMap& map, const glm::ivec2& at, int32_t square,
                   const Visit& visit) {
  for (int32_t y = 0; y < square; ++y) {
    for (int32_t x = 0; x < square; ++x) {
      const int32_t texel = texel_on(map, at + glm::ivec2(x, y));
      if (texel >= 0 && !map.is_covered(texel) && map.area(texel) > 0.0) visit(texel);
    }
  }
}

/// The free texels of a strip, in squares of `square` texels a side, whose first ones stand for
/// all.
std::vector<PileCell> find_strip(const PressedMap& map, int32_t texel, const glm::dvec2& outward,
                                 double width, double length, double slope, int32_t square) {
  const glm::dvec2 x = next_on_map(map, texel, {1, 0});
  const glm::dvec2 y = next_on_map(map, texel, {0, 1});
  const double area = x.x * y.y - x.y * y.x;
  if (!(std::abs(area) > 0.1 * glm::length(x) * glm::length(y))) return {};
  const auto on_map = [&](const glm::dvec2& way) {
    return glm::dvec2(way.x * y.y - way.y * y.x, x.x * way.y - x.y * way.x) / area;
  };
  const glm::dvec2 aside(-outward.y, outward.x);
  const glm::dvec2 ahead = on_map(length * outward);
  const glm::dvec2 half = glm::abs(on_map(width * aside)) + 1.0;
  const glm::ivec2 first(pixel_of(map, texel));
  const int32_t last_place = map.links->resolution - 1;
  const int32_t begin =
      std::max(first.y + static_cast<int32_t>(std::floor(std::min(ahead.y, 0.0) - half.y)), 0);
  const int32_t end = std::min(
      first.y + static_cast<int32_t>(std::ceil(std::max(ahead.y, 0.0) + half.y)), last_place);
  const glm::dvec3 from = map.point(texel);
  const double half_texel = 0.5 * std::sqrt(map.area(texel));
  std::vector<PileCell> cells;
  const auto next_square = [&](int32_t at) { return (at + square - 1) / square * square; };
  for (int32_t row = next_square(begin); row <= end; row += square) {
    // On an even map a row of the strip has these columns.
    double low = -1e9;
    double high = 1e9;
    const auto clip = [&](const glm::dvec2& axis, double least, double most) {
      const double a_column = glm::dot(x, axis);
      const double here = glm::dot(y, axis) * (row - first.y);
      if (std::abs(a_column) < 1e-3 * glm::length(x)) return;
      const double a = (least - here) / a_column;
      const double b = (most - here) / a_column;
      low = std::max(low, std::min(a, b));
      high = std::min(high, std::max(a, b));
    };
    clip(outward, -half_texel, length);
    clip(aside, -width, width);
    if (low > high + 2.0 * kUneven) continue;
    const auto column_of = [&](double offset) {
      const double column = std::clamp(first.x + offset, 0.0, static_cast<double>(last_place));
      return static_cast<int32_t>(std::lround(column));
    };
    const int32_t right = column_of(high + kUneven);
    for (int32_t column = next_square(column_of(low - kUneven)); column <= right;
         column += square) {
      const auto place = static_cast<size_t>(row * map.links->resolution + column);
      const int32_t own = map.bare->texel_of[place];
      if (own < 0) continue;
      const glm::dvec3 way = map.point(own) - from;
      const double away = glm::dot(glm::dvec2(way), outward);
      if (away < -half_texel || away > length) continue;
      if (std::abs(glm::dot(glm::dvec2(way), aside)) > width) continue;
      // Steeper surfaces are of another floor.
      if (std::abs(way.z) > away + 4.0 * half_texel) continue;
      const float height = (*map.height)[place];
      const float normal_up = map.bare->up[static_cast<size_t>(own)];
      const float up = PressedMap::side(height, normal_up) < 0.0 ? -normal_up : normal_up;
      const double area = map.area(own);
      if (map.is_covered(own) || !(area > 0.0) || shared::is_wall(up)) continue;
      const auto rise = static_cast<double>(shared::column_height(up));
      const double top = way.z + rise * static_cast<double>(std::abs(height));
      int32_t count = 0;
      for_texels_of(map, {column, row}, square, [&](int32_t) { ++count; });
      cells.push_back({{column, row}, top + slope * away, area / rise * count});
    }
  }
  return cells;
}

/// The level to which a volume fills cells (after C. Michelot, A finite algorithm for finding the
/// projection of a point onto the canonical simplex, 1986).
double filled_level(const std::vector<PileCell>& cells, double volume) {
  double level = std::numeric_limits<double>::infinity();
  for (size_t filled = cells.size() + 1;;) {
    double whole = volume;
    double capacity = 0.0;
    size_t below = 0;
    for (const PileCell& cell : cells) {
      if (!(cell.level < level)) continue;
      whole += cell.capacity * cell.level;
      capacity += cell.capacity;
      ++below;
    }
    if (below == filled) return level;
    filled = below;
    level = whole / capacity;
  }
}

void add_pile(const PressedMap& map, const Pile& pile, double width, double slope, int32_t square,
              std::vector<int32_t>& gains) {
  const double volume = static_cast<double>(pile.units) * kPushUnit;
  const glm::dvec2 outward =
      away_from_covered(map, pile.texel, glm::normalize(glm::dvec2(pile.way)));
  double length = kLonger * static_cast<double>(std::abs(map.height_at(pile.texel))) / slope;
  length = std::max(length, 2.0 * width);
  std::vector<PileCell> cells;
  double level = 0.0;
  for (int i = 0; i < kMaxTries; ++i, length *= kLonger) {
    cells = find_strip(map, pile.texel, outward, width, length, slope, square);
    if (cells.empty()) break;
    level = filled_level(cells, volume);
    // At its end the strip reaches over the snow that lay there.
    if (level < slope * length) break;
  }
  int64_t rest = pile.units;
  for (const PileCell& cell : cells) {
    const double own = std::max(level - cell.level, 0.0) * cell.capacity;
    if (!(own > 0.0)) continue;
    int32_t count = 0;
    for_texels_of(map, cell.at, square, [&](int32_t) { ++count; });
    const int64_t part = std::llround(own / (count * kPushUnit));
    for_texels_of(map, cell.at, square, [&](int32_t texel) {
      const int64_t given = std::min(part, rest);
      if (given <= 0) return;
      rest -= given;
      map.add(texel, given);
      gains.push_back(texel);
    });
  }
  if (rest == 0) return;
  map.add(pile.texel, rest);
  gains.push_back(pile.texel);
}

}  // namespace

void pile_ahead(const PressedMap& map, const std::vector<PushedSnow>& pushed, double width,
                double slope, std::vector<int32_t>& gains) {
  if (pushed.empty()) return;
  const double size = std::sqrt(std::max(map.area(pushed.front().texel), 1e-12));
  const auto texels =
      static_cast<int32_t>(std::clamp(std::round(width / size), 1.0, double{kWidest}));
  const int32_t square = texels < 2 * kSquare ? 1 : kSquare;
  for (const Pile& pile : collect_piles(map, pushed, texels)) {
    if (glm::length(glm::dvec2(pile.way)) > 0.0) {
      add_pile(map, pile, texels * size, slope, square, gains);
    } else {
      map.add(pile.texel, pile.units);
      gains.push_back(pile.texel);
    }
  }
}

}  // namespace snowbough::snow
