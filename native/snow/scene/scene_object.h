#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <string>
#include <vector>

#include "snow/scene/alpha_mask.h"
#include "snow/scene/projection.h"
#include "snow/texels/texel_table.h"

namespace snowbough::snow {

/// Which sides of a receiver take snow.
enum class Sides {
  /// Both of what is open, a card or a leaf (snow/texels/open_sheets.h); else the front.
  kAuto,
  /// The front, on which triangles run anticlockwise.
  kFront,
  kBoth,
};

/// What add_object gets: a mesh whose topology stays the same until replace_object gives it
/// another.
struct ObjectDescription {
  /// Unique; objects are drawn in the order of their names, whatever the order of adding.
  std::string name;
  /// Triangles and texture coordinates (these only matter for receivers) and the map's resolution.
  MapTopology topology;
  /// Gathers snow on a map of its own. A receiver always occludes, too.
  bool receive = true;
  /// Keeps snow from what is behind it.
  bool occlude = true;
  /// Where snow falls through the object.
  ObjectAlpha alpha;
  /// Positions in metres of the pose in which output measures distances across seams and for the
  /// blur; empty: those of the object's first step. A simulation that goes on from a checkpoint
  /// takes the pose that the first one began with, so that it ends with the same output.
  std::vector<glm::vec3> rest;
  /// Sigma in metres of the blur of this object's output; negative: the simulation's.
  double blur_radius = -1.0;
  /// Three numbers a triangle: corners of one number share a smooth normal, worked out from the
  /// positions of each step; negative, or no numbers at all: flat.
  std::vector<int32_t> shading;
  Sides sides = Sides::kAuto;
};

/// An object as the simulation holds it.
struct SceneObject {
  ObjectDescription description;
  /// Receivers only.
  TexelTable table;
  /// See fragment_opacity.h; empty: opaque.
  std::vector<float> fragment_opacity;
  /// Per triangle, 1 where it takes snow on both sides, by the rest pose; empty: all on the front.
  std::vector<uint8_t> two_sided;
  /// Current world positions in metres; empty before the first step that names the object.
  std::vector<glm::vec3> positions;
  Bounds bounds;
  /// Positions changed since the last step.
  bool moved = true;
  /// Receivers only: see layer_terms, of the current positions; null: not worked out yet.
  std::shared_ptr<const std::vector<glm::vec3>> layers;

  int32_t triangle_count() const {
    return static_cast<int32_t>(description.topology.triangles.size() / 3);
  }
};

}  // namespace snowbough::snow
