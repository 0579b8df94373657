#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <limits>
#include <vector>

#include "base/triangle_tree.h"
#include "shaders/lib/snow_surface.h"
#include "snow/surface/height_samples.h"
#include "snow/surface/rim_zones.h"
#include "snow/surface/surface_points.h"

namespace snowbough::snow {

/// The points in the zones of rims, where snow ends in an upright front.
struct Fronts {
  /// Index of each point among all points.
  std::vector<int32_t> point;
  std::vector<shared::SnowFront> front;
  /// Distance from the rim to the middle of the top, in metres.
  std::vector<float> room;
  /// Points behind the rim, and behind the rim across the gap, which give the height there.
  struct Inland {
    glm::ivec4 point{0};
    glm::vec4 weight{0.0f};
  };
  std::vector<Inland> inland;
  std::vector<Inland> across;
  /// What lies below the rim: where the height of its snow comes from, how far it lies below the
  /// rim in metres, and the upward components of its normal and of the supporting face's. There is
  /// nothing if `drop` is infinite.
  struct Fall {
    Inland at;
    float drop = std::numeric_limits<float>::infinity();
    float up = 1.0f;
    float own_up = 1.0f;
    /// 1 where the snow beyond hides the rim in the last frame, 0 where the rim stands free.
    float hidden = 0.0f;
  };
  std::vector<Fall> fall;

  size_t count() const { return point.size(); }
  /// Mean heights behind the rims; bare points count as 0.
  shared::SnowBehind behind(size_t number, const std::vector<float>& height) const;
  /// Part of the height behind a rim that stands above the snow on what lies below, 0 to 1.
  float open_part(size_t number, const std::vector<float>& height) const;
  /// Lets snow run over hidden rims: gives points on their far faces the mean of the heights on
  /// both sides.
  void cover(std::vector<float>& thickness) const;
  /// Share of a front's shape in the surface, 0 to 1. A bridge is a front as a whole: it holds the
  /// snow that the map has in the gap.
  float presence(size_t number, const shared::SnowStyle& style,
                 const shared::SnowBehind& behind) const;
};

/// All but the presence, which depends on the snow. Sets the normals of points near rims to those
/// of the supporting faces: on a smooth-shaded cap the mean normals lean over the rim.
/// @param zone the rim zones of the points.
/// @param tree a tree over the receiver's triangles.
/// @param wind as in SurfacePlan.
/// @param noise_shift offset of positions in noise space, in depths.
Fronts find_fronts(SurfacePoints& points, const std::vector<RimZones::Zone>& zone, const Rims& rims,
                   const base::TriangleTree& tree, const glm::vec2& wind,
                   const glm::vec3& noise_shift, float depth);

/// Sets where snow ends in fronts, from the heights in the last frame.
/// @param thickness thickness of the snow at the points, in metres.
/// @param shown height of the shown snow at the points, in metres.
void find_presence(Fronts& fronts, const SurfacePoints& points, const HeightSamples& samples,
                   const std::vector<float>& thickness, const std::vector<float>& shown,
                   float depth);

}  // namespace snowbough::snow
