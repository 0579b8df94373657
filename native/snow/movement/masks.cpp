#include "snow/movement/masks.h"

#include <algorithm>
#include <cmath>

namespace snowbough::snow {
namespace {

/// Changes the thickness at a texel; returns the volume in m3 that is removed.
double shrink(float& height, float thickness, float area) {
  const double removed = static_cast<double>(std::abs(height)) - static_cast<double>(thickness);
  height = thickness > 0.0f ? std::copysign(thickness, height) : 0.0f;
  return removed * static_cast<double>(area);
}

}  // namespace

void Masks::lay_out(const std::vector<const SceneObject*>& objects) {
  objects_ = objects;
  last_.assign(objects.size(), {});
  lying_.assign(objects.size(), {});
}

bool Masks::acts_on(size_t object) const {
  return objects_[object]->mask != nullptr || !last_[object].empty();
}

bool Masks::is_on() const {
  for (size_t i = 0; i < objects_.size(); ++i) {
    if (acts_on(i)) return true;
  }
  return false;
}

void Masks::begin(const MovingMap& map) {
  if (!acts_on(map.object)) return;
  const std::vector<int32_t>& places = objects_[map.object]->table->texel;
  std::vector<float>& lying = lying_[map.object];
  lying.resize(places.size());
  for (size_t i = 0; i < places.size(); ++i) {
    lying[i] = std::abs((*map.height)[static_cast<size_t>(places[i])]);
  }
}

void Masks::refuse(MovingMap& map, Repose& repose) {
  if (!acts_on(map.object)) return;
  const SceneObject& object = *objects_[map.object];
  const std::vector<int32_t>& places = object.table->texel;
  const std::vector<float>& area = repose.bare().area;
  std::vector<float>& last = last_[map.object];
  std::vector<float>& lying = lying_[map.object];
  last.resize(places.size(), 1.0f);
  for (size_t i = 0; i < places.size(); ++i) {
    const float now = object.mask != nullptr ? (*object.mask)[i] : 1.0f;
    float& height = (*map.height)[static_cast<size_t>(places[i])];
    const float thickness = std::abs(height);
    if (thickness > 0.0f && (now < 1.0f || now < last[i])) {
      const float old = std::min(thickness, lying[i]);
      const float left = old * (now < last[i] ? now / last[i] : 1.0f) + now * (thickness - old);
      if (left < thickness) {
        map.masked += shrink(height, left, area[i]);
        map.has_changed = true;
      }
    }
    last[i] = now;
  }
  lying = {};
  // Without a mask, 1 is understood.
  if (object.mask == nullptr) last = {};
}

void Masks::limit(MovingMap& map, Repose& repose, float max_depth) const {
  const SceneObject& object = *objects_[map.object];
  if (object.mask == nullptr) return;
  const std::vector<int32_t>& places = object.table->texel;
  const std::vector<float>& area = repose.bare().area;
  for (size_t i = 0; i < places.size(); ++i) {
    const float mask = (*object.mask)[i];
    float& height = (*map.height)[static_cast<size_t>(places[i])];
    const float most = mask * max_depth;
    if (mask < 1.0f && std::abs(height) > most) {
      map.masked += shrink(height, most, area[i]);
      map.has_changed = true;
    }
  }
}

std::vector<float> Masks::state(size_t object) const {
  if (last_[object].empty()) return {};
  const TexelTable& table = *objects_[object]->table;
  const auto side = static_cast<size_t>(table.resolution);
  std::vector<float> plane(side * side, 0.0f);
  for (size_t i = 0; i < table.texel.size(); ++i) {
    plane[static_cast<size_t>(table.texel[i])] = last_[object][i];
  }
  return plane;
}

void Masks::set_state(size_t object, const std::vector<float>* plane) {
  last_[object].clear();
  if (plane == nullptr) return;
  for (const int32_t place : objects_[object]->table->texel) {
    last_[object].push_back((*plane)[static_cast<size_t>(place)]);
  }
}

}  // namespace snowbough::snow
