#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "shaders/lib/snow_surface.h"
#include "snow/surface/cushions.h"
#include "snow/surface/folds.h"
#include "snow/surface/fronts.h"
#include "snow/surface/height_samples.h"
#include "snow/surface/point_looks.h"
#include "snow/surface/refine.h"
#include "snow/surface/surface_faces.h"
#include "snow/surface/surface_mesh.h"
#include "snow/surface/surface_points.h"
#include "snow/surface/volume_balance.h"

namespace snowbough::snow {

/// Inputs that determine the faces of a surface. The faces stay the same for the whole shot.
struct SurfacePlan {
  SurfaceDensity density;
  /// Seed of the noise, so that receivers differ.
  uint32_t seed = 0;
  /// Horizontal part of the unit vector of the snowfall's direction, averaged over the shot. Rims
  /// on the lee side get cornices.
  glm::vec2 wind{0.0f};

  /// Offset of positions in noise space, as a fraction of the depth, so that receivers differ.
  glm::vec3 noise_shift() const {
    return glm::vec3(0.31f, 0.77f, 0.53f) * static_cast<float>(seed % 9973u);
  }
};

/// A frame of the shot.
struct SurfaceFrame {
  /// Heights in metres, negative on the back, resolution x resolution.
  const float* height = nullptr;
  /// Snow depth on open level ground, in metres.
  float open_depth = 0.0f;
  /// The receiver's vertices in world space, in metres. Null if the receiver only moved rigidly
  /// since the plan's pose.
  const glm::vec3* positions = nullptr;
  /// The direction up in the plan's pose, for a receiver that moves rigidly and tilts.
  glm::vec3 up{0.0f, 0.0f, 1.0f};
  /// Matrix to the space of the result: from world space (with `positions`) or from the plan's pose
  /// (without `positions`), both in metres.
  glm::mat4 to_result{1.0f};
};

/// The snow surface of one receiver: what stays the same for the whole shot. Its points are those
/// on the receiver, then those of the cushions.
struct SnowSurface {
  SurfacePoints points;
  HeightSamples samples;
  /// Places within which the drawn snow has the volume of the map, and what blankets fill.
  VolumeBalance volume, wide_volume;
  PointLooks looks;
  Fronts fronts;
  Folds folds;
  Cushions cushions;
  SurfaceFaces faces;
  /// The receiver's triangles and, in the planned pose, its vertices.
  std::vector<int32_t> triangles;
  std::vector<glm::vec3> positions;
  /// Factor by which hems are coarser than the plan's density asks for, for lack of points.
  float coarsened = 1.0f;

  size_t point_count() const { return points.count() + cushions.anchor.size(); }
};

/// Makes the surface once, from the receiver's pose and the heights in the shot's last frame.
/// @param dents  by how much the snow ever lay lower than before, of the whole shot, in metres: the
///   surface is finer and less smoothed at the walls of prints and tracks; empty: there are none.
/// @param neighbours  other receivers near this one, with the snow of `last`.
/// @throws std::invalid_argument if a map does not have resolution^2 texels, or if the positions or
/// the shading do not match the source.
SnowSurface plan_surface(const SurfaceSource& source, const std::vector<float>& last,
                         const std::vector<float>& highest, const std::vector<float>& dents,
                         const SurfacePlan& plan, const std::vector<Neighbour>& neighbours = {});

/// Heights of one frame at the points on the receiver, in metres.
struct SurfaceHeightsNow {
  /// Thickness from the map, smoothed.
  std::vector<float> thickness;
  /// Height of the shown snow; not over 0 at bare points.
  std::vector<float> shown;
  /// Factor in it that keeps the volume.
  std::vector<float> factor;
  /// Per front: how far the blanket has its shape, 0 to 1, and the blanket's unit normal.
  std::vector<float> blanket;
  std::vector<glm::vec3> blanket_up;
};
/// @param up upward components of the points' normals.
SurfaceHeightsNow heights_now(const SnowSurface& surface, const shared::SnowStyle& style,
                              const SurfaceFrame& frame, const std::vector<float>& up);

/// The points of the faces in a frame, by the formula of shaders/lib/snow_surface.h. The same input
/// gives the same points for any number of threads.
/// @param style the artist's settings; the faces do not depend on them.
std::vector<glm::vec3> surface_points(const SnowSurface& surface, const shared::SnowStyle& style,
                                      const SurfaceFrame& frame);

/// Unit normals of points: the area-weighted mean over the triangles of each point, or straight up
/// if a point has no triangles.
/// @throws std::invalid_argument if a triangle has an index without a point.
std::vector<glm::vec3> point_normals(const std::vector<glm::vec3>& points,
                                     const std::vector<glm::ivec3>& triangles);

}  // namespace snowbough::snow
