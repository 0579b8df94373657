#include "snow/movement/landing.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "base/parallel_for.h"
#include "shaders/lib/texel_repose.h"
#include "snow/movement/hashed.h"
#include "snow/movement/splat.h"

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

int64_t units_of(double volume) {
  return std::llround(volume / kLandingUnit);
}

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

void Landing::arrive(double dt, const LandingSettings& settings,
                     const std::vector<MovingMap*>& maps,
                     const std::function<Repose&(size_t)>& repose_of) {
  const int64_t until = clock_ + microseconds(dt);
  std::vector<std::vector<std::pair<int32_t, int64_t>>> landing(maps.size());
  std::vector<size_t> map_of(names_.size(), maps.size());
  for (size_t i = 0; i < maps.size(); ++i) map_of[maps[i]->object] = i;
  for (auto at = air_.begin(); at != air_.end() && std::get<0>(at->first) <= until;) {
    const size_t map = map_of[static_cast<size_t>(std::get<1>(at->first))];
    if (map == maps.size()) {
      ++at;
      continue;
    }
    landing[map].emplace_back(std::get<2>(at->first), at->second);
    at = air_.erase(at);
  }
  std::vector<int64_t> left(maps.size(), 0);
  base::for_each_item(maps.size(), 1, [&](size_t i) {
    if (landing[i].empty()) return;
    Repose& repose = repose_of(maps[i]->object);
    Splat splat(repose.bare(), repose.table(), settings.heap_grain);
    std::map<int32_t, int64_t> by_place;
    for (const auto& [place, units] : landing[i]) {
      if (splat.texel(place) < 0) {
        left[i] += units;
      } else {
        by_place[splat.snapped(place)] += units;
      }
    }
    for (const auto& [place, units] : by_place) left[i] += splat.add(place, units, *maps[i]);
  });
  for (const int64_t units : left) left_ += units;
}

void Landing::release(const LandingSettings& settings, const std::vector<Release>& released,
                      MovingMap& map, Repose& repose) {
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
      const TexelNow texel = texel_now(object, repose.table(), object.positions, release.texel);
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
  for (const Release& release : released) add(release);
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
      const RayHit hit = first_ground(*rays_, at, move / length, length);
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
