#include "snow/scene/object_set.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "snow/scene/fragment_opacity.h"
#include "snow/texels/open_sheets.h"

namespace snowbough::snow {
namespace {

[[noreturn]] void refuse(const std::string& message) {
  throw std::invalid_argument(message);
}

/// Replaces a mask by an equal one of `known`, or adds it to them.
void share(std::shared_ptr<const AlphaMask>& mask,
           std::vector<std::weak_ptr<const AlphaMask>>& known) {
  std::erase_if(known, [](const auto& one) { return one.expired(); });
  for (const std::weak_ptr<const AlphaMask>& one : known) {
    const std::shared_ptr<const AlphaMask> other = one.lock();
    if (*other == *mask) {
      mask = other;
      return;
    }
  }
  known.push_back(mask);
}

/// Finds the triangles that take snow on both sides; needs the rest pose.
void find_sides(SceneObject& object) {
  const ObjectDescription& description = object.description;
  if (!description.receive || description.sides == Sides::kPositive) return;
  const std::vector<int32_t>& triangles = description.topology.triangles;
  object.two_sided = description.sides == Sides::kBoth
                         ? std::vector<uint8_t>(triangles.size() / 3, 1)
                         : find_open_sheets(triangles, description.rest);
}

}  // namespace

void renumber_shading(std::vector<int32_t>& shading) {
  if (shading.empty() ||
      static_cast<size_t>(std::max(0, *std::max_element(shading.begin(), shading.end()))) <
          shading.size()) {
    return;
  }
  std::vector<int32_t> numbers(shading);
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  const auto first = std::lower_bound(numbers.begin(), numbers.end(), 0);
  for (int32_t& number : shading) {
    if (number < 0) continue;
    number = static_cast<int32_t>(std::lower_bound(first, numbers.end(), number) - first);
  }
}

std::shared_ptr<SceneObject> ObjectSet::build(ObjectDescription description) {
  MapTopology& topology = description.topology;
  int32_t highest = -1;
  for (const int32_t index : topology.triangles) {
    if (index < 0) {
      refuse("object '" + description.name + "': a triangle has the vertex index " +
             std::to_string(index));
    }
    highest = std::max(highest, index);
  }
  topology.vertex_count = highest + 1;
  if (!description.rest.empty() && static_cast<int32_t>(description.rest.size()) <= highest) {
    refuse("object '" + description.name + "': rest has " +
           std::to_string(description.rest.size()) + " vertices, a triangle uses number " +
           std::to_string(highest));
  }
  for (const glm::vec3& point : description.rest) {
    if (!std::isfinite(point.x) || !std::isfinite(point.y) || !std::isfinite(point.z)) {
      refuse("object '" + description.name + "': rest has a vertex that is not a finite number");
    }
  }
  if (!description.shading.empty() && description.shading.size() != topology.triangles.size()) {
    refuse("object '" + description.name + "': shading has " +
           std::to_string(description.shading.size()) + " numbers, there are " +
           std::to_string(topology.triangles.size()) + " corners of triangles");
  }
  renumber_shading(description.shading);
  auto made = std::make_shared<SceneObject>();
  SceneObject& object = *made;
  try {
    if (!description.alpha.empty()) {
      check_alpha(description.alpha, topology.triangles.size() / 3);
    }
    if (description.receive) {
      object.table = tables_.find_or_build(topology);
      object.fragment_opacity = fragment_opacity(*object.table, topology, description.alpha);
    }
  } catch (const std::invalid_argument& error) {
    refuse("object '" + description.name + "': " + error.what());
  }
  for (std::shared_ptr<const AlphaMask>& mask : description.alpha.masks) {
    share(mask, masks_);
  }
  object.description = std::move(description);
  if (!object.description.rest.empty()) find_sides(object);
  return made;
}

std::shared_ptr<SceneObject> ObjectSet::make(ObjectDescription description) {
  if (objects_.contains(description.name)) {
    refuse("there is already an object named '" + description.name + "'");
  }
  return build(std::move(description));
}

std::shared_ptr<SceneObject> ObjectSet::make_replacement(ObjectDescription description) {
  const auto found = objects_.find(description.name);
  if (found == objects_.end()) {
    refuse("there is no object named '" + description.name + "' to replace: add_object it first");
  }
  const ObjectDescription& before = found->second->description;
  if (before.receive != description.receive) {
    refuse("object '" + description.name + "' must stay " +
           (before.receive ? "a receiver" : "without a map") + " when it is replaced");
  }
  if (before.receive && before.topology.resolution != description.topology.resolution) {
    refuse("object '" + description.name + "' must keep its map of " +
           std::to_string(before.topology.resolution) + " texels per side when it is replaced");
  }
  return build(std::move(description));
}

void ObjectSet::put(std::shared_ptr<SceneObject> object) {
  const std::string name = object->description.name;
  objects_[name] = std::move(object);
}

const std::shared_ptr<SceneObject>& ObjectSet::receiver(const std::string& name) const {
  const auto found = objects_.find(name);
  if (found == objects_.end()) {
    refuse("there is no object named '" + name + "'");
  }
  if (!found->second->description.receive) {
    refuse("object '" + name + "' does not receive snow, so it has no map");
  }
  return found->second;
}

const std::shared_ptr<SceneObject>& ObjectSet::stepped_receiver(const std::string& name) const {
  const std::shared_ptr<SceneObject>& object = receiver(name);
  if (object->positions.empty()) {
    refuse("object '" + name + "' has no positions yet: output is available after its first step");
  }
  return object;
}

std::vector<std::string> ObjectSet::receivers() const {
  std::vector<std::string> names;
  for (const auto& [name, object] : objects_) {
    if (object->description.receive) names.push_back(name);
  }
  return names;
}

size_t ObjectSet::index_of(const std::string& name) const {
  return static_cast<size_t>(std::distance(objects_.begin(), objects_.find(name)));
}

std::vector<const SceneObject*> ObjectSet::all() const {
  std::vector<const SceneObject*> result;
  for (const auto& [name, object] : objects_) result.push_back(object.get());
  return result;
}

void ObjectSet::set_positions(const PositionMap& positions, const std::set<std::string>& hidden) {
  // Checks everything before changing anything.
  for (const auto& [name, points] : positions) {
    const auto found = objects_.find(name);
    if (found == objects_.end()) {
      refuse("step: there is no object named '" + name + "': add_object it first");
    }
    const SceneObject& object = *found->second;
    const auto needed = static_cast<size_t>(object.description.topology.vertex_count);
    if (object.positions.empty() ? points.size() < needed
                                 : points.size() != object.positions.size()) {
      refuse("step: object '" + name + "' has " + std::to_string(points.size()) +
             " vertices instead of " +
             std::to_string(object.positions.empty() ? needed : object.positions.size()) +
             ": its topology must stay as it was added");
    }
    for (const glm::vec3& point : points) {
      if (!std::isfinite(point.x) || !std::isfinite(point.y) || !std::isfinite(point.z)) {
        refuse("step: object '" + name + "' has a vertex that is not a finite number");
      }
    }
  }
  for (const std::string& name : hidden) {
    if (!objects_.contains(name)) refuse("step: there is no object named '" + name + "' to hide");
  }
  for (const auto& [name, object] : objects_) {
    if (object->positions.empty() && !positions.contains(name) &&
        object->description.topology.vertex_count > 0) {
      refuse("step: object '" + name + "' has no positions yet: give them in its first step");
    }
  }
  for (const auto& [name, object] : objects_) {
    const bool is_hidden = hidden.contains(name);
    object->moved |= object->hidden != is_hidden;
    object->hidden = is_hidden;
  }
  for (const auto& [name, points] : positions) {
    SceneObject& object = *objects_.at(name);
    if (object.positions.size() == points.size() &&
        std::memcmp(object.positions.data(), points.data(), points.size_bytes()) == 0) {
      continue;
    }
    if (object.description.receive && object.description.rest.empty()) {
      object.description.rest.assign(points.begin(), points.end());
      find_sides(object);
    }
    object.positions.assign(points.begin(), points.end());
    object.moved = true;
    object.layers = nullptr;
    // Only vertices in use count: unused ones would enlarge the grid.
    glm::vec3 low(1e30f);
    glm::vec3 high(-1e30f);
    for (const int32_t index : object.description.topology.triangles) {
      const glm::vec3& point = object.positions[static_cast<size_t>(index)];
      low = {std::min(low.x, point.x), std::min(low.y, point.y), std::min(low.z, point.z)};
      high = {std::max(high.x, point.x), std::max(high.y, point.y), std::max(high.z, point.z)};
    }
    object.bounds = Bounds{};
    if (low.x <= high.x) {
      object.bounds.include(glm::dvec3(low));
      object.bounds.include(glm::dvec3(high));
    }
  }
}

}  // namespace snowbough::snow
