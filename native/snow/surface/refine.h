#pragma once

#include <cstdint>

#include "snow/surface/rim_zones.h"
#include "snow/surface/rims.h"
#include "snow/surface/surface_mesh.h"

namespace snowbough::snow {

/// The heights that decide where the surface has fine faces, and where it has faces at all.
struct SurfaceHeights {
  /// Heights of the last frame, and the greatest heights of the whole shot: resolution x
  /// resolution, in metres, negative on the back.
  const float* last = nullptr;
  const float* highest = nullptr;
  /// The lowest that snow ever sank to under what pressed it, likewise, in metres over the faces of
  /// `last`; null if nothing did.
  const float* dented = nullptr;
  int32_t resolution = 0;
};

/// Target density of the surface mesh.
struct SurfaceDensity {
  /// Snow depth on open ground in the last frame, in metres.
  float depth = 0.1f;
  /// Factor on all target edge lengths; 1 is the default detail.
  float scale = 1.0f;
  /// Greatest number of points, unless the receiver's own faces that have snow have more.
  int32_t most_points = 200000;
};

/// Numbers of points of two kinds of places.
struct PointCounts {
  /// Where snow ends, at rims, on curved faces, and on level faces with edges of two depths.
  double hems = 0.0;
  /// Further points on level faces.
  double level = 0.0;
};

/// A refined mesh, and the factor by which its hems are coarser than the density asks for.
struct RefinedSurface {
  SurfaceMesh mesh;
  float coarsened = 1.0f;
};

/// Refines the receiver's faces where the snow has fine shapes and keeps them coarse elsewhere. It
/// drops faces that never carry snow, except for a few rings around the snow. Along straight rims
/// the cuts are parallel to the rim. If the mesh exceeds its greatest number of points, the edges
/// of level snow grow first, up to two depths, and those at hems last.
///
/// @param receiver the result of receiver_mesh.
/// @param rims the rims of `receiver`.
RefinedSurface refined_surface(const SurfaceMesh& receiver, const Rims& rims, const RimZones& zones,
                               const SurfaceHeights& heights, const SurfaceDensity& density);

/// Estimates how many points the snow on a receiver needs at the default detail, before any snow is
/// known: from coarse meshes of a cover on all faces that are not too steep. The receivers of a
/// scene share its points by these numbers.
PointCounts wanted_points(const SurfaceSource& source, float depth);
/// The same, of a cover with these heights.
PointCounts wanted_points(const SurfaceMesh& receiver, const Rims& rims, const RimZones& zones,
                          const SurfaceHeights& heights, float depth);

}  // namespace snowbough::snow
