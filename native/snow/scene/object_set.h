#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "snow/scene/scene_object.h"
#include "snow/texels/texel_tables.h"

namespace snowbough::snow {

/// Renumbers shading numbers larger than the number of corners, from 0 on and in the same order:
/// they index arrays.
void renumber_shading(std::vector<int32_t>& shading);

/// Vertex positions of each object in metres, by name.
using PositionMap = std::map<std::string, std::span<const glm::vec3>>;

/// The objects of a simulation, in drawing order (by name). For one thread at a time.
class ObjectSet {
 public:
  /// Makes a new object from its description. @throws std::invalid_argument for a name that is
  /// already in use, and as build_texel_table.
  std::shared_ptr<SceneObject> make(ObjectDescription description);
  /// Makes an object that replaces the one of its name. @throws std::invalid_argument for an
  /// unknown name, another resolution, a receiver that becomes an occluder or the reverse, and as
  /// above.
  std::shared_ptr<SceneObject> make_replacement(ObjectDescription description);
  /// Adds an object, or replaces the one of its name.
  void put(std::shared_ptr<SceneObject> object);

  /// Sets positions of objects that moved, and which objects are hidden. @throws
  /// std::invalid_argument with the object's name for an unknown name, a vertex count that is too
  /// small or differs from the step before, positions that are not finite, or an object that has
  /// none yet; then nothing changes.
  void set_positions(const PositionMap& positions, const std::set<std::string>& hidden = {});

  /// @throws std::invalid_argument for a name that is no receiver.
  const std::shared_ptr<SceneObject>& receiver(const std::string& name) const;
  /// The same. @throws std::invalid_argument before its first step, too.
  const std::shared_ptr<SceneObject>& stepped_receiver(const std::string& name) const;
  std::vector<std::string> receivers() const;

  /// Number of an object in drawing order.
  size_t index_of(const std::string& name) const;
  const std::map<std::string, std::shared_ptr<SceneObject>>& by_name() const { return objects_; }
  std::vector<const SceneObject*> all() const;
  void clear() { objects_.clear(); }

 private:
  std::shared_ptr<SceneObject> build(ObjectDescription description);

  std::map<std::string, std::shared_ptr<SceneObject>> objects_;
  /// Alpha masks of all objects so far: equal masks are stored once.
  std::vector<std::weak_ptr<const AlphaMask>> masks_;
  TexelTables tables_;
};

}  // namespace snowbough::snow
