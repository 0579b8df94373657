#pragma once

// Data shared by the tree renderer's C++ and its shaders. Metres, seconds, radians, Z up; positions are in the rest
// pose unless called posed.
#include "shared_types.h"
#include "snow_style.h"
#ifndef SNOWBOUGH_GLSL
#include <glm/mat4x4.hpp>
namespace snowbough::shared {
using glm::mat4;
#endif

/// Classes of a patch, in the order of their counts and draws.
const uint kDropped = 0u;
const uint kPlain = 1u;
const uint kTessellated = 2u;
/// Items of a work group.
const uint kPatchGroup = 64u;

/// Metrics of the tessellation: the thesis's, and projected lengths.
const uint kMetricThesis = 0u;
const uint kMetricScreen = 1u;

/// A vertex of the four-sided base, already on the limbs' radius.
struct TreeVertex {
  /// w: amplitude of the bark's displacement in metres; 0 where the bark's coordinates are discontinuous.
  vec4 position;
  /// Unit; w: circumference of the limb in metres.
  vec4 normal;
  /// The bark's coordinates; z, w: as integer bits, begin and end of its coordinates on the snow map in a list.
  vec4 bark_uv;
  ivec4 bones;
  vec4 weights;
};
SNOWBOUGH_SHARED_SIZE(TreeVertex, 80)

/// A posed vertex: its position including bark, and the three rows of its blended bone matrix.
struct PosedVertex {
  vec4 position;
  vec4 normal;
  vec4 row_x;
  vec4 row_y;
  vec4 row_z;
};
SNOWBOUGH_SHARED_SIZE(PosedVertex, 80)

/// A section of a limb as a round cone, see on_limb.
struct TreeSection {
  /// w: length.
  vec4 begin;
  /// Unit; w: 1 if it begins at a hole in its parent's side.
  vec4 axis;
  /// At begin and end; z: length over which a section from a hole becomes round.
  vec4 radii;
};
SNOWBOUGH_SHARED_SIZE(TreeSection, 48)

/// An edge of the base with all inputs of its points, so that both faces compute the same.
struct TreeEdge {
  /// Vertices at t = 0 and 1, and the one or two sections on whose radius it lies (-1: none).
  ivec4 ends;
  /// Offsets near t = 0 and t = 1 that make the edge reach its vertices; w: 1 if it runs around the limb.
  vec4 first_rest;
  vec4 last_rest;
  /// The bark's coordinates at t = 0 and 1.
  vec4 bark_uv;
  /// Mean area of its faces (m2), their lowest branch level, 1 if the bark's coordinates are continuous across it.
  vec4 metric;
  /// Places on the snow map at t = 0 and 1, of one face and of the other.
  vec4 snow_uv;
  vec4 other_snow_uv;
};
SNOWBOUGH_SHARED_SIZE(TreeEdge, 112)

/// Kinds of patches: ends, walls, where u runs around the limb, and insets beside a child's hole, whose v = 1 lies on
/// the hole's rim; u runs around the limb at v = 0 or not at all.
const int kCapPatch = 0;
const int kWallPatch = 1;
const int kRoundInset = 2;
const int kFlatInset = 3;

/// Four control points, anticlockwise seen from outside: (u, v) = (0, 0), (1, 0), (1, 1), (0, 1).
struct TreePatch {
  ivec4 vertices;
  /// Twice the edge from corner k to k + 1, plus one if it runs the other way.
  ivec4 edges;
  /// Section (-1: flat), branch level, branch, kind: kCapPatch and so on.
  ivec4 limb;
  /// The bark's coordinates of corners 0 and 1, 2 and 3.
  vec4 bark_uv_01;
  vec4 bark_uv_23;
  /// Coordinates on the snow map of corners 0 and 1, 2 and 3.
  vec4 snow_uv_01;
  vec4 snow_uv_23;
  /// Offsets near each corner that make the patch reach its vertices; w of the first: its area (m2), of the second:
  /// maximum distance of its interior from the corners' hull, including bark, of the third: its number, see
  /// lib/thin_limbs.h.
  vec4 rest[4];
  /// Offset of the normal in the middle: caps point along their limb.
  vec4 normal;
};
SNOWBOUGH_SHARED_SIZE(TreePatch, 192)

/// Material image of a patch: coordinates of corners 0 and 1, 2 and 3, and the image's layer (x).
struct BarkUv {
  vec4 uv_01;
  vec4 uv_23;
  vec4 layer;
};
SNOWBOUGH_SHARED_SIZE(BarkUv, 48)

/// The view of a picture and the parameters of its passes, in a uniform block.
struct TreeView {
  mat4 clip_from_world;
  /// Of the shadow map.
  mat4 shadow_from_world;
  /// Inwards; a point p is inside of all when dot(plane, vec4(p, 1)) >= 0.
  vec4 planes[6];
  /// The camera's eye, also for the shadow map; w: pixels that a metre covers at one metre's distance.
  vec4 eye;
  /// Metric, highest level, target (pixels), size in pixels below which a patch is dropped.
  vec4 tessellation;
  /// Of eq. 3.4.1: farthest distance Mtd, largest area Mfa (0: that of the tree); w: 1 if distant levels are dropped.
  vec4 thesis;
  /// Unit vector towards the sun; w: 1 if there is a shadow map.
  vec4 sun_direction;
  vec4 sun_color;
  /// w: 1 if the target takes linear light instead of sRGB.
  vec4 sky_color;
  vec4 ground_color;
  /// Factor m of the thesis's 4.2.2; w: 1 if plain patches that show their back are dropped.
  vec4 snow;
  /// The viewpoint if w is 1; the direction to it if w is 0.
  vec4 viewer;
};
SNOWBOUGH_SHARED_SIZE(TreeView, 368)

/// An instance of a tree in a frame: where it stands, and where its data begin in the buffers of all trees.
struct TreeInstance {
  /// Rows of the matrix from the space of the pose to the world.
  vec4 to_world[3];
  /// First vertex, edge, patch and section of the base.
  ivec4 base;
  /// First posed vertex, edge level, patch growth, and bone.
  ivec4 own;
  /// First coordinates of vertices on the snow map, first on the bark's images.
  ivec4 lists;
  /// Width and height of the snow map in texels (0: no snow), and its first page.
  ivec4 map;
  /// Linear colours of furrows and ridges; w: area of the largest patch (m2), number of branch levels.
  vec4 bark_dark;
  vec4 bark_light;
  /// Metres of snow on open level ground, now and at the shot's end.
  vec4 snow;
  SnowStyle style;
};
SNOWBOUGH_SHARED_SIZE(TreeInstance, 160 + sizeof(SnowStyle))

/// Successive items (vertices, edges, patches or triangles of leaves) of an instance that a pass works on. A range
/// begins with a work group, so that all items of a work group are of one instance.
struct WorkRange {
  int first_slot;
  int instance;
  int first_item;
  int count;
};
SNOWBOUGH_SHARED_SIZE(WorkRange, 16)

/// Successive work groups of a list that are drawn together, and their draws of tessellated patches.
struct DrawBatch {
  int first_group;
  int end_group;
  int first_draw;
  int draws;
};
SNOWBOUGH_SHARED_SIZE(DrawBatch, 16)

/// How a thin plain patch is drawn, see lib/thin_limbs.h.
struct PatchGrowth {
  /// w: factor of the limb's width.
  vec4 middle;
  /// Factor of its length.
  vec4 along;
};
SNOWBOUGH_SHARED_SIZE(PatchGrowth, 32)

/// glDrawArraysIndirect's arguments.
struct TreeDrawCommand {
  uint count;
  uint instances;
  uint first;
  uint base_instance;
};
SNOWBOUGH_SHARED_SIZE(TreeDrawCommand, 16)

#ifndef SNOWBOUGH_GLSL
}  // namespace snowbough::shared
#endif
