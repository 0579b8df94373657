#include "snow/movement/coarse_map.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>
#include <iterator>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "base/parallel_for.h"
#include "base/simd.h"
#include "shaders/lib/texel_repose.h"
#include "snow/movement/rays/map_point.h"

namespace snowbough::snow {
namespace {

/// Texels need not be smaller, in metres; nor than this part of the depth, and of the depth of
/// grains: across more texels their heaps come to rest less round.
constexpr double kFinest = 2e-3;
constexpr double kTexelsADepth = 24.0;
constexpr double kTexelsAHeap = 12.0;
/// Squares of more texels a side hold too little of the surface's shape.
constexpr int32_t kMaxSide = 16;
/// Squares whose upward parts of the normals differ by more are on two sides of an edge.
constexpr float kEdge = 0.2f;
constexpr size_t kRun = 4096;
/// Of so many rows of a map one shows how thick its snow is.
constexpr size_t kRowsApart = 4;

/// Sums of the squares and of the cubes of thicknesses.
struct PowerSums {
  double squares = 0.0, cubes = 0.0;
};

/// Those of a row, in as many parts as a wide register holds.
SNOWBOUGH_WIDE PowerSums add_powers(const float* height, size_t count) {
  constexpr size_t kLanes = 16;
  float squares[kLanes] = {};
  float cubes[kLanes] = {};
  const size_t whole = count / kLanes * kLanes;
  for (size_t i = 0; i < whole; i += kLanes) {
    for (size_t k = 0; k < kLanes; ++k) {
      const float square = height[i + k] * height[i + k];
      squares[k] += square;
      cubes[k] += square * std::abs(height[i + k]);
    }
  }
  for (size_t i = whole; i < count; ++i) {
    squares[0] += height[i] * height[i];
    cubes[0] += height[i] * height[i] * std::abs(height[i]);
  }
  PowerSums sums;
  for (size_t k = 0; k < kLanes; ++k) {
    sums.squares += static_cast<double>(squares[k]);
    sums.cubes += static_cast<double>(cubes[k]);
  }
  return sums;
}

/// The depth of a map's thickest snow, in metres: the mean weighted by its square, which a single
/// high texel does not change.
double thickest(const std::vector<float>& height, int32_t side) {
  const auto columns = static_cast<size_t>(side);
  std::vector<PowerSums> rows((columns + kRowsApart - 1) / kRowsApart);
  base::for_each_item(rows.size(), 128, [&](size_t i) {
    rows[i] = add_powers(&height[kRowsApart * i * columns], columns);
  });
  PowerSums all;
  for (const PowerSums& row : rows) {
    all.squares += row.squares;
    all.cubes += row.cubes;
  }
  return all.squares > 0.0 ? all.cubes / all.squares : 0.0;
}

/// The longer and the shorter side of a texel in the pose at rest: the means of their fourth powers
/// over the surface, which long texels decide.
glm::dvec2 texel_size_of(const SceneObject& object) {
  const MapTopology& topology = object.description.topology;
  const std::vector<glm::vec3>& rest =
      object.description.rest.empty() ? object.positions : object.description.rest;
  double area = 0.0;
  glm::dvec2 powers(0.0);
  for (size_t t = 0; t + 2 < topology.triangles.size(); t += 3) {
    const auto corner = [&](size_t k) {
      return glm::dvec3(rest[static_cast<size_t>(topology.triangles[t + k])]);
    };
    const glm::dvec3 a = corner(1) - corner(0);
    const glm::dvec3 b = corner(2) - corner(0);
    const glm::dvec2 u = topology.corner_uv[t + 1] - topology.corner_uv[t];
    const glm::dvec2 v = topology.corner_uv[t + 2] - topology.corner_uv[t];
    const double cross = u.x * v.y - u.y * v.x;
    if (cross == 0.0) continue;
    const glm::dvec3 along_u = (a * v.y - b * u.y) / cross;
    const glm::dvec3 along_v = (b * u.x - a * v.x) / cross;
    const double half = 0.5 * (glm::dot(along_u, along_u) + glm::dot(along_v, along_v));
    const double apart = std::sqrt(std::max(
        0.0, half * half - glm::dot(glm::cross(along_u, along_v), glm::cross(along_u, along_v))));
    const glm::dvec2 squares(half + apart, half - apart);
    const double own = 0.5 * glm::length(glm::cross(a, b));
    area += own;
    powers += own * squares * squares;
  }
  const double size = 1.0 / topology.resolution;
  return area > 0.0 ? size * glm::sqrt(glm::sqrt(powers / area)) : glm::dvec2(0.0);
}

/// The slope between two that follow each other: their mean, but not beyond what either allows
/// (the monotonised central limiter: B. van Leer, Towards the ultimate conservative difference
/// scheme III, 1977). 0 at a crest.
float slope_between(float a, float b) {
  if (!(a * b > 0.0f)) return 0.0f;
  const float least = 2.0f * std::min(std::abs(a), std::abs(b));
  return std::copysign(std::min(least, 0.5f * std::abs(a + b)), a);
}

}  // namespace

std::unique_ptr<CoarseMap> CoarseMap::make(const SceneObject& object, int32_t side,
                                           ReposeLinkTables& tables, const SceneRays& rays) {
  std::optional<CoarseTexels> texels = join_texels(*object.table, side);
  if (!texels) return nullptr;
  auto table = std::make_unique<const TexelTable>(std::move(texels->table));
  return std::unique_ptr<CoarseMap>(
      new CoarseMap(object, std::move(*texels), std::move(table), tables, rays));
}

CoarseMap::CoarseMap(const SceneObject& object, CoarseTexels texels,
                     std::unique_ptr<const TexelTable> table, ReposeLinkTables& tables,
                     const SceneRays& rays)
    : object_(&object),
      texels_(std::move(texels)),
      repose_(object, tables, &rays, std::move(table)) {
  const auto side = static_cast<size_t>(repose_.table().resolution);
  height_.assign(side * side, 0.0f);
  for (const int32_t texel : texels_.middle) {
    places_.push_back(object.table->texel[static_cast<size_t>(texel)]);
  }
}

void CoarseMap::forget_pose() {
  repose_.forget_pose();
  has_areas_ = false;
}

void CoarseMap::update_areas() {
  if (has_areas_) return;
  has_areas_ = true;
  ReposeSurface surface;
  surface.set_pose(*object_, *object_->table, object_->positions, false);
  const size_t count = object_->table->texel.size();
  area_.resize(count);
  up_.resize(count);
  normal_z_.resize(count);
  base::for_each_item((count + kRun - 1) / kRun, 1, [&](size_t run) {
    std::vector<float> rest(4 * kRun);
    std::vector<uint8_t> two_sided(kRun);
    const size_t begin = run * kRun;
    const auto plane = [&](size_t i) { return rest.data() + i * kRun; };
    surface.texels(static_cast<int32_t>(begin), static_cast<int32_t>(std::min(kRun, count - begin)),
                   {plane(0), plane(1), plane(2), &normal_z_[begin], &up_[begin], &area_[begin],
                    plane(3), two_sided.data()});
  });
  square_area_.resize(texels_.middle.size());
  square_up_.resize(height_.size());
  base::for_each_item(square_area_.size(), kRun, [&](size_t i) {
    double area = 0.0;
    double level = 0.0;
    for (int32_t t = texels_.begin[i]; t < texels_.begin[i + 1]; ++t) {
      const auto texel = static_cast<size_t>(texels_.texel[static_cast<size_t>(t)]);
      area += static_cast<double>(area_[texel]);
      level += static_cast<double>(area_[texel]) * static_cast<double>(up_[texel]);
    }
    square_area_[i] = area;
    square_up_[static_cast<size_t>(repose_.table().texel[i])] =
        area > 0.0 ? static_cast<float>(level / area) : 0.0f;
  });
}

void CoarseMap::block(const std::vector<int32_t>& texels) {
  if (texels.empty() && blocked_.empty()) return;
  const ReposeLinks& links = *repose_.ground().links;
  std::vector<int32_t> places;
  for (const int32_t texel : texels) {
    const auto square = static_cast<size_t>(texels_.parent[static_cast<size_t>(texel)]);
    places.push_back(repose_.table().texel[square]);
  }
  std::sort(places.begin(), places.end());
  places.erase(std::unique(places.begin(), places.end()), places.end());
  stand_.resize(height_.size(), 0.0f);
  std::vector<int32_t> changed;
  std::set_symmetric_difference(blocked_.begin(), blocked_.end(), places.begin(), places.end(),
                                std::back_inserter(changed));
  for (const int32_t place : blocked_) stand_[static_cast<size_t>(place)] = 0.0f;
  for (const int32_t place : places) stand_[static_cast<size_t>(place)] = Repose::kBarrier;
  std::vector<uint8_t> changes(links.block_count(), 0);
  for (const int32_t place : changed) changes[static_cast<size_t>(links.block_of(place))] = 1;
  blocked_ = std::move(places);
  repose_.set_stand(blocked_.empty() ? nullptr : &stand_, changes);
}

std::vector<int32_t> CoarseMap::blocks_of_own() const {
  const auto blocks_a_side = [](int32_t resolution) {
    return (resolution + kReposeBlock - 1) / kReposeBlock;
  };
  const int32_t own = blocks_a_side(object_->table->resolution);
  const int32_t coarse = blocks_a_side(repose_.table().resolution);
  const int32_t side = object_->table->resolution / repose_.table().resolution;
  std::vector<int32_t> blocks;
  for (int32_t b = 0; b < own * own; ++b) {
    blocks.push_back(b / own / side * coarse + b % own / side);
  }
  return blocks;
}

std::vector<int32_t> CoarseMap::blocks_with_released(const MovingMap& map) {
  const ReposeLinks& links = *repose_.ground().links;
  std::vector<int32_t> blocks;
  for (const auto* released : {&map.slid_from, &map.shed_from}) {
    for (const auto& [place, volume] : *released) {
      const auto texel = static_cast<size_t>(texel_at(*object_->table, place));
      const auto square = static_cast<size_t>(texels_.parent[texel]);
      blocks.push_back(links.block_of(repose_.table().texel[square]));
    }
  }
  return near_blocks(links, blocks);
}

/// Calls visit(first, last) for the squares where snow may move, in runs, on all cores.
template <typename Visit>
void CoarseMap::for_squares(const Visit& visit) const {
  const std::vector<int32_t>& squares = repose_.table().texel;
  if (blocks_) {
    base::for_each_item(blocks_->size(), 1, [&](size_t i) {
      repose_.links().for_runs((*blocks_)[i], squares, [&](int32_t first, int32_t count, size_t) {
        visit(static_cast<size_t>(first), static_cast<size_t>(first + count));
      });
    });
    return;
  }
  base::for_each_item((squares.size() + kRun - 1) / kRun, 1, [&](size_t run) {
    visit(run * kRun, std::min(squares.size(), (run + 1) * kRun));
  });
}

void CoarseMap::join_square(size_t square, const std::vector<float>& height) {
  const std::vector<int32_t>& places = object_->table->texel;
  double volume = 0.0;
  double signed_volume = 0.0;
  for (int32_t t = texels_.begin[square]; t < texels_.begin[square + 1]; ++t) {
    const auto own = static_cast<size_t>(texels_.texel[static_cast<size_t>(t)]);
    const double held = static_cast<double>(height[static_cast<size_t>(places[own])]) *
                        static_cast<double>(area_[own]);
    volume += std::abs(held);
    signed_volume += held;
  }
  const float mean = volume > 0.0 ? static_cast<float>(volume / square_area_[square]) : 0.0f;
  const auto at = static_cast<size_t>(repose_.table().texel[square]);
  // Snow on both sides of a sheet lies on the side of most.
  before_[at] = height_[at] = signed_volume < 0.0 ? -mean : mean;
}

MovingMap CoarseMap::begin(const MovingMap& map, const std::vector<int32_t>* blocks) {
  update_areas();
  const std::vector<int32_t>& squares = repose_.table().texel;
  before_.resize(height_.size());
  blocks_.reset();
  if (blocks != nullptr) blocks_ = *blocks;
  for_squares([&](size_t first, size_t last) {
    for (size_t i = first; i < last; ++i) join_square(i, *map.height);
  });
  MovingMap moved;
  moved.object = map.object;
  moved.height = &height_;
  moved.places = &places_;
  const auto join = [&](const std::vector<std::pair<int32_t, float>>& parts) {
    std::vector<std::pair<int32_t, float>> joined;
    std::vector<float> sum(parts.empty() ? 0 : squares.size(), 0.0f);
    for (const auto& [place, volume] : parts) {
      const auto texel = static_cast<size_t>(texel_at(*object_->table, place));
      sum[static_cast<size_t>(texels_.parent[texel])] += volume;
    }
    for (size_t i = 0; i < sum.size(); ++i) {
      if (sum[i] > 0.0f) joined.emplace_back(squares[i], sum[i]);
    }
    return joined;
  };
  moved.slid_from = join(map.slid_from);
  moved.shed_from = join(map.shed_from);
  return moved;
}

glm::vec2 CoarseMap::slope_at(int32_t place) const {
  const ReposeLinks& links = repose_.links();
  const int32_t side = links.resolution;
  const int32_t column = place % side;
  const int32_t row = place / side;
  const auto is_linked = [&](int32_t x, int32_t y, int32_t k) {
    if (x < 0 || y < 0 || ((links.forward[static_cast<size_t>(links.cell_at(x, y))] >> k) & 1) == 0)
      return false;
    // Over an edge of the surface thicknesses are measured in two directions.
    const int32_t other =
        place + (x == column && y == row ? 1 : -1) * (kForwardRow[k] * side + kForwardColumn[k]);
    return std::abs(square_up_[static_cast<size_t>(place)] -
                    square_up_[static_cast<size_t>(other)]) < kEdge;
  };
  const auto height = [&](int32_t at) { return std::abs(height_[static_cast<size_t>(at)]); };
  glm::vec2 slope(0.0f);
  for (int32_t k = 0; k < 2; ++k) {
    const int32_t step = kForwardRow[k] * side + kForwardColumn[k];
    const bool has_next = is_linked(column, row, k);
    const bool has_last = is_linked(column - kForwardColumn[k], row - kForwardRow[k], k);
    const float next = has_next ? height(place + step) - height(place) : 0.0f;
    const float last = has_last ? height(place) - height(place - step) : 0.0f;
    // Towards bare ground it goes on as it comes.
    if (has_next && has_last && height(place + step) == 0.0f && last < 0.0f) {
      slope[k] = last;
    } else if (has_next && has_last && height(place - step) == 0.0f && next > 0.0f) {
      slope[k] = next;
    } else {
      slope[k] = has_next && has_last ? slope_between(next, last) : next + last;
    }
  }
  return slope;
}

/// A texel of a square: its place and area, the upward part of its normal, as in TileGround, and by
/// how much the snow's slope lifts it above the square's middle, in metres.
struct CoarseMap::Part {
  size_t place = 0;
  double area = 0.0;
  double up = 1.0;
  double rise = 0.0;
};

/// Spreads the snow that a square holds now over its texels, along its slope; returns whether any
/// has changed.
bool CoarseMap::spread(size_t square, std::vector<float>& height, std::vector<Part>& parts) const {
  const int32_t place = repose_.table().texel[square];
  const auto at = static_cast<size_t>(place);
  if (height_[at] == before_[at]) return false;
  const int32_t resolution = object_->table->resolution;
  const int32_t coarse = repose_.table().resolution;
  const int32_t side = resolution / coarse;
  const float sign = height_[at] < 0.0f ? -1.0f : 1.0f;
  const glm::dvec2 slope(slope_at(place));
  const auto metres = [](float signed_height) {
    return static_cast<double>(std::abs(signed_height));
  };
  double volume = (metres(height_[at]) - metres(before_[at])) * square_area_[square];
  double on_walls = 0.0;
  const auto for_texels = [&](const auto& visit) {
    for (int32_t t = texels_.begin[square]; t < texels_.begin[square + 1]; ++t) {
      const auto texel = static_cast<size_t>(texels_.texel[static_cast<size_t>(t)]);
      visit(texel, static_cast<size_t>(object_->table->texel[texel]));
    }
  };
  parts.clear();
  for_texels([&](size_t texel, size_t own) {
    const auto area = static_cast<double>(area_[texel]);
    volume += metres(height[own]) * area;
    if (shared::is_wall(sign * up_[texel])) {
      on_walls += metres(height[own]) * area;
      return;
    }
    const auto number = static_cast<int32_t>(own);
    const glm::dvec2 way = (glm::dvec2(number % resolution - place % coarse * side,
                                       number / resolution - place / coarse * side) +
                            0.5) /
                               static_cast<double>(side) -
                           0.5;
    // Texels far outside the square's own place lie at its middle.
    const bool is_inside = std::max(std::abs(way.x), std::abs(way.y)) < 1.0;
    parts.push_back({own, area,
                     std::max(static_cast<double>(sign * normal_z_[texel]),
                              static_cast<double>(shared::kWallUp)),
                     is_inside ? glm::dot(slope, way) : 0.0});
  });
  // Walls keep what sticks to them, unless there is nothing else.
  if (parts.empty() || on_walls > volume) {
    on_walls = 0.0;
    parts.clear();
    for_texels([&](size_t texel, size_t own) {
      parts.push_back({own, static_cast<double>(area_[texel]), 1.0, 0.0});
    });
  }
  volume = height_[at] == 0.0f ? 0.0 : std::max(volume - on_walls, 0.0);
  const double thickness = fill_height(parts, volume);
  for (const Part& part : parts) {
    const auto now = static_cast<float>(std::max(thickness * part.up + part.rise, 0.0));
    // No zero is negative.
    height[part.place] = volume > 0.0 && now > 0.0f ? sign * now : 0.0f;
  }
  return true;
}

/// The upright thickness at the middle of a square under which its texels hold a volume; where snow
/// ends within the square they are bare beyond.
double CoarseMap::fill_height(const std::vector<Part>& parts, double volume) {
  double thickness = std::numeric_limits<double>::infinity();
  // Each round leaves bare ones out.
  for (double before = 0.0; volume > 0.0 && before != thickness;) {
    before = thickness;
    double area = 0.0;
    double lifted = 0.0;
    for (const Part& part : parts) {
      if (!(thickness * part.up + part.rise > 0.0)) continue;
      area += part.area * part.up;
      lifted += part.area * part.rise;
    }
    if (!(area > 0.0)) break;
    thickness = std::min(thickness, (volume - lifted) / area);
  }
  return thickness;
}

void CoarseMap::end(const MovingMap& moved, MovingMap& map) {
  map.slid += moved.slid;
  if (!moved.has_changed) return;
  std::atomic<bool> has_changed{false};
  for_squares([&](size_t first, size_t last) {
    thread_local std::vector<Part> parts;
    for (size_t i = first; i < last; ++i) {
      if (!spread(i, *map.height, parts)) continue;
      const auto at = static_cast<size_t>(repose_.table().texel[i]);
      before_[at] = height_[at];
      has_changed.store(true, std::memory_order_relaxed);
    }
  });
  map.has_changed = map.has_changed || has_changed;
}

void CoarseMaps::lay_out(const std::vector<const SceneObject*>& objects, const SceneRays& rays) {
  objects_ = objects;
  rays_ = &rays;
  levels_.clear();
  levels_.resize(objects.size());
  begin_step();
}

void CoarseMaps::forget_pose(size_t object) {
  if (levels_[object].map != nullptr) levels_[object].map->forget_pose();
}

void CoarseMaps::forget_rooms(size_t object) {
  if (levels_[object].map != nullptr) levels_[object].map->repose().forget_rooms();
}

CoarseMap* CoarseMaps::choose(const MovingMap& map, bool of_grains, ReposeLinkTables& tables,
                              Repose& own) {
  const SceneObject& object = *objects_[map.object];
  Level& level = levels_[map.object];
  if (std::exchange(is_chosen_[map.object], uint8_t{1}) != 0) return level.map.get();
  const double depth =
      object.mask != nullptr ? 0.0 : thickest(*map.height, object.table->resolution);
  if (level.texel_size.x == 0.0 && depth > 0.0) level.texel_size = texel_size_of(object);
  const auto [longer, shorter] = std::pair(level.texel_size.x, level.texel_size.y);
  // Across too many short texels heaps come to rest less round, too.
  const double size = of_grains ? std::max(shorter, 0.5 * longer) : longer;
  const double wanted = std::max(kFinest, depth / (of_grains ? kTexelsAHeap : kTexelsADepth));
  int32_t side = 1;
  while (size > 0.0 && depth > 0.0 && side < kMaxSide &&
         std::numbers::sqrt2 * side * size < wanted) {
    side *= 2;
  }
  if (side == level.wanted) return level.map.get();
  level.wanted = side;
  level.map = nullptr;
  own.forget_tiles();
  for (; side > 1 && level.map == nullptr; side /= 2) {
    level.map = CoarseMap::make(object, side, tables, *rays_);
  }
  return level.map.get();
}

}  // namespace snowbough::snow
