#include "snow/movement/melt/water.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <numbers>

#include "base/parallel_for.h"
#include "base/simd.h"
#include "shaders/lib/texel_repose.h"
#include "snow/movement/melt/linked_runs.h"
#include "snow/movement/melt/texel_runs.h"

namespace snowbough::snow {
namespace {

/// Density of water in kg/m3.
constexpr double kWaterDensity = 1000.0;
/// The most that texels across a seam exchange of their difference in a step, and the largest
/// radius in texels over which water spreads.
constexpr double kExchange = 0.2;
constexpr double kWidest = 64.0;
/// Metres from an edge at which drops fall.
constexpr double kDropsOutside = 0.01;
/// Drying under snow relative to bare ground in the open; and without sun.
constexpr float kUnderSnow = 0.33f;
constexpr float kInShade = 0.3f;
/// Thinner water is dry, in metres.
constexpr float kDry = 1e-7f;

/// Adds water that comes with melted snow and rain. `melted`, `rain`: null: none.
SNOWBOUGH_WIDE void add_water(const float* __restrict melted, double density,
                              const float* __restrict rain, double rains, size_t count,
                              float* __restrict depth) {
  for (size_t i = 0; melted != nullptr && rain == nullptr && i < count; ++i) {
    depth[i] += static_cast<float>(static_cast<double>(melted[i]) * density);
  }
  for (size_t i = 0; melted == nullptr && rain != nullptr && i < count; ++i) {
    depth[i] += static_cast<float>(rains * static_cast<double>(rain[i]));
  }
  for (size_t i = 0; melted != nullptr && rain != nullptr && i < count; ++i) {
    depth[i] += static_cast<float>(static_cast<double>(melted[i]) * density +
                                   rains * static_cast<double>(rain[i]));
  }
}

/// The volume of a part of the water.
SNOWBOUGH_WIDE void take_part(const float* __restrict depth, const float* __restrict area,
                              float part, size_t count, float* __restrict volume) {
  for (size_t i = 0; i < count; ++i) volume[i] = part * depth[i] * area[i];
}

/// Puts it back after it has spread.
SNOWBOUGH_WIDE void give_back(const float* __restrict volume, const float* __restrict area,
                              float part, size_t count, float* __restrict depth) {
  for (size_t i = 0; i < count; ++i) {
    const bool takes = area[i] > 0.0f;
    const float change = volume[i] / (takes ? area[i] : 1.0f) - part * depth[i];
    depth[i] += takes ? change : 0.0f;
  }
}

/// Lets water dry. `decay`: for bare ground under the open sky; `sun`: null: none.
SNOWBOUGH_WIDE void dry_run(const float* __restrict height, const float* __restrict sun,
                            float decay, size_t count, float* __restrict depth) {
  const auto dry = [&](size_t i, float shines) {
    const float bare = kInShade + (1.0f - kInShade) * std::min(shines, 1.0f);
    const float left = depth[i] / (1.0f + decay * (height[i] != 0.0f ? kUnderSnow : bare));
    depth[i] = left < kDry ? 0.0f : left;
  };
  for (size_t i = 0; sun != nullptr && i < count; ++i) dry(i, sun[i]);
  for (size_t i = 0; sun == nullptr && i < count; ++i) dry(i, 0.0f);
}

}  // namespace

void Water::lay_out(const SceneRays& rays) {
  rays_ = &rays;
  films_.assign(rays.objects().size(), {});
  drips_.clear();
}

void Water::forget_pose(size_t object) {
  films_[object].next.clear();
  films_[object].area.clear();
  // Drops may fall onto any object.
  for (Film& own : films_) own.targets.clear();
}

void Water::find_ways(size_t object, Repose& repose) {
  Film& own = films_[object];
  if (!own.next.empty()) return;
  const BareTexels& bare = repose.bare();
  const size_t count = bare.x.size();
  own.next.assign(count, kStays);
  base::for_each_item(count, 1024, [&](size_t i) {
    const auto texel = static_cast<int32_t>(i);
    const int32_t next = next_down(repose.ground(), texel, true);
    own.next[i] = next == texel ? kStays : next < 0 ? next - 1 : next;
  });
  // Texels without others above them first.
  std::vector<int32_t> above(count, 0);
  for (const int32_t next : own.next) {
    if (next >= 0) ++above[static_cast<size_t>(next)];
  }
  own.order.clear();
  for (size_t i = 0; i < count; ++i) {
    if (above[i] == 0) own.order.push_back(static_cast<int32_t>(i));
  }
  for (size_t k = 0; k < own.order.size(); ++k) {
    const int32_t next = own.next[static_cast<size_t>(own.order[k])];
    if (next >= 0 && --above[static_cast<size_t>(next)] == 0) own.order.push_back(next);
  }
  // Water stays on level ground and in hollows.
  std::erase_if(own.order, [&](int32_t texel) {
    const auto i = static_cast<size_t>(texel);
    return own.next[i] == kStays && !(bare.up[i] < shared::kWallUp);
  });
}

/// Spreads water to all sides, in a step as far as diffusion would: a part of it, which is
/// returned, to `spread_` as volumes.
float Water::soak_sideways(const MeltSettings& settings, double dt, const LinkedRuns& runs,
                           const std::vector<int32_t>& places, const ReposeLinks& links,
                           double area, Film& own) {
  if (!(area > 0.0)) return 0.0f;
  // Mean square of the way along an axis in texels, and that of the spread over a square.
  const double wanted =
      settings.wet_spread * settings.wet_spread * dt * static_cast<double>(own.area.size()) / area;
  if (!(wanted > 0.0)) return 0.0f;
  for (const ReposeLinks::Across& across : links.across) {
    const auto a = static_cast<size_t>(across.a), b = static_cast<size_t>(across.b);
    const float smaller = std::min(own.area[a], own.area[b]);
    if (!(smaller > 0.0f)) continue;
    const auto exchange = static_cast<float>(std::min(0.5 * wanted, kExchange));
    const float flow = exchange * (own.depth[a] - own.depth[b]) * smaller;
    own.depth[a] -= flow / own.area[a];
    own.depth[b] += flow / own.area[b];
  }
  const double wide = std::ceil(0.5 * (std::sqrt(12.0 * wanted + 1.0) - 1.0));
  const auto radius = static_cast<int32_t>(std::min(wide, kWidest));
  const double side = 2.0 * radius + 1.0;
  const auto part = static_cast<float>(std::min(12.0 * wanted / (side * side - 1.0), 1.0));
  std::vector<float>& spread = spread_;
  spread.resize(own.depth.size());
  for_texel_runs(places, [&](size_t begin, size_t, size_t count) {
    take_part(&own.depth[begin], &own.area[begin], part, count, &spread[begin]);
  });
  runs.spread(radius, spread);
  return part;
}

/// Where water that leaves over an outlet, or drips from a texel (-1 - texel), lands.
MapPoint Water::below(size_t object, int32_t from, int32_t texel, Repose& repose) const {
  glm::dvec3 point;
  if (from >= 0) {
    const Outlet outlet = outlet_of(repose.ground(), {.number = from, .texel = texel});
    point = outlet.point + glm::dvec3(outlet.outwards * kDropsOutside, 0.0);
  } else {
    const SceneObject& own = *rays_->objects()[object];
    const TexelNow now = texel_now(own, *own.table, own.positions, texel);
    point = now.point + now.normal * kDropsOutside;
  }
  const RayHit hit = first_ground(*rays_, point, {0.0, 0.0, -1.0}, 1e4);
  if (hit.object < 0) return {};
  return map_point(*rays_->objects()[static_cast<size_t>(hit.object)], hit, point.z - hit.distance);
}

void Water::run_down(const MeltSettings& settings, size_t object, Repose& repose) {
  Film& own = films_[object];
  const auto soak = static_cast<float>(settings.soak);
  for (const int32_t texel : own.order) {
    const auto i = static_cast<size_t>(texel);
    const float over = own.depth[i] - soak;
    if (!(over > 0.0f)) continue;
    const int32_t next = own.next[i];
    const double volume = static_cast<double>(over) * static_cast<double>(own.area[i]);
    own.depth[i] = soak;
    if (next >= 0 && own.area[static_cast<size_t>(next)] > 0.0f) {
      own.depth[static_cast<size_t>(next)] +=
          static_cast<float>(volume / static_cast<double>(own.area[static_cast<size_t>(next)]));
      continue;
    }
    const int32_t from = next <= -2 ? -2 - next : -1 - texel;
    const auto [known, is_new] = own.targets.try_emplace(from);
    if (is_new) known->second = below(object, from, texel, repose);
    drips_.push_back({known->second.object, known->second.place, volume});
  }
}

void Water::flow(const MeltSettings& settings, double dt, const std::vector<float>& melted,
                 const std::vector<float>* sun, const std::vector<float>* rain,
                 const MovingMap& map, Repose& repose, const LinkedRuns& runs) {
  Film& own = films_[map.object];
  const std::vector<int32_t>& places = rays_->objects()[map.object]->table->texel;
  const bool rains = settings.rain > 0.0 && rain != nullptr;
  if (own.area.empty()) own.area = repose.bare().area;
  if (own.depth.empty()) {
    if (melted.empty() && !rains) return;
    own.depth.assign(places.size(), 0.0f);
  }
  find_ways(map.object, repose);
  for_texel_runs(places, [&](size_t texel, size_t place, size_t count) {
    add_water(melted.empty() ? nullptr : &melted[texel], settings.density / kWaterDensity,
              rains ? &(*rain)[place] : nullptr, settings.rain, count, &own.depth[texel]);
  });
  run_down(settings, map.object, repose);
  const float part =
      soak_sideways(settings, dt, runs, places, repose.links(), repose.bare().whole_area, own);
  const auto decay = static_cast<float>(std::numbers::ln2 * dt / settings.drying);
  for_texel_runs(places, [&](size_t texel, size_t place, size_t count) {
    if (part > 0.0f) {
      give_back(&spread_[texel], &own.area[texel], part, count, &own.depth[texel]);
    }
    dry_run(&(*map.height)[place], sun != nullptr ? &(*sun)[place] : nullptr, decay, count,
            &own.depth[texel]);
  });
}

void Water::drip(bool lands) {
  for (const Drip& drop : drips_) {
    Film* const own =
        lands && drop.object >= 0 ? &films_[static_cast<size_t>(drop.object)] : nullptr;
    const int32_t texel =
        own == nullptr || drop.place < 0
            ? -1
            : texel_at(*rays_->objects()[static_cast<size_t>(drop.object)]->table, drop.place);
    if (texel < 0 || own->area.empty() || !(own->area[static_cast<size_t>(texel)] > 0.0f)) continue;
    if (own->depth.empty()) own->depth.assign(own->area.size(), 0.0f);
    own->depth[static_cast<size_t>(texel)] += static_cast<float>(
        drop.volume / static_cast<double>(own->area[static_cast<size_t>(texel)]));
  }
  drips_.clear();
}

std::vector<float> Water::state(size_t object) const {
  const Film& own = films_[object];
  if (own.depth.empty()) return {};
  const TexelTable& table = *rays_->objects()[object]->table;
  const auto side = static_cast<size_t>(table.resolution);
  std::vector<float> plane(side * side, 0.0f);
  for (size_t i = 0; i < table.texel.size(); ++i) {
    plane[static_cast<size_t>(table.texel[i])] = own.depth[i];
  }
  return plane;
}

void Water::set_state(size_t object, const std::vector<float>* plane) {
  std::vector<float>& depth = films_[object].depth;
  depth.clear();
  if (plane == nullptr) return;
  for (const int32_t place : rays_->objects()[object]->table->texel) {
    depth.push_back((*plane)[static_cast<size_t>(place)]);
  }
}

}  // namespace snowbough::snow
