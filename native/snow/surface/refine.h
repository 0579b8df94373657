#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "snow/surface/rim_zones.h"
#include "snow/surface/rims.h"
#include "snow/surface/surface_mesh.h"

namespace snowbough::snow {

/// The heights that decide where the surface is fine, and where it is at all.
struct SurfaceHeights {
  /// Of the last frame and the greatest of the whole shot, metres, negative on the back; resolution
  /// x resolution.
  const float* last = nullptr;
  const float* highest = nullptr;
  int32_t resolution = 0;
};

/// How fine a surface is made.
struct SurfaceDensity {
  /// Depth of the snow on open ground in the last frame, metres.
  float depth = 0.1f;
  /// Factor on all lengths of edges: 1 is the default detail.
  float scale = 1.0f;
  /// Points that may not be exceeded by much; lengths grow until that holds.
  int32_t most_points = 200000;
};

/// Cuts the receiver's faces finely where snow is shaped finely and coarsely elsewhere, and leaves
/// out what never has snow but for a few rings. Along straight rims the cuts are parallel to them.
///
/// @param receiver receiver_mesh. @param rims of it.
SurfaceMesh refined_surface(const SurfaceMesh& receiver, const Rims& rims, const RimZones& zones,
                            const SurfaceHeights& heights, const SurfaceDensity& density);

/// About how many points the snow of a receiver would take at default detail, before any is known:
/// what it shares the scene's points by.
double wanted_points(const SurfaceMesh& receiver, const Rims& rims, float depth);
double wanted_points(const SurfaceSource& source, float depth);

}  // namespace snowbough::snow
