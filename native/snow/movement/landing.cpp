#include "snow/movement/landing.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "base/parallel_for.h"
#include "shaders/lib/texel_repose.h"
#include "snow/movement/hashed.h"

namespace snowbough::snow {
namespace {

/// Rays that snow of one cell falls along, if it spreads.
constexpr int kRays = 6;
/// Snow starts this far outside the edge, in metres, so that it misses the wall below.
constexpr double kOutside = 0.01;
/// Snow that its surface lets go starts this far below it, in metres.
constexpr double kBelowSurface = 1e-3;
/// A thrown path consists of this many straight pieces of equal time until kThrownSeconds, then it
/// runs almost straight down.
constexpr int kPieces = 6;
constexpr double kThrownSeconds = 0.9;
/// Seconds for which snow that leaves the scene is shown.
constexpr double kLeaves = 1.5;
/// Shorter flights are not shown, in seconds.
constexpr double kShortest = 1e-3;
/// Largest radius of that disc, in texels.
constexpr int32_t kMostTexels = 24;

int64_t units_of(double volume) {
  return std::llround(volume / kLandingUnit);
}

/// Adds snow to a map, each arrival spread over a disc.
class Splat {
 public:
  Splat(const BareTexels& bare, double radius)
      : bare_(bare),
        side_(static_cast<int32_t>(std::lround(std::sqrt(bare.texel_of.size())))),
        radius_(static_cast<float>(radius)) {}

  /// Moves a place to a lattice a quarter of the radius wide, so that neighbours land together.
  int32_t snapped(int32_t place) const {
    const int32_t step = std::max(reach_at(place) / 4, 1);
    const auto to_middle = [&](int32_t i) {
      return std::min(i / step * step + step / 2, side_ - 1);
    };
    const int32_t there = to_middle(place / side_) * side_ + to_middle(place % side_);
    const int32_t from = texel(place);
    const int32_t to = texel(there);
    const bool is_near = from >= 0 && to >= 0 && holds(from, to) &&
                         squared_distance(from, to) < 0.25f * radius_ * radius_;
    return broad_place_near(is_near ? there : place);
  }

  /// Spreads units over the texels within the radius on the map and on the surface, in whole units;
  /// the remainder stays in the middle.
  void add(int32_t place, int64_t units, std::vector<std::pair<int32_t, int64_t>>& gains) {
    const int32_t centre = texel(place);
    const int32_t reach = reach_at(place);
    const float size = std::sqrt(std::max(bare_.area[static_cast<size_t>(centre)], 1e-12f));
    const float range = std::min(radius_, static_cast<float>(reach) * size);
    const int32_t column = place % side_;
    const int32_t row = place / side_;
    parts_.clear();
    double whole = 0.0;
    for (int32_t y = std::max(row - reach, 0); y <= std::min(row + reach, side_ - 1); ++y) {
      for (int32_t x = std::max(column - reach, 0); x <= std::min(column + reach, side_ - 1); ++x) {
        const int32_t own = texel(y * side_ + x);
        if (own < 0) continue;
        const float away = squared_distance(centre, own) / (range * range);
        const auto i = static_cast<size_t>(own);
        if (!(away < 1.0f) || !holds(centre, own)) continue;
        parts_.emplace_back(y * side_ + x, static_cast<double>((1.0f - away) * bare_.area[i]));
        whole += parts_.back().second;
      }
    }
    int64_t rest = units;
    for (const auto& [at, weight] : parts_) {
      const auto own = static_cast<int64_t>(static_cast<double>(units) * (weight / whole));
      gains.emplace_back(at, own);
      rest -= own;
    }
    gains.emplace_back(place, rest);
  }

  /// The texel at a place, -1: none.
  int32_t texel(int32_t place) const { return bare_.texel_of[static_cast<size_t>(place)]; }

 private:
  /// Whether snow that faces as at `facing` may lie on a texel.
  bool holds(int32_t facing, int32_t at) const {
    const float side = bare_.up[static_cast<size_t>(facing)] < 0.0f ? -1.0f : 1.0f;
    return !shared::is_wall(side * bare_.up[static_cast<size_t>(at)]);
  }
  /// A place beside one whose texel is a wall, or only a sliver of surface on which snow would
  /// tower; else the place itself.
  int32_t broad_place_near(int32_t place) const {
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
  /// The radius in texels around a place.
  int32_t reach_at(int32_t place) const {
    const int32_t own = texel(place);
    if (own < 0) return 1;
    const float size = std::sqrt(std::max(bare_.area[static_cast<size_t>(own)], 1e-12f));
    return std::min(kMostTexels, static_cast<int32_t>(std::ceil(radius_ / size)));
  }
  float squared_distance(int32_t a, int32_t b) const {
    const auto i = static_cast<size_t>(a), j = static_cast<size_t>(b);
    const float x = bare_.x[i] - bare_.x[j];
    const float y = bare_.y[i] - bare_.y[j];
    const float z = bare_.z[i] - bare_.z[j];
    return x * x + y * y + z * z;
  }

  const BareTexels& bare_;
  int32_t side_;
  float radius_;
  std::vector<std::pair<int32_t, double>> parts_;
};

}  // namespace

void Landing::lay_out(const SceneRays& rays) {
  // The set of objects, and so their indices, may have changed.
  const LandingState before = state();
  rays_ = &rays;
  names_.clear();
  for (const SceneObject* object : rays.objects()) names_.push_back(object->description.name);
  set_state(before);
}

LandingState Landing::state() const {
  LandingState state{clock_, {}, on_floors_, left_};
  for (const auto& [at, units] : air_) {
    const auto& [time, object, place, is_back] = at;
    state.air.push_back({time, names_[static_cast<size_t>(object)], place, is_back, units});
  }
  return state;
}

void Landing::set_state(const LandingState& state) {
  air_.clear();
  clock_ = state.clock;
  on_floors_ = state.on_floors;
  left_ = state.left;
  for (const FallingSnow& snow : state.air) {
    const auto name = std::lower_bound(names_.begin(), names_.end(), snow.receiver);
    if (name == names_.end() || *name != snow.receiver) {
      left_ += snow.units;
      continue;
    }
    air_[{snow.time, static_cast<int32_t>(name - names_.begin()), snow.place, snow.is_back}] +=
        snow.units;
  }
}

void Landing::arrive(double dt, const LandingSettings& settings, MovingMap& map, Repose& repose) {
  const int64_t until = clock_ + microseconds(dt);
  const auto object = static_cast<int32_t>(map.object);
  std::vector<std::pair<int32_t, int64_t>> landing;
  for (auto at = air_.begin(); at != air_.end() && std::get<0>(at->first) <= until;) {
    if (std::get<1>(at->first) != object) {
      ++at;
      continue;
    }
    landing.emplace_back(std::get<2>(at->first), at->second);
    at = air_.erase(at);
  }
  if (landing.empty()) return;
  const BareTexels& bare = repose.bare();
  Splat splat(bare, settings.heap_grain);
  std::map<int32_t, int64_t> by_place;
  for (const auto& [place, units] : landing) {
    if (splat.texel(place) < 0) {
      left_ += units;
    } else {
      by_place[splat.snapped(place)] += units;
    }
  }
  std::vector<std::pair<int32_t, int64_t>> gains;
  for (const auto& [place, units] : by_place) splat.add(place, units, gains);
  for (const auto& [place, units] : gains) {
    const auto texel = static_cast<size_t>(bare.texel_of[static_cast<size_t>(place)]);
    const auto area = static_cast<double>(bare.area[texel]);
    if (!(area > 0.0)) {
      left_ += units;
      continue;
    }
    float& height = (*map.height)[static_cast<size_t>(place)];
    const bool is_back = height < 0.0f || (height == 0.0f && bare.up[texel] < 0.0f);
    const double before = std::abs(static_cast<double>(height));
    const auto now = static_cast<float>(before + static_cast<double>(units) * kLandingUnit / area);
    map.landed += (static_cast<double>(now) - before) * area;
    height = is_back ? -now : now;
    map.has_changed = true;
  }
}

void Landing::release(const LandingSettings& settings, MovingMap& map, Repose& repose) {
  const SceneObject& object = *rays_->objects()[map.object];
  const auto number = static_cast<int32_t>(map.object);
  int64_t listed = 0;
  double slid = 0.0;
  const auto add = [&](const Release& release) {
    const int64_t units = units_of(release.volume);
    if (units <= 0) return;
    listed += units;
    Exit exit;
    exit.units = units;
    if (release.outlet >= 0) {
      const Outlet outlet =
          outlet_of(repose.ground(), {.number = release.outlet, .texel = release.texel});
      exit.point = outlet.point;
      exit.outwards = outlet.outwards;
    } else if (release.outlet == Release::kInHollow) {
      const std::vector<int32_t>& places =
          map.places != nullptr ? *map.places : repose.table().texel;
      const int32_t place = places[static_cast<size_t>(release.texel)];
      air_[{clock_, number, place, false}] += units;
      return;
    } else {
      const TexelNow texel = texel_now(object, repose.table(), release.texel);
      exit.point = texel.point;
      if (release.outlet == Release::kThrough) exit.point.z -= kBelowSurface;
      const double flat = glm::length(glm::dvec2(texel.normal));
      if (flat > 0.0 && release.outlet == Release::kOffWall)
        exit.outwards = glm::dvec2(texel.normal) / flat;
    }
    for (int axis = 0; axis < 3; ++axis) {
      exit.key[static_cast<size_t>(axis)] =
          static_cast<int64_t>(std::floor(exit.point[axis] / settings.heap_grain));
    }
    Exit& cell = exits_[exit.key];
    const auto weight = static_cast<double>(units);
    if (cell.units == 0) cell.object = number;
    cell.units += units;
    cell.point += weight * exit.point;
    cell.outwards += weight * exit.outwards;
  };
  for (const Release& release : repose.take_releases()) add(release);
  const bool any_slid = !map.slid_from.empty() || !map.shed_from.empty();
  std::vector<double> over(any_slid ? repose.ground().outlet_count() : 0, 0.0);
  std::vector<int32_t> texel_over(over.size(), -1);
  const auto leave = [&](int32_t place, float volume, bool is_shed) {
    const int32_t texel = repose.bare().texel_of[static_cast<size_t>(place)];
    Release release = way_down(repose.ground(), texel);
    release.volume = static_cast<double>(volume);
    slid += release.volume;
    if (release.outlet >= 0) {
      over[static_cast<size_t>(release.outlet)] += release.volume;
      texel_over[static_cast<size_t>(release.outlet)] = release.texel;
    } else if (is_shed && release.outlet == Release::kInHollow) {
      // A level leaf or a bowl does not keep it.
      add({Release::kThrough, texel, release.volume});
    } else if (release.texel == texel && release.outlet == Release::kInHollow) {
      // It has nowhere to slide to.
      float& height = (*map.height)[static_cast<size_t>(place)];
      const auto area = static_cast<double>(repose.bare().area[static_cast<size_t>(texel)]);
      const float before = std::abs(height);
      const auto now = static_cast<float>(static_cast<double>(before) + release.volume / area);
      const double kept = static_cast<double>(now - before) * area;
      height = height < 0.0f ? -now : now;
      map.slid -= kept;
      map.has_changed = true;
    } else {
      add(release);
    }
  };
  for (const auto& [place, volume] : map.slid_from) leave(place, volume, false);
  for (const auto& [place, volume] : map.shed_from) leave(place, volume, true);
  for (size_t i = 0; i < over.size(); ++i) {
    if (over[i] > 0.0) add({static_cast<int32_t>(i), texel_over[i], over[i]});
  }
  // What is too little for a unit, and what rounding of heights and areas adds or takes.
  left_ += units_of(map.slid + slid) - listed;
}

/// What leaves each cube, at the mean point, in a fixed order.
std::vector<Landing::Exit> Landing::merged() {
  std::vector<Exit> merged;
  for (const auto& [key, sum] : exits_) {
    merged.push_back(sum);
    Exit& cell = merged.back();
    cell.key = key;
    cell.point /= static_cast<double>(sum.units);
    const double length = glm::length(sum.outwards);
    cell.outwards = length > 0.0 ? sum.outwards / length : glm::dvec2(0.0);
  }
  exits_.clear();
  std::sort(merged.begin(), merged.end(),
            [](const Exit& a, const Exit& b) { return a.key < b.key; });
  return merged;
}

/// Follows a cell's snow to the ground, along several rays if it spreads by more than its grain.
void Landing::trace(const Exit& cell, uint32_t step_number, const LandingSettings& settings,
                    std::vector<Landed>& landed) const {
  const auto follow = [&](const glm::dvec2& disc, double speed) {
    Landed result;
    glm::dvec3 at = cell.point + glm::dvec3(cell.outwards * kOutside, 0.0);
    const glm::dvec2 velocity = cell.outwards * (settings.throw_speed * speed);
    for (int piece = 0; piece <= kPieces; ++piece) {
      const double from = kThrownSeconds * piece / kPieces;
      const bool is_last = piece == kPieces;
      const double to = is_last ? 1e2 : kThrownSeconds * (piece + 1) / kPieces;
      const double drop = 0.5 * kGravity * (to * to - from * from);
      const glm::dvec2 aside = (is_last ? glm::dvec2(0.0) : velocity * (to - from)) + disc * drop;
      const glm::dvec3 move(aside, -drop);
      const double length = glm::length(move);
      const SurfaceHit hit = first_ground(*rays_, at, move / length, length);
      if (hit.object >= 0) {
        const double z = at.z + hit.distance / length * move.z;
        result.point = map_point(*rays_->objects()[static_cast<size_t>(hit.object)], hit, z);
        result.drop = std::max(cell.point.z - z, 0.0);
        result.aside = glm::dvec2(at + (hit.distance / length) * move - cell.point);
        return result;
      }
      at += move;
      result.aside = glm::dvec2(at - cell.point);
    }
    // Beyond the scene it is followed for a while only.
    result.aside *= kLeaves / 1e2;
    result.drop = 0.5 * kGravity * kLeaves * kLeaves;
    return result;
  };
  Landed straight = follow({0.0, 0.0}, 1.0);
  if (straight.point.object < 0 || straight.drop * settings.spread < 0.5 * settings.heap_grain) {
    straight.units = cell.units;
    landed.push_back(straight);
    return;
  }
  for (int ray = 0; ray < kRays; ++ray) {
    // Stratified in radius.
    const double u = (ray + hashed(cell.key, step_number, ray, 1)) / kRays;
    const double turn = 2.0 * std::numbers::pi * hashed(cell.key, step_number, ray, 2);
    const glm::dvec2 disc =
        settings.spread * std::sqrt(u) * glm::dvec2(std::cos(turn), std::sin(turn));
    Landed one = follow(disc, std::sqrt(0.5 + u));
    one.units = cell.units / kRays + (ray < cell.units % kRays ? 1 : 0);
    landed.push_back(one);
  }
}

void Landing::fall(uint32_t step_number, double dt, const LandingSettings& settings,
                   std::vector<FlyingSnow>* flying) {
  clock_ += microseconds(dt);
  const std::vector<Exit> falling = merged();
  std::vector<std::vector<Landed>> landed(falling.size());
  base::for_each_item(falling.size(), 4,
                      [&](size_t i) { trace(falling[i], step_number, settings, landed[i]); });
  for (size_t i = 0; i < falling.size(); ++i) {
    int ray = 0;
    for (const Landed& snow : landed[i]) {
      const double falls = std::sqrt(2.0 * snow.drop / kGravity);
      if (flying != nullptr && falls > kShortest) {
        add_flight({falling[i].object, glm::vec3(falling[i].point),
                    glm::vec3(glm::dvec3(snow.aside / falls, 0.0)),
                    static_cast<float>(static_cast<double>(snow.units) * kLandingUnit),
                    static_cast<float>(falls)},
                   {falling[i].key, step_number, ray++}, dt, *flying);
      }
      if (snow.point.object < 0) {
        left_ += snow.units;
      } else if (snow.point.place < 0) {
        on_floors_ += snow.units;
      } else {
        air_[{clock_ + microseconds(std::min(falls, settings.longest_fall)), snow.point.object,
              snow.point.place, snow.point.is_back}] += snow.units;
      }
    }
  }
}

}  // namespace snowbough::snow
