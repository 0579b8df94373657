#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <string>
#include <vector>

#include "snow/scene/alpha_mask.h"
#include "snow/scene/press_settings.h"
#include "snow/scene/projection.h"
#include "snow/texels/texel_table.h"

namespace snowbough::snow {

/// Sides of a receiver that take snow.
enum class Sides {
  /// Both sides of open surfaces such as cards and leaves (snow/texels/open_sheets.h); otherwise
  /// the positive side.
  kAuto,
  /// The side to which the normals point, and from which triangles run anticlockwise.
  kPositive,
  kBoth,
};

/// Arguments of add_object: a mesh whose topology stays until replace_object.
struct ObjectDescription {
  /// Unique; objects are drawn in the order of their names.
  std::string name;
  /// Triangles, and for receivers texture coordinates and the map's resolution.
  MapTopology topology;
  /// Whether the object gathers snow on a map. A receiver always occludes, too.
  bool receive = true;
  /// Whether the object blocks snow.
  bool occlude = true;
  /// The parts through which snow falls.
  ObjectAlpha alpha;
  /// Positions in metres of the pose in which output measures distances across seams and for the
  /// blur; empty: the object's first step. A simulation that resumes from a checkpoint must use the
  /// pose of the first one to get the same output.
  std::vector<glm::vec3> rest;
  /// Standard deviation in metres of the blur of this object's output; negative: the simulation's.
  double blur_radius = -1.0;
  /// Three numbers per triangle: corners with the same number share a smooth normal, computed from
  /// the positions of each step; negative, or empty: flat.
  std::vector<int32_t> shading;
  Sides sides = Sides::kAuto;
};

/// An object in a simulation.
struct SceneObject {
  ObjectDescription description;
  /// Receivers only.
  /// Equal meshes share it (snow/texels/texel_tables.h).
  std::shared_ptr<const TexelTable> table;
  /// See fragment_opacity.h; empty: opaque.
  std::vector<float> fragment_opacity;
  /// Per triangle, 1 if it takes snow on both sides, by the rest pose; empty: all on the
  /// positive side.
  std::vector<uint8_t> two_sided;
  /// Receivers only: by texel, the part of the snow that it takes (snow_mask.h); null: all.
  std::shared_ptr<const std::vector<float>> mask;
  /// What it does to the snow of other objects.
  PressSettings press;
  /// Receivers only: time in seconds after which half of the snow has let go (movement/shedding.h);
  /// 0: it stays.
  double shed_half_life = 0.0;
  /// Current world positions in metres; empty before the object's first step.
  std::vector<glm::vec3> positions;
  Bounds bounds;
  /// Keeps its snow, gains none and blocks none, as if it were not in the scene. Its output stays
  /// that of its positions.
  bool hidden = false;
  /// Positions or visibility changed since the last step.
  bool moved = true;
  /// Receivers only: layer_terms of the current positions; null: not computed yet.
  std::shared_ptr<const std::vector<glm::vec3>> layers;

  int32_t triangle_count() const {
    return static_cast<int32_t>(description.topology.triangles.size() / 3);
  }
};

}  // namespace snowbough::snow
