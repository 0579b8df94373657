#include "snow/movement/pressing.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "base/parallel_for.h"
#include "shaders/lib/texel_repose.h"
#include "snow/movement/rays/map_point.h"

namespace snowbough::snow {
namespace {

/// Names of planes in checkpoints.
constexpr const char* kPackedPlane = "packed";
constexpr const char* kPressedToPlane = "pressed_to";
constexpr const char* kStandsPlane = "stands";
/// Texels of a run.
constexpr size_t kRun = 1024;
/// Snow thinner than this over an object is not touched, and snow that an object is less far above
/// lies under it, in metres.
constexpr double kTouch = 1e-6;
constexpr double kUnder = 0.01;
/// Packed snow of less than this, in metres, does not stand.
constexpr float kLeastPacked = 0.005f;
/// By how much less walls stand per metre of loose snow on packed snow.
constexpr float kRefill = 4.0f;
/// Nothing slides through an object.
constexpr float kBarrier = 1000.0f;
/// Parts of a step: way of an object per part, the largest of these: in texels; for those that
/// press as a fraction of their size; for others in metres. And the most parts.
constexpr double kTexelsAPart = 2.0;
constexpr double kSizeAPart = 0.05;
constexpr double kLeastPart = 0.01;
constexpr int kMostParts = 64;

bool overlap(const Bounds& a, const Bounds& b, double margin) {
  for (int axis = 0; axis < 3; ++axis) {
    if (a.low[axis] - margin > b.high[axis] || b.low[axis] - margin > a.high[axis]) return false;
  }
  return true;
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
  pressed_[object].runs.clear();
}

bool Pressing::is_on() const {
  return std::any_of(objects_.begin(), objects_.end(), [](const SceneObject* object) {
    return object->press.kind != PressSettings::Kind::kNone;
  });
}

int Pressing::begin(const std::vector<MovingMap*>& maps) {
  is_near_.assign(objects_.size(), 0);
  parts_ = 1;
  for (Pressed& own : pressed_) {
    own.under.clear();
    own.deepest = 0.0;
  }
  if (!is_on()) return 1;
  for (const MovingMap* map : maps) {
    float deepest = 0.0f;
    for (const float height : *map->height) deepest = std::max(deepest, std::abs(height));
    pressed_[map->object].deepest = static_cast<double>(deepest);
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
      find_points(map->object);
      // Between two parts a thin blade must not leave anything.
      const double most = presses ? kSizeAPart * size_of(object.bounds) : kLeastPart;
      const double part = std::max(kTexelsAPart * own.texel_size, most);
      const double parts = std::ceil(presser.travel() / part);
      parts_ = std::max(parts_, static_cast<int>(std::min(parts, double{kMostParts})));
    }
  }
  return parts_;
}

void Pressing::move_to(int part) {
  has_ploughed_ = false;
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
  own.points.resize(table.texel.size());
  own.runs.assign((own.points.size() + kRun - 1) / kRun, {});
  base::for_each_item(own.runs.size(), 4, [&](size_t run) {
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
}

/// Texels whose snow may reach into a box; bare ones within it, too, onto which none may be pushed.
std::vector<int32_t> Pressing::texels_near(const Pressed& own, const PressedMap& map,
                                           const Bounds& box) const {
  const double margin = own.deepest + kUnder;
  std::vector<int32_t> near;
  for (size_t run = 0; run < own.runs.size(); ++run) {
    if (!overlap(own.runs[run], box, margin)) continue;
    const size_t end = std::min((run + 1) * kRun, own.points.size());
    for (size_t i = run * kRun; i < end; ++i) {
      const auto texel = static_cast<int32_t>(i);
      const glm::dvec3 point(own.points[i]);
      const auto thickness = static_cast<double>(std::abs(map.height_at(texel)));
      if (!overlap({point, point}, box, thickness + kUnder)) continue;
      if (map.is_ground(texel)) near.push_back(texel);
    }
  }
  return near;
}

void Pressing::press(MovingMap& map, Repose& repose) {
  Pressed& own = pressed_[map.object];
  own.under.clear();
  for (size_t i = 0; i < objects_.size(); ++i) {
    if (is_near_[i] == 0 || i == map.object || own.deepest == 0.0 ||
        !overlap(pressers_[i]->bounds(), objects_[map.object]->bounds, own.deepest + kUnder)) {
      continue;
    }
    const Repose::BareTexels& bare = repose.bare_texels();
    PressedMap pressed{objects_[map.object], &repose.links(), &bare, &own.points, map.height};
    press_with(i, map, pressed);
  }
  std::sort(own.under.begin(), own.under.end());
  own.under.erase(std::unique(own.under.begin(), own.under.end()), own.under.end());
}

void Pressing::press_with(size_t presser, MovingMap& map, PressedMap& pressed) {
  Pressed& own = pressed_[map.object];
  const std::vector<int32_t> near = texels_near(own, pressed, pressers_[presser]->bounds());
  std::vector<Touched> all(near.size());
  base::for_each_item(near.size(), 64, [&](size_t i) {
    const int32_t texel = near[i];
    const glm::dvec3 normal = texel_now(*pressed.object, texel).normal * pressed.side(texel);
    const double length = glm::length(normal);
    all[i].texel = texel;
    all[i].clearance = std::numeric_limits<double>::infinity();
    if (!(length > 0.0)) return;
    const auto thickness = static_cast<double>(std::abs(pressed.height_at(texel)));
    Bounds column;
    column.include(pressed.point(texel));
    column.include(pressed.point(texel) + normal * ((thickness + kUnder) / length));
    if (!overlap(column, pressers_[presser]->bounds(), kTouch)) return;
    const Clearance found = pressers_[presser]->clearance(pressed.point(texel), normal / length);
    all[i].clearance = found.metres;
    all[i].way = glm::dvec3(found.moves.x, found.moves.y, 0.0);
  });
  std::vector<int32_t> covered;
  std::vector<Touched> touched;
  for (const Touched& one : all) {
    const auto thickness = static_cast<double>(std::abs(pressed.height_at(one.texel)));
    if (one.clearance < thickness + kUnder) covered.push_back(one.texel);
    if (one.clearance < thickness - kTouch) touched.push_back(one);
  }
  own.under.insert(own.under.end(), covered.begin(), covered.end());
  const PressSettings& settings = objects_[presser]->press;
  std::vector<PushedSnow> pushed;
  sink(settings, touched, map, pressed, pushed);
  if (pushed.empty()) return;
  has_ploughed_ = has_ploughed_ || settings.kind == PressSettings::Kind::kPlough;
  int64_t kept = 0;
  for (const auto& [texel, units] :
       spread_pushed(pressed, covered, pushed, settings.rim_width, kept)) {
    float& height = pressed.height_at(texel);
    const double side = pressed.side(texel);
    const double thickness = static_cast<double>(std::abs(height)) +
                             static_cast<double>(units) * kPushUnit / pressed.area(texel);
    height = static_cast<float>(side * thickness);
    own.deepest = std::max(own.deepest, thickness);
  }
  // Snow with nowhere to go is pressed.
  map.pressed += static_cast<double>(kept) * kPushUnit;
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
      }
    }
    if (!presses && now == 0.0f && !own.packed.empty()) own.packed[i] = own.pressed_to[i] = 0.0f;
  }
}

const std::vector<float>* Pressing::stand(const MovingMap& map) {
  Pressed& own = pressed_[map.object];
  if (own.packed.empty() && own.under.empty()) return nullptr;
  const std::vector<int32_t>& places = objects_[map.object]->table->texel;
  own.plane.assign(map.height->size(), 0.0f);
  for (size_t i = 0; i < own.packed.size(); ++i) {
    if (own.packed[i] < kLeastPacked) continue;
    const auto place = static_cast<size_t>(places[i]);
    const float loose = std::max(std::abs((*map.height)[place]) - own.pressed_to[i], 0.0f);
    own.plane[place] = std::max(own.stands[i] - kRefill * loose, 0.0f);
  }
  for (const int32_t texel : own.under) {
    own.plane[static_cast<size_t>(places[static_cast<size_t>(texel)])] = kBarrier;
  }
  return &own.plane;
}

void Pressing::end() {
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
  // A state with only some of them is of no use.
  if (own.pressed_to.size() != own.packed.size() || own.stands.size() != own.packed.size()) {
    own.packed.clear();
    own.pressed_to.clear();
    own.stands.clear();
  }
}

}  // namespace snowbough::snow
