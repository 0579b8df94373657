#pragma once

// What the snow renderer's C++ and its shaders both hold: a receiver's base mesh, whose triangles are patches. Metres,
// Z up. A corner is numbered 3 * patch + 0, 1 or 2.
#include "shared_types.h"
#ifndef SNOWBOUGH_GLSL
namespace snowbough::shared {
#endif

/// Edge of a tile of a map, in texels: for each the deepest snow is known.
const int kSnowTile = 16;
/// Invocations that look for the deepest of all tiles.
const int kDeepestGroup = 64;
/// Texels beyond a place that its height is interpolated from.
const int kSnowReach = 2;

/// A vertex of the base.
struct SnowVertex {
  /// In the pose; w: metres that a texel spans there.
  vec4 position;
  /// In the first pose: what grains of snow are fixed to.
  vec4 rest;
  /// The corners that meet here with another place on the map or another normal: [x, y) of the list; z: the nearest
  /// hard edge, whose faces' normals differ (-1: none).
  ivec4 corners;
  /// Metres to that hard edge, which share along it is nearest, and metres to where the surface ends.
  vec4 rims;
  /// From the facets to the surface that the normals tell of (m), see native/render/snow/bend.h; w: unused.
  vec4 bend;
};
SNOWBOUGH_SHARED_SIZE(SnowVertex, 80)

/// A vertex with its snow.
struct SnowPoint {
  /// On the snow; w: its height, below 0 on the back.
  vec4 position;
  /// Unit: where snow grows to; w: metres to where the surface ends.
  vec4 direction;
  /// Unit: where snow grows to at the nearest hard edge; w: metres to that.
  vec4 rim;
};
SNOWBOUGH_SHARED_SIZE(SnowPoint, 48)

/// An edge of the base: all that its points depend on, so that both of its faces find the same.
struct SnowEdge {
  /// Vertices at t = 0 and 1; 1 where the surface ends here; w: unused.
  ivec4 ends;
  /// Corners of one face at t = 0 and 1, then of the other (the same again where there is none).
  ivec4 corners;
  /// Places on the map of those corners: of one face, and of the other.
  vec4 uv;
  vec4 other_uv;
  /// Texels along it, on the side where they are more.
  vec4 metric;
};
SNOWBOUGH_SHARED_SIZE(SnowEdge, 80)

/// A triangle of the base, anticlockwise seen from its front.
struct SnowPatch {
  /// w: unused.
  ivec4 vertices;
  /// Twice the edge from corner k to k + 1, plus one where it runs the other way; w: unused.
  ivec4 edges;
  vec4 uv_01;
  /// z, w: unused.
  vec4 uv_2;
};
SNOWBOUGH_SHARED_SIZE(SnowPatch, 64)

/// Most of a bend, as a share of the snow's depth: bare facets stay where they are.
const float kMostBend = 0.5f;

/// Metres to a rim that is nowhere.
const float kNoRim = 1e9f;

#ifndef SNOWBOUGH_GLSL
}  // namespace snowbough::shared
#endif
