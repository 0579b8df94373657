#pragma once

#include <algorithm>
#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <memory>
#include <span>
#include <vector>

#include "shaders/lib/snow_shared.h"
#include "snow/scene/projection.h"
#include "snow/scene/scene_layout.h"
#include "snow/step/cpu/fragment_runs.h"

namespace snowbough::snow::cpu {

/// The fields of shared::TexelStep, each in an array of its own: the arrays that passes write in
/// every step are separate from those that stay while a surface does not move.
struct TexelSteps {
  std::vector<uint32_t> gain;
  std::vector<float> area;
  std::vector<float> up;
  std::vector<float> back_up;

  explicit TexelSteps(size_t count = 0) : gain(count), area(count), up(count), back_up(count) {}
};

/// A receiver's map and the passes' data of its texels, which are grouped by shared::kTexelGroup,
/// near ones together (snow/texels/texel_order.h).
struct Receiver {
  size_t object = 0;
  uint32_t slot = 0;
  int32_t resolution = 0;
  /// From a scene triangle's index to its index among the layout's map triangles.
  int32_t map_offset = 0;
  /// Of its positions; empty: unknown.
  Bounds bounds;
  /// Per texel: row * resolution + column. Receivers that share a texel table share this, too.
  std::shared_ptr<const std::vector<uint32_t>> own_places;
  std::span<const uint32_t> places;
  FragmentRuns fragments;
  /// Of the current step; area and upward parts are from the pose in which the texel's group was
  /// last evaluated.
  TexelSteps steps;
  /// Whether a tile of the current step has set their gain.
  bool has_gain = false;
  /// Number of the receiver's pose, and per group the pose in which it was evaluated.
  uint32_t pose = 1;
  std::vector<uint32_t> evaluated_in;
  /// Snow thickness in metres, row by row.
  std::vector<float> height;
  /// Per texel, the volume in m3 that stability let slide in this step, 0 outside the groups of
  /// `slid_groups`; empty if never recorded.
  std::vector<float> slid;
  std::vector<uint32_t> slid_groups;

  /// Per group: whether snow lies on it; and the groups active in this step, ascending.
  std::vector<uint8_t> holds_snow;
  std::vector<uint32_t> active;

  shared::ObjectSums sums{};

  size_t group_count() const { return holds_snow.size(); }
  /// Texels of a group: [first_texel(group), first_texel(group + 1)).
  size_t first_texel(size_t group) const {
    return std::min(group * shared::kTexelGroup, places.size());
  }
};

/// All data that the passes read and write.
struct Scene {
  SceneLayout layout;
  std::vector<glm::vec3> positions;
  /// Of the triangle set-up: three corners and one surface a triangle.
  std::vector<glm::vec4> corners;
  std::vector<glm::vec4> surface;
  /// Per smooth point of the layout: its normal, and the surface there
  /// (shaders/lib/smooth_points.h).
  std::vector<glm::vec4> point_normals;
  std::vector<glm::vec4> smooth_points;
  /// Whether the normals belong to `positions`.
  bool normals_are_current = false;
  shared::ProjectionFrame frame{};
  /// By slot.
  std::vector<Receiver> receivers;
  /// The surfaces that the sky sees in the current tile and its margin.
  std::vector<shared::SeenPixel> seen;
  /// By slot: pixels of back faces.
  std::vector<uint32_t> back_pixels;
};

/// Builds a scene with bare maps and without positions. `objects` are sorted by name.
Scene build_scene(const std::vector<const SceneObject*>& objects);

}  // namespace snowbough::snow::cpu
