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
  int32_t resolution = 0;
};

/// Target density of the surface mesh.
struct SurfaceDensity {
  /// Snow depth on open ground in the last frame, in metres.
  float depth = 0.1f;
  /// Factor on all target edge lengths; 1 is the default detail.
  float scale = 1.0f;
  /// Approximate limit on the number of points. Edge lengths grow until the mesh fits.
  int32_t most_points = 200000;
};

/// Refines the receiver's faces where the snow has fine shapes and keeps them coarse elsewhere. It
/// drops faces that never carry snow, except for a few rings around the snow. Along straight rims
/// the cuts are parallel to the rim.
///
/// @param receiver the result of receiver_mesh.
/// @param rims the rims of `receiver`.
SurfaceMesh refined_surface(const SurfaceMesh& receiver, const Rims& rims, const RimZones& zones,
                            const SurfaceHeights& heights, const SurfaceDensity& density);

/// Estimates how many points the snow on a receiver needs at the default detail, before any snow is
/// known. The scene's point budget is divided in proportion to this number.
double wanted_points(const SurfaceMesh& receiver, const Rims& rims, float depth);
double wanted_points(const SurfaceSource& source, float depth);

}  // namespace snowbough::snow
