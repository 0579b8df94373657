#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "base/parallel_for.h"
#include "base/triangle_tree.h"
#include "shaders/lib/snow_surface.h"
#include "snow/surface/banks.h"
#include "snow/surface/beyond.h"
#include "snow/surface/blanket.h"
#include "snow/surface/height_samples.h"
#include "snow/surface/nearest_points.h"
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
  std::vector<PointMean> inland;
  std::vector<PointMean> across;
  /// What lies below the rim: where the thickness of its snow comes from, how far it lies below the
  /// rim in metres, the upward components of its normal and of the supporting face's, and the part
  /// of the rims near the point that have it below them; 0 where there is nothing.
  struct Fall {
    PointMean at;
    float drop = 0.0f;
    float up = 1.0f;
    float own_up = 1.0f;
    /// Thickness of the snow of another receiver there along the vertical, as a fraction of the
    /// depth on open ground; below 0: the snow is of this receiver.
    float other = -1.0f;
    float weight = 0.0f;
  };
  std::vector<Fall> fall;
  Blanket blanket;
  /// Points at the rim, which give the height of the blanket at the far face.
  std::vector<PointMean> edge;
  std::vector<Bank> banks;
  /// Per point of the surface: 0 where snow that is drawn lies below or within other pieces,
  /// else 1.
  std::vector<float> counted;
  /// Points within pieces that stand on the surface, and those beside the pieces.
  struct Hidden {
    int32_t point = 0;
    PointMean beside;
  };
  std::vector<Hidden> hidden;

  /// The fronts of the points beside that of front f, from beside_begin[f] on.
  std::vector<int32_t> beside_begin, beside;

  size_t count() const { return point.size(); }
  /// Gives points within pieces at least the thickness beside: the snow would end before the piece.
  void fill_hidden(std::vector<float>& thickness) const;
  /// Averages values per front with those of the points beside.
  template <typename Value>
  void smooth(std::vector<Value>& values) const {
    constexpr int kRounds = 8;
    std::vector<Value> before(values.size());
    for (int round = 0; round < kRounds; ++round) {
      before.swap(values);
      base::for_each_item(values.size(), 256, [&](size_t f) {
        Value sum = before[f];
        for (int32_t i = beside_begin[f]; i < beside_begin[f + 1]; ++i) sum += before[beside[i]];
        values[f] = sum / static_cast<float>(1 + beside_begin[f + 1] - beside_begin[f]);
      });
    }
  }
  /// Mean heights behind the rims; bare points count as 0. `open_depth`: as in SurfaceFrame.
  shared::SnowBehind behind(size_t number, const std::vector<float>& height,
                            float open_depth) const;
  /// Share of a front's shape in the surface, 0 to 1. A bridge is a front as a whole: it holds the
  /// snow that the map has in the gap.
  float presence(size_t number, const shared::SnowBehind& behind,
                 const shared::SnowJoin& join) const;
  /// How far the snow of a front goes on beyond its rim, 0 to 1; not at all far from the rim.
  float goes_on(size_t number, const shared::SnowJoin& join, float depth) const;
  /// Offset of a front's point under a blanket: on the supporting face it is that of a point away
  /// from rims, `offset`. Beyond the rim the snow goes on a little, and dives into that beyond.
  /// `up`: unit normal of the blanket.
  glm::vec3 blanket_offset(size_t number, const shared::SnowJoin& join,
                           const std::vector<float>& shown, const glm::vec3& offset,
                           const glm::vec3& up) const;
};

/// All but the presence, which depends on the snow. Sets the normals of points near rims to those
/// of the supporting faces: on a smooth-shaded cap the mean normals lean over the rim.
/// @param zone the rim zones of the points; `area`: their areas in m2; `thickness`: the map's at
/// the
///   points in the last frame, in metres.
/// @param receiver the receiver's faces; `tree`: a tree over its triangles.
/// @param beyond the other receivers.
/// @param wind as in SurfacePlan.
/// @param noise_shift offset of positions in noise space, in depths.
/// @param needles see are_needles: they cover each other, and have snow all the same.
Fronts find_fronts(SurfacePoints& points, const std::vector<float>& area,
                   const std::vector<float>& thickness, const std::vector<RimZones::Zone>& zone,
                   const Rims& rims, const SurfaceMesh& receiver, const base::TriangleTree& tree,
                   const Beyond& beyond, const glm::vec2& wind, const glm::vec3& noise_shift,
                   float depth, bool needles);

/// Finds which fronts lie beside each other, and smooths how they join those across gaps: whether a
/// rim finds one across must not tear the snow.
void smooth_joins(Fronts& fronts, const HeightSamples& samples);

/// Sets where snow ends in fronts, from the heights in the last frame.
/// @param thickness thickness of the snow at the points, in metres.
/// @param shown height of the shown snow at the points, in metres.
void find_presence(Fronts& fronts, const SurfacePoints& points, const HeightSamples& samples,
                   const std::vector<float>& thickness, const std::vector<float>& shown,
                   float depth);

}  // namespace snowbough::snow
