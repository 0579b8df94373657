#include "snow/movement/pressing.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "base/parallel_for.h"
#include "base/simd.h"
#include "shaders/lib/texel_repose.h"
#include "snow/movement/rays/map_point.h"

namespace snowbough::snow {
namespace {

/// Names of planes in checkpoints.
constexpr const char* kPackedPlane = "packed";
constexpr const char* kPressedToPlane = "pressed_to";
constexpr const char* kStandsPlane = "stands";
/// Texels of a run, and runs of a long run.
constexpr size_t kRun = 32;
constexpr size_t kLongRun = 64;
/// Snow thinner than this over an object is not touched, and snow that an object is less far above
/// lies under it, in metres.
constexpr double kTouch = 1e-6;
constexpr double kUnder = 0.01;
/// Edge in metres of the cubes whose snow a blade throws up together, and the least speed in m/s.
constexpr double kThrownCube = 0.05;
constexpr double kThrows = 1.0;
/// More than rounding of positions, in metres.
constexpr double kRounding = 2e-4;
/// The steepest heap that a blade pushes ahead, as a slope.
constexpr double kSteepest = 6.0;
/// Room above the thickest snow, in metres, for what is pushed.
constexpr double kRoom = 0.1;
/// Packed snow of less than this, in metres, does not stand.
constexpr float kMinPacked = 0.005f;
/// By how much less walls stand per metre of loose snow on packed snow.
constexpr float kRefill = 4.0f;
/// Parts of a step: way of an object per part, the larger of these: in texels; and as a fraction of
/// the object's size. That of objects that do not press is less than their thickness, by this
/// factor and by so many texels, but at least so many metres. And the most parts.
constexpr double kTexelsAPart = 2.0;
constexpr double kSizeAPart = 0.0625;
constexpr double kThicknessAPart = 0.9;
constexpr double kTexelsOfOverlap = 1.5;
constexpr double kMinPart = 0.01;
constexpr int kMaxParts = 64;
/// Of PressedMap::numbers: a free texel that has received snow.
constexpr int32_t kGained = -2;

bool overlap(const Bounds& a, const Bounds& b, double margin) {
  for (int axis = 0; axis < 3; ++axis) {
    if (a.low[axis] - margin > b.high[axis] || b.low[axis] - margin > a.high[axis]) return false;
  }
  return true;
}

/// The largest magnitude; a maximum of floats would not vectorise.
SNOWBOUGH_WIDE float thickest(const std::vector<float>& heights) {
  uint32_t bits = 0;
  for (const float height : heights) {
    bits = std::max(bits, std::bit_cast<uint32_t>(height) & 0x7FFFFFFFu);
  }
  return std::bit_cast<float>(bits);
}

double size_of(const Bounds& bounds) {
  const glm::dvec3 size = bounds.high - bounds.low;
  return std::max({size.x, size.y, size.z});
}

}  // namespace

/// A texel whose snow reaches into an object, or lies under it.
struct Pressing::Touched {
  int32_t texel = 0;
  double clearance = 0.0;
  glm::dvec3 way{0.0};
};

void Pressing::lay_out(const std::vector<const SceneObject*>& objects) {
  objects_ = objects;
  pressed_.assign(objects.size(), {});
  pressers_.clear();
  pressers_.resize(objects.size());
  last_.assign(objects.size(), {});
}

void Pressing::forget_pose(size_t object) {
  pressed_[object].points.clear();
}

bool Pressing::is_on() const {
  return std::any_of(objects_.begin(), objects_.end(), [](const SceneObject* object) {
    return object->press.kind != PressSettings::Kind::kNone;
  });
}

int Pressing::begin(const std::vector<MovingMap*>& maps) {
  is_near_.assign(objects_.size(), 0);
  parts_ = 1;
  any_blade_ = false;
  for (Pressed& own : pressed_) {
    own.under.clear();
    own.columns.clear();
    own.deepest = own.reach = 0.0;
  }
  if (!is_on()) return 1;
  for (const MovingMap* map : maps) {
    pressed_[map->object].deepest = static_cast<double>(thickest(*map->height));
  }
  for (size_t i = 0; i < objects_.size(); ++i) {
    const SceneObject& object = *objects_[i];
    if (object.press.kind == PressSettings::Kind::kNone || object.hidden ||
        object.positions.empty()) {
      continue;
    }
    if (pressers_[i] == nullptr) pressers_[i] = std::make_unique<Presser>(object);
    Presser& presser = *pressers_[i];
    presser.begin(last_[i]);
    const bool presses = object.press.kind == PressSettings::Kind::kPress;
    for (const MovingMap* map : maps) {
      const Pressed& own = pressed_[map->object];
      const SceneObject& receiver = *objects_[map->object];
      if (map->object == i || own.deepest == 0.0 ||
          !overlap(presser.swept(), receiver.bounds, own.deepest + kUnder)) {
        continue;
      }
      is_near_[i] = 1;
      any_blade_ = any_blade_ || object.press.kind == PressSettings::Kind::kPlough;
      find_points(map->object);
      // What moves over the snow counts: the top of a wheel is twice as fast as the wheel.
      Bounds snow = receiver.bounds;
      snow.low -= own.deepest + kUnder;
      snow.high += own.deepest + kUnder;
      double most = kSizeAPart * size_of(object.bounds);
      // Between two parts a thin blade must not leave anything.
      if (!presses) {
        const double thinnest = presser.thinnest(snow);
        most = std::clamp(
            std::min(kThicknessAPart * thinnest, thinnest - kTexelsOfOverlap * own.texel_size),
            kMinPart, std::max(most, kMinPart));
      }
      const double part = std::max(kTexelsAPart * own.texel_size, most);
      const double parts = std::ceil(presser.travel(snow) / part);
      parts_ = std::max(parts_, static_cast<int>(std::min(parts, double{kMaxParts})));
    }
  }
  return parts_;
}

void Pressing::move_to(int part) {
  // After a rest.
  if (part == 1 || rests()) {
    for (Pressed& own : pressed_) own.is_ploughed.clear();
    has_ploughed_ = false;
  }
  part_ = part;
  base::for_each_item(objects_.size(), 1, [&](size_t i) {
    if (is_near_[i] != 0) pressers_[i]->move_to(part, parts_);
  });
}

void Pressing::find_points(size_t object) {
  Pressed& own = pressed_[object];
  if (!own.points.empty()) return;
  const SceneObject& receiver = *objects_[object];
  const TexelTable& table = *receiver.table;
  const std::vector<int32_t>& corners = receiver.description.topology.triangles;
  const auto corner = [&](int32_t triangle, size_t k) {
    const auto vertex = static_cast<size_t>(corners[3 * static_cast<size_t>(triangle) + k]);
    return glm::dvec3(receiver.positions[vertex]);
  };
  double area = 0.0;
  for (int32_t t = 0; t < receiver.triangle_count(); ++t) {
    const glm::dvec3 first = corner(t, 0);
    area += 0.5 * glm::length(glm::cross(corner(t, 1) - first, corner(t, 2) - first));
  }
  own.texel_size = std::sqrt(area / static_cast<double>(std::max<size_t>(table.texel.size(), 1)));
  own.least_up.clear();
  own.points.resize(table.texel.size());
  own.runs.assign((own.points.size() + kRun - 1) / kRun, {});
  own.long_runs.assign((own.runs.size() + kLongRun - 1) / kLongRun, {});
  base::for_each_item(own.runs.size(), 128, [&](size_t run) {
    const size_t end = std::min((run + 1) * kRun, own.points.size());
    for (size_t i = run * kRun; i < end; ++i) {
      const int32_t triangle = table.triangle[i];
      const glm::dvec2 weights(table.barycentric[i]);
      const glm::dvec3 first = corner(triangle, 0);
      const glm::dvec3 point = first + weights.x * (corner(triangle, 1) - first) +
                               weights.y * (corner(triangle, 2) - first);
      own.points[i] = glm::vec3(point);
      own.runs[run].include(point);
    }
  });
  for (size_t run = 0; run < own.runs.size(); ++run) {
    own.long_runs[run / kLongRun].include(own.runs[run]);
  }
}

/// Finds the runs of texels that snow up to `reach` thick would let an object touch in this step.
void Pressing::find_columns(size_t presser, const PressedMap& map) {
  Pressed& own = pressed_[map.number];
  const Bounds& box = pressers_[presser]->swept();
  if (own.least_up.empty()) {
    for (size_t begin = 0; begin < own.points.size(); begin += kRun) {
      const auto first = map.bare->up.begin() + static_cast<ptrdiff_t>(begin);
      const auto count = static_cast<ptrdiff_t>(std::min(kRun, own.points.size() - begin));
      const auto is_steeper = [](float a, float b) { return std::abs(a) < std::abs(b); };
      own.least_up.push_back(std::abs(*std::min_element(first, first + count, is_steeper)));
    }
  }
  for (size_t run = 0; run < own.runs.size(); ++run) {
    if (run % kLongRun == 0 && !overlap(own.long_runs[run / kLongRun], box, own.reach + kUnder)) {
      run += kLongRun - 1;
      continue;
    }
    const glm::dvec3 most = own.most_around(own.least_up[run]);
    const Bounds around{own.runs[run].low - most, own.runs[run].high + most};
    if (overlap(around, box, 0.0)) own.columns[presser].push_back({run, around});
  }
}

/// Half the size of a box around a texel with snow up to `reach` thick. `up`: of its normal.
glm::dvec3 Pressing::Pressed::most_around(float up) const {
  const auto rise = std::min(static_cast<double>(std::abs(up)), 1.0);
  const double aside = reach * std::sqrt(1.0 - rise * rise) + kUnder;
  return {aside, aside, reach + kUnder};
}

/// Finds a run's texels; callable from several threads.
void Pressing::fill_columns(size_t presser, const PressedMap& map, Columns& columns) const {
  const Pressed& own = pressed_[map.number];
  columns.is_found = true;
  const size_t end = std::min((columns.run + 1) * kRun, own.points.size());
  for (size_t i = columns.run * kRun; i < end; ++i) {
    const auto texel = static_cast<int32_t>(i);
    const glm::dvec3 most = own.most_around(map.bare->up[i]);
    const glm::dvec3 point(own.points[i]);
    if (!overlap({point - most, point + most}, pressers_[presser]->swept(), 0.0)) continue;
    if (!map.is_ground(texel)) continue;
    columns.columns.push_back({texel});
  }
}

/// The texels whose snow an object touches, or nearly, ascending.
std::vector<Pressing::Touched> Pressing::touched_by(size_t presser, const PressedMap& map) {
  Pressed& own = pressed_[map.number];
  const Presser& tool = *pressers_[presser];
  if (own.columns.empty() || own.deepest > own.reach) {
    // With room for what is pushed.
    own.reach = 2.0 * own.deepest + kRoom;
    own.columns.assign(objects_.size(), {});
  }
  if (own.columns[presser].empty()) find_columns(presser, map);
  std::vector<Columns>& all = own.columns[presser];
  // What lies just under a broom is of no interest before the snow comes to rest.
  const bool needs_covered =
      objects_[presser]->press.kind != PressSettings::Kind::kClear || part_ == parts_ || any_blade_;
  std::vector<std::vector<Touched>> found(all.size());
  base::for_each_item(found.size(), 8, [&](size_t i) {
    if (!tool.may_reach(all[i].box)) return;
    if (!all[i].is_found) fill_columns(presser, map, all[i]);
    for (auto& [texel, up] : all[i].columns) {
      const auto thickness = static_cast<double>(std::abs(map.height_at(texel)));
      const double most = needs_covered ? thickness + kUnder : thickness - kTouch;
      if (!(most > 0.0)) continue;
      const glm::dvec3 point = map.point(texel);
      const auto rise = static_cast<double>(map.bare->up[static_cast<size_t>(texel)]);
      const double aside = most * std::sqrt(std::max(1.0 - rise * rise, 0.0));
      // With room for rounding, and for where rays begin.
      const glm::dvec3 around = glm::dvec3(aside, aside, most) + kRounding;
      if (!tool.may_reach({point - around, point + around})) continue;
      if (std::abs(rise) >= 1.0) {
        up = {0.0, 0.0, rise};
      } else if (up == glm::dvec3(0.0)) {
        up = texel_now(*map.object, *map.object->table, map.object->positions, texel).normal;
        if (up != glm::dvec3(0.0)) up = glm::normalize(up);
      }
      const glm::dvec3 normal = up * map.side(texel);
      const Clearance clearance = tool.clearance(point, normal, most);
      if (!(clearance.metres < most)) continue;
      const glm::dvec3 way(clearance.moves.x, clearance.moves.y, 0.0);
      found[i].push_back({texel, clearance.metres, way});
    }
  });
  std::vector<Touched> touched;
  for (const std::vector<Touched>& some : found) {
    touched.insert(touched.end(), some.begin(), some.end());
  }
  return touched;
}

void Pressing::press(MovingMap& map, Repose& repose, double slope) {
  Pressed& own = pressed_[map.object];
  own.under.clear();
  for (size_t i = 0; i < objects_.size(); ++i) {
    if (is_near_[i] == 0 || i == map.object || own.deepest == 0.0 ||
        !overlap(pressers_[i]->bounds(), objects_[map.object]->bounds, own.deepest + kUnder)) {
      continue;
    }
    const BareTexels& bare = repose.bare();
    PressedMap pressed{map.object,  objects_[map.object], &repose.links(), &bare,
                       &own.points, map.height,           &own.numbers};
    if (own.numbers.empty()) own.numbers.assign(own.points.size(), -1);
    press_with(i, map, pressed, slope);
  }
  std::sort(own.under.begin(), own.under.end());
  own.under.erase(std::unique(own.under.begin(), own.under.end()), own.under.end());
}

void Pressing::press_with(size_t presser, MovingMap& map, PressedMap& pressed, double slope) {
  Pressed& own = pressed_[map.object];
  const PressSettings& settings = objects_[presser]->press;
  std::vector<Touched> touched = touched_by(presser, pressed);
  std::vector<int32_t> covered;
  for (const Touched& one : touched) covered.push_back(one.texel);
  own.under.insert(own.under.end(), covered.begin(), covered.end());
  std::erase_if(touched, [&](const Touched& one) {
    const auto thickness = static_cast<double>(std::abs(pressed.height_at(one.texel)));
    return !(one.clearance < thickness - kTouch);
  });
  std::vector<PushedSnow> pushed;
  sink(settings, touched, map, pressed, pushed);
  if (pushed.empty()) return;
  const bool ploughs = settings.kind == PressSettings::Kind::kPlough;
  if (ploughs && own.is_ploughed.empty()) own.is_ploughed.assign(pressed.links->block_count(), 0);
  has_ploughed_ = has_ploughed_ || ploughs;
  const auto note = [&](int32_t texel) {
    if (!ploughs) return;
    own.is_ploughed[static_cast<size_t>(pressed.links->block_of(pressed.place(texel)))] = 1;
  };
  for (const PushedSnow& snow : pushed) note(snow.texel);
  if (ploughs && part_ == parts_) throw_up(presser, pressed, pushed);
  for (size_t k = 0; k < covered.size(); ++k) {
    own.numbers[static_cast<size_t>(covered[k])] = static_cast<int32_t>(k);
  }
  int64_t kept = 0;
  std::vector<int32_t> gained;
  for (const int32_t texel : spread_pushed(pressed, covered, pushed, settings.rim_width,
                                           ploughs ? std::min(slope, kSteepest) : 0.0, kept)) {
    // Strips overlap.
    if (std::exchange(own.numbers[static_cast<size_t>(texel)], kGained) == kGained) continue;
    const auto thickness = static_cast<double>(std::abs(pressed.height_at(texel)));
    own.deepest = std::max(own.deepest, thickness);
    gained.push_back(texel);
    note(texel);
  }
  for (const std::vector<int32_t>* done : {&covered, &gained}) {
    for (const int32_t texel : *done) own.numbers[static_cast<size_t>(texel)] = -1;
  }
  // Snow with nowhere to go is pressed.
  map.pressed += static_cast<double>(kept) * kPushUnit;
}

/// Notes what a blade throws up at the end of a step.
void Pressing::throw_up(size_t presser, const PressedMap& map,
                        const std::vector<PushedSnow>& pushed) {
  const double way = pressers_[presser]->travel(pressers_[presser]->swept());
  for (const PushedSnow& snow : pushed) {
    const glm::dvec3 point = map.point(snow.texel);
    const glm::dvec3 cube = glm::floor(point / kThrownCube);
    Thrown& sum = thrown_[{static_cast<int64_t>(cube.x), static_cast<int64_t>(cube.y),
                           static_cast<int64_t>(cube.z)}];
    const double volume = static_cast<double>(snow.units) * kPushUnit;
    sum.object = static_cast<int32_t>(map.number);
    sum.volume += volume;
    sum.point += volume * point;
    sum.way += volume * way * snow.way;
  }
}

/// Finds the blocks with packed snow, after it has been loaded.
void Pressing::find_packed(Pressed& own, const SceneObject& object, const ReposeLinks& links) {
  if (!own.has_packed.empty()) return;
  own.has_packed.assign(links.block_count(), 0);
  for (size_t i = 0; i < own.packed.size(); ++i) {
    if (own.packed[i] == 0.0f) continue;
    own.has_packed[static_cast<size_t>(links.block_of(object.table->texel[i]))] = 1;
  }
}

/// Lowers the snow at the touched texels; `pushed`: what moves on.
void Pressing::sink(const PressSettings& settings, const std::vector<Touched>& touched,
                    MovingMap& map, PressedMap& pressed, std::vector<PushedSnow>& pushed) {
  Pressed& own = pressed_[map.object];
  const bool presses = settings.kind == PressSettings::Kind::kPress;
  if (presses && !touched.empty() && own.packed.empty()) {
    for (auto* plane : {&own.packed, &own.pressed_to, &own.stands}) {
      plane->assign(own.points.size(), 0.0f);
    }
  }
  find_packed(own, *pressed.object, *pressed.links);
  const double ratio = std::max(settings.packed_density / kFreshDensity, 1.0);
  for (const Touched& one : touched) {
    const auto i = static_cast<size_t>(one.texel);
    float& height = pressed.height_at(one.texel);
    const double side = pressed.side(one.texel);
    const auto thickness = static_cast<double>(std::abs(height));
    double left = one.clearance;
    if (presses) {
      left = std::max(left, (thickness + static_cast<double>(own.packed[i])) / ratio);
      if (!(left < thickness - kTouch)) continue;
    }
    const auto now = static_cast<float>(left);
    const double lost = (thickness - static_cast<double>(now)) * pressed.area(one.texel);
    height = side < 0.0 && now > 0.0f ? -now : now;
    map.has_changed = true;
    if (settings.kind == PressSettings::Kind::kClear) {
      map.cleared += lost;
    } else {
      const double share = presses ? settings.pushed_aside : 1.0;
      const int64_t units = std::llround(share * lost / kPushUnit);
      const double packed = lost - static_cast<double>(units) * kPushUnit;
      map.pressed += packed;
      if (units > 0) pushed.push_back({one.texel, units, one.way});
      if (presses) {
        own.packed[i] += static_cast<float>(packed / pressed.area(one.texel));
        own.pressed_to[i] = now;
        own.stands[i] = static_cast<float>(settings.walls_stand);
        own.has_packed[static_cast<size_t>(pressed.links->block_of(pressed.place(one.texel)))] = 1;
      }
    }
    if (!presses && now == 0.0f && !own.packed.empty()) own.packed[i] = own.pressed_to[i] = 0.0f;
  }
}

bool Pressing::rests() const {
  return part_ == parts_ || (has_ploughed_ && (parts_ - part_) % 2 == 0);
}

std::vector<int32_t> Pressing::ploughed_blocks(const MovingMap& map) const {
  const std::vector<uint8_t>& is_ploughed = pressed_[map.object].is_ploughed;
  std::vector<int32_t> blocks;
  for (size_t b = 0; b < is_ploughed.size(); ++b) {
    if (is_ploughed[b] != 0) blocks.push_back(static_cast<int32_t>(b));
  }
  return blocks;
}

/// The height to which packed snow stands under a thickness.
float Pressing::Pressed::stand_at(int32_t texel, float height) const {
  const auto i = static_cast<size_t>(texel);
  if (packed.empty() || packed[i] < kMinPacked) return 0.0f;
  const float loose = std::max(std::abs(height) - pressed_to[i], 0.0f);
  return std::max(stands[i] - kRefill * loose, 0.0f);
}

std::vector<uint8_t> Pressing::standing_blocks(const MovingMap& map, Repose& repose) {
  Pressed& own = pressed_[map.object];
  if (own.packed.empty()) return {};
  const SceneObject& object = *objects_[map.object];
  const std::vector<int32_t>& places = object.table->texel;
  const ReposeLinks& links = *repose.ground().links;
  find_packed(own, object, links);
  std::vector<uint8_t> stands = own.has_packed;
  base::for_each_item(stands.size(), 8, [&](size_t block) {
    if (stands[block] == 0) return;
    stands[block] = 0;
    links.for_texels(static_cast<int32_t>(block), places, [&](int32_t texel, size_t) {
      const auto place = static_cast<size_t>(places[static_cast<size_t>(texel)]);
      if (own.stand_at(texel, (*map.height)[place]) > 0.0f) stands[block] = 1;
    });
  });
  const bool any =
      std::any_of(stands.begin(), stands.end(), [](uint8_t stand) { return stand != 0; });
  return any ? stands : std::vector<uint8_t>();
}

void Pressing::set_stand(const MovingMap& map, Repose& repose) {
  Pressed& own = pressed_[map.object];
  if (own.packed.empty() && own.under.empty() && own.stand.empty()) return;
  const std::vector<int32_t>& places = objects_[map.object]->table->texel;
  const ReposeLinks& links = *repose.ground().links;
  const auto place_of = [&](int32_t texel) {
    return static_cast<size_t>(places[static_cast<size_t>(texel)]);
  };
  std::vector<uint8_t> changes(links.block_count(), 0);
  if (own.stand.empty()) {
    own.stand.assign(map.height->size(), 0.0f);
    own.is_under.assign(map.height->size(), 0);
    own.stands_in = changes;
    // Another state may have set another stand.
    std::fill(changes.begin(), changes.end(), uint8_t{1});
  }
  find_packed(own, *objects_[map.object], links);
  std::vector<uint8_t> looks = own.stands_in;
  for (size_t b = 0; b < own.has_packed.size(); ++b) looks[b] |= own.has_packed[b];
  for (const int32_t texel : own.under) {
    own.is_under[place_of(texel)] = 1;
    looks[static_cast<size_t>(links.block_of(static_cast<int32_t>(place_of(texel))))] = 1;
  }
  base::for_each_item(looks.size(), 8, [&](size_t block) {
    if (looks[block] == 0) return;
    own.stands_in[block] = 0;
    links.for_texels(static_cast<int32_t>(block), places, [&](int32_t texel, size_t) {
      const size_t place = place_of(texel);
      const float now =
          own.is_under[place] != 0 ? Repose::kBarrier : own.stand_at(texel, (*map.height)[place]);
      if (now != own.stand[place]) changes[block] = 1;
      if (now != 0.0f) own.stands_in[block] = 1;
      own.stand[place] = now;
    });
  });
  for (const int32_t texel : own.under) own.is_under[place_of(texel)] = 0;
  const bool any = std::any_of(own.stands_in.begin(), own.stands_in.end(),
                               [](uint8_t stands) { return stands != 0; });
  repose.set_stand(any ? &own.stand : nullptr, changes);
}

void Pressing::end(uint32_t step_number, double dt, std::vector<FlyingSnow>* flying) {
  for (const auto& [cube, snow] : thrown_) {
    if (flying == nullptr || !(dt > 0.0)) break;
    const glm::dvec3 way = snow.way / (snow.volume * dt);
    const double speed = glm::length(way);
    if (!(speed > kThrows)) continue;
    const FlightSeed seed{cube, step_number};
    const glm::dvec3 sideways(-way.y, way.x, 0.0);
    const glm::dvec3 velocity = way * (0.9 + 0.4 * seed.number(11)) +
                                sideways * (0.3 * seed.number(12) - 0.15) +
                                glm::dvec3(0.0, 0.0, speed * (0.2 + 0.4 * seed.number(13)));
    add_flight({snow.object, glm::vec3(snow.point / snow.volume), glm::vec3(velocity),
                static_cast<float>(snow.volume), static_cast<float>(2.0 * velocity.z / kGravity)},
               seed, dt, *flying);
  }
  thrown_.clear();
  for (size_t i = 0; i < objects_.size(); ++i) {
    const SceneObject& object = *objects_[i];
    if (object.press.kind == PressSettings::Kind::kNone || object.hidden) {
      last_[i].clear();
    } else if (last_[i] != object.positions) {
      last_[i] = object.positions;
    }
  }
}

void Pressing::save(SimulationState& state) const {
  for (size_t i = 0; i < objects_.size(); ++i) {
    if (!last_[i].empty()) state.pressers[objects_[i]->description.name] = last_[i];
  }
}

void Pressing::save(size_t object, ObjectState& state) const {
  const Pressed& own = pressed_[object];
  if (own.packed.empty()) return;
  const std::vector<int32_t>& places = objects_[object]->table->texel;
  const auto save_plane = [&](const char* name, const std::vector<float>& values) {
    std::vector<float>& plane = state.planes[name];
    plane.assign(state.height.size(), 0.0f);
    for (size_t i = 0; i < places.size(); ++i) plane[static_cast<size_t>(places[i])] = values[i];
  };
  save_plane(kPackedPlane, own.packed);
  save_plane(kPressedToPlane, own.pressed_to);
  save_plane(kStandsPlane, own.stands);
}

void Pressing::load(const SimulationState& state) {
  for (size_t i = 0; i < objects_.size(); ++i) {
    const auto found = state.pressers.find(objects_[i]->description.name);
    last_[i] = found != state.pressers.end() ? found->second : std::vector<glm::vec3>{};
  }
}

void Pressing::load(size_t object, const ObjectState& state) {
  Pressed& own = pressed_[object];
  const std::vector<int32_t>& places = objects_[object]->table->texel;
  const auto load_plane = [&](const char* name, std::vector<float>& values) {
    values.clear();
    const auto found = state.planes.find(name);
    if (found == state.planes.end()) return;
    for (const int32_t place : places) {
      values.push_back(found->second[static_cast<size_t>(place)]);
    }
  };
  load_plane(kPackedPlane, own.packed);
  load_plane(kPressedToPlane, own.pressed_to);
  load_plane(kStandsPlane, own.stands);
  own.stand.clear();
  own.has_packed.clear();
  // A state with only some of them is of no use.
  if (own.pressed_to.size() != own.packed.size() || own.stands.size() != own.packed.size()) {
    own.packed.clear();
    own.pressed_to.clear();
    own.stands.clear();
  }
}

}  // namespace snowbough::snow
