#include "snow/movement/splat.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/simd.h"
#include "shaders/lib/texel_repose.h"
#include "snow/movement/landing.h"

namespace snowbough::snow {
namespace {

/// Largest radius of a disc, in texels.
constexpr int32_t kMaxTexels = 24;
constexpr size_t kMaxInRow = 2 * kMaxTexels + 1;

/// The weights of a row of texels around a point: 0 beyond `range` metres, and on walls. `side`: of
/// the surface on which the snow lies.
struct Disc {
  float x, y, z;
  float square;
  float side;
};

SNOWBOUGH_WIDE void weigh_row(const Disc& disc, size_t count, const float* __restrict x,
                              const float* __restrict y, const float* __restrict z,
                              const float* __restrict up, const float* __restrict area,
                              float* __restrict weight) {
  const Disc own = disc;
  for (size_t i = 0; i < count; ++i) {
    const float to_x = own.x - x[i];
    const float to_y = own.y - y[i];
    const float to_z = own.z - z[i];
    const float away = (to_x * to_x + to_y * to_y + to_z * to_z) / own.square;
    const bool is_wall = shared::is_wall(own.side * up[i]);
    weight[i] = (away < 1.0f) & !is_wall ? (1.0f - away) * area[i] : 0.0f;
  }
}

}  // namespace

Splat::Splat(const BareTexels& bare, const TexelTable& table, double radius)
    : bare_(bare),
      places_(table.texel),
      side_(table.resolution),
      radius_(static_cast<float>(radius)) {}

/// Whether snow that faces as at `facing` may lie on a texel.
bool Splat::holds(int32_t facing, int32_t at) const {
  return !shared::is_wall(side_of(facing) * bare_.up[static_cast<size_t>(at)]);
}

float Splat::squared_distance(int32_t a, int32_t b) const {
  const auto i = static_cast<size_t>(a), j = static_cast<size_t>(b);
  const float x = bare_.x[i] - bare_.x[j];
  const float y = bare_.y[i] - bare_.y[j];
  const float z = bare_.z[i] - bare_.z[j];
  return x * x + y * y + z * z;
}

/// The radius in texels around a place.
int32_t Splat::reach_at(int32_t place) const {
  const int32_t own = texel(place);
  if (own < 0) return 1;
  const float size = std::sqrt(std::max(bare_.area[static_cast<size_t>(own)], 1e-12f));
  return std::min(kMaxTexels, static_cast<int32_t>(std::ceil(radius_ / size)));
}

/// A place beside one whose texel is a wall, or only a sliver of surface on which snow would tower;
/// else the place itself.
int32_t Splat::broad_place_near(int32_t place) const {
  constexpr float kSliver = 0.25f;
  const int32_t own = texel(place);
  int32_t broadest = place;
  float most = holds(own, own) ? bare_.area[static_cast<size_t>(own)] / kSliver : 0.0f;
  const int32_t column = place % side_;
  const int32_t row = place / side_;
  for (int32_t y = std::max(row - 1, 0); y <= std::min(row + 1, side_ - 1); ++y) {
    for (int32_t x = std::max(column - 1, 0); x <= std::min(column + 1, side_ - 1); ++x) {
      const int32_t to = texel(y * side_ + x);
      if (to < 0 || !(bare_.area[static_cast<size_t>(to)] > most) || !holds(own, to)) continue;
      if (!(squared_distance(own, to) < radius_ * radius_)) continue;
      most = bare_.area[static_cast<size_t>(to)];
      broadest = y * side_ + x;
    }
  }
  return broadest;
}

int32_t Splat::snapped(int32_t place) const {
  const int32_t step = std::max(reach_at(place) / 4, 1);
  const auto to_middle = [&](int32_t i) { return std::min(i / step * step + step / 2, side_ - 1); };
  const int32_t there = to_middle(place / side_) * side_ + to_middle(place % side_);
  const int32_t from = texel(place);
  const int32_t to = texel(there);
  const bool is_near = from >= 0 && to >= 0 && holds(from, to) &&
                       squared_distance(from, to) < 0.25f * radius_ * radius_;
  return broad_place_near(is_near ? there : place);
}

/// The texels between two places of a row, the last included: consecutive ones.
std::pair<int32_t, int32_t> Splat::texels_between(int32_t first, int32_t last) const {
  while (first <= last && texel(first) < 0) ++first;
  if (first > last) return {0, 0};
  while (texel(last) < 0) --last;
  return {texel(first), texel(last) + 1};
}

int64_t Splat::add(int32_t place, int64_t units, MovingMap& map) {
  const int32_t centre = texel(place);
  const auto own = static_cast<size_t>(centre);
  const int32_t reach = reach_at(place);
  const float size = std::sqrt(std::max(bare_.area[own], 1e-12f));
  const float range = std::min(radius_, static_cast<float>(reach) * size);
  const Disc disc{bare_.x[own], bare_.y[own], bare_.z[own], range * range, side_of(centre)};
  const int32_t column = place % side_;
  const int32_t row = place / side_;
  const int32_t left = std::max(column - reach, 0);
  const int32_t right = std::min(column + reach, side_ - 1);
  std::array<float, kMaxInRow> weights;
  double whole = 0.0;
  parts_.clear();
  for (int32_t y = std::max(row - reach, 0); y <= std::min(row + reach, side_ - 1); ++y) {
    const auto [begin, end] = texels_between(y * side_ + left, y * side_ + right);
    const auto first = static_cast<size_t>(begin);
    const auto count = static_cast<size_t>(end - begin);
    weigh_row(disc, count, &bare_.x[first], &bare_.y[first], &bare_.z[first], &bare_.up[first],
              &bare_.area[first], weights.data());
    for (size_t i = 0; i < count; ++i) {
      if (!(weights[i] > 0.0f)) continue;
      parts_.push_back({begin + static_cast<int32_t>(i), static_cast<double>(weights[i])});
      whole += parts_.back().weight;
    }
  }
  int64_t rest = units;
  int64_t lost = 0;
  for (const Part& part : parts_) {
    const auto given = static_cast<int64_t>(static_cast<double>(units) * (part.weight / whole));
    lost += put(part.texel, given, map);
    rest -= given;
  }
  return lost + put(centre, rest, map);
}

/// Adds units to a texel; returns them, if it has no area.
int64_t Splat::put(int32_t texel, int64_t units, MovingMap& map) const {
  const auto own = static_cast<size_t>(texel);
  const auto area = static_cast<double>(bare_.area[own]);
  if (!(area > 0.0)) return units;
  float& height = (*map.height)[static_cast<size_t>(places_[own])];
  const bool is_back = height < 0.0f || (height == 0.0f && bare_.up[own] < 0.0f);
  const double before = std::abs(static_cast<double>(height));
  const auto now = static_cast<float>(before + static_cast<double>(units) * kLandingUnit / area);
  map.landed += (static_cast<double>(now) - before) * area;
  height = is_back ? -now : now;
  map.has_changed = true;
  return 0;
}

}  // namespace snowbough::snow
