#pragma once

// What the snow passes read and write on the GPU, declared once for C++ and GLSL.
#include "shared_functions.h"
#include "shared_types.h"

#ifndef SNOWBOUGH_GLSL
namespace snowbough::shared {
#endif

/// A triangle of the scene: its vertices in the scene's position buffer, and its object's slot with
/// kReceives set when that object gathers snow and kTwoSided when the triangle does so on both sides.
struct SceneTriangle {
  uint a;
  uint b;
  uint c;
  uint object;
};
SNOWBOUGH_SHARED_SIZE(SceneTriangle, 16)

/// How a receiver's triangle lies on its map. `home` and `chart` are for GEOMETRY only.
struct MapTriangle {
  vec2 uv_a;
  vec2 uv_b;
  vec2 uv_c;
  /// 1 + index (within the map group) of the texel that holds most of the triangle; 0 = none.
  uint home;
  /// Number of its chart within its object.
  uint chart;
};
SNOWBOUGH_SHARED_SIZE(MapTriangle, 32)

/// How a triangle lies on the image whose alpha cuts holes into it.
struct AlphaTriangle {
  vec2 uv_a;
  vec2 uv_b;
  vec2 uv_c;
  /// 1 + index of an AlphaMaskPlace; 0 = the triangle is opaque.
  uint mask;
  uint unused_row_end;
};
SNOWBOUGH_SHARED_SIZE(AlphaTriangle, 32)

/// An alpha mask among all masks' bits.
struct AlphaMaskPlace {
  uint first_word;
  uint width;
  uint height;
  /// kAlphaRepeat and so on.
  uint extension;
};
SNOWBOUGH_SHARED_SIZE(AlphaMaskPlace, 16)

/// A part of a triangle that a texel holds.
struct Fragment {
  uint triangle;
  /// Of the triangle's area, 0 to 1.
  float share;
  /// Weights of the triangle's second and third corner at the part's centroid.
  float weight_b;
  float weight_c;
};
SNOWBOUGH_SHARED_SIZE(Fragment, 16)

/// What a step finds out about a texel.
struct TexelStep {
  /// What falls on it, in units of the step's thickness perpendicular to the fall / kGainUnits: a texel
  /// that faces the fall and is seen as a whole gains kGainUnits. Integers, so that the sum over tiles does
  /// not depend on how they were cut. With kBackSide where it falls on the back; with kMixedSides what falls on
  /// front and back lies in kMixedBits each, in units of 1 / kMixedUnits.
  uint gain;
  /// Covered area in m2.
  float area;
  /// Upward part of the normal, 1 on level ground.
  float up;
  /// The same of the back's normal, of what is two-sided; 0 where nothing is.
  float back_up;
};
SNOWBOUGH_SHARED_SIZE(TexelStep, 16)

/// What the sky sees in a pixel.
struct SeenPixel {
  /// 1 + triangle with kBackFace, 0 = nothing.
  uint triangle;
  /// In metres along the fall; kOpenSky where there is nothing.
  float depth;
};
SNOWBOUGH_SHARED_SIZE(SeenPixel, 8)

/// How one step is projected: the direction of the fall and the grid across it. Local pixels are counted from the grid pixel `base`, so that floats stay
/// exact far away from the world's origin.
struct ProjectionFrame {
  /// xyz: a point near the scene's middle, subtracted first.
  vec4 anchor;
  /// xy: where in its cell a texel's samples lie in this step, 0 to 1.
  vec4 sampling;
  /// xyz: the grid's axes divided by the pixel size; w: the anchor's place in local pixels.
  vec4 grid_x;
  vec4 grid_y;
  /// xyz: the unit direction of the fall; w: pixel size in metres.
  vec4 direction;
  /// x: smallest depth along the fall, y: 1 / (largest - smallest), z: depth on level ground divided
  /// by max(|d.z|, 0.01), w: noise density.
  vec4 range;
  /// The grid pixel that is local pixel (0, 0).
  ivec2 base;
  uint seed;
  uint step_number;
};
SNOWBOUGH_SHARED_SIZE(ProjectionFrame, 112)

/// Width of a pixel in metres.
SNOWBOUGH_SHARED_FUNCTION float pixel_size(KERNEL_CONST_REF(ProjectionFrame) frame) {
  return frame.direction.w;
}
/// Where the anchor lies, in local pixels.
SNOWBOUGH_SHARED_FUNCTION vec2 anchor_pixel(KERNEL_CONST_REF(ProjectionFrame) frame) {
  return vec2(frame.grid_x.w, frame.grid_y.w);
}
/// Where in its cell a texel's sample lies in this step, 0 to 1.
SNOWBOUGH_SHARED_FUNCTION vec2 cell_shift(KERNEL_CONST_REF(ProjectionFrame) frame) {
  return vec2(frame.sampling.x, frame.sampling.y);
}
/// Smallest depth of the scene along the fall, in metres.
SNOWBOUGH_SHARED_FUNCTION float least_depth(KERNEL_CONST_REF(ProjectionFrame) frame) {
  return frame.range.x;
}
/// 1 / (largest - smallest depth of the scene), per metre.
SNOWBOUGH_SHARED_FUNCTION float one_over_depth(KERNEL_CONST_REF(ProjectionFrame) frame) {
  return frame.range.y;
}
/// Thickness perpendicular to the fall that a step brings in the mean, in metres.
SNOWBOUGH_SHARED_FUNCTION float snow_depth(KERNEL_CONST_REF(ProjectionFrame) frame) {
  return frame.range.z;
}
/// Probability, 0 to 1, with which snow falls through a pixel.
SNOWBOUGH_SHARED_FUNCTION float noise_density(KERNEL_CONST_REF(ProjectionFrame) frame) {
  return frame.range.w;
}

/// The arguments of a dispatch as OpenGL reads them, and the end of their row.
struct DispatchIndirectArgs {
  uint groups_x;
  uint groups_y;
  uint groups_z;
  uint unused_row_end;
};
SNOWBOUGH_SHARED_SIZE(DispatchIndirectArgs, 16)

/// The head of a list of groups of texels that a pass works on; their numbers follow. `blocks`: an
/// invocation a texel, kBlocksAGroup work groups each; `whole`: one work group each. groups_y counts them.
struct GroupListHeader {
  DispatchIndirectArgs blocks;
  DispatchIndirectArgs whole;
};
SNOWBOUGH_SHARED_SIZE(GroupListHeader, 32)

/// Which work groups of a batch hold an object's texels.
struct StatisticsSegment {
  uint slot;
  uint first_group;
  uint group_count;
  uint unused_row_end;
};
SNOWBOUGH_SHARED_SIZE(StatisticsSegment, 16)

/// One receiver's balance. Volumes in m3.
struct ObjectSums {
  /// Of the last step. `held_before` is what lay there when it began, measured then.
  double deposited;
  double slid;
  double held;
  double held_before;
  /// Perpendicular to the fall, in m2: seen by the sky, of front and of back faces.
  double visible_area;
  double back_face_area;
  /// Of all steps. `total_stretched` is the change of volume by stretching surfaces.
  double total_deposited;
  double total_slid;
  double total_stretched;
  double total_visible_area;
  double unused_end[6];
};
SNOWBOUGH_SHARED_SIZE(ObjectSums, 128)

const uint kReceives = 0x80000000u;
const uint kTwoSided = 0x40000000u;
/// What is left of a SceneTriangle's `object` without them: the slot.
const uint kSlotBits = 0x3FFFFFFFu;
/// In a TexelStep's gain, which is less than these: no texel gains more than 3 * kGainUnits.
const uint kBackSide = 0x80000000u;
const uint kMixedSides = 0x40000000u;
const uint kMixedBits = 15u;
const uint kMixedMask = (1u << kMixedBits) - 1u;
const float kMixedUnits = 4096.0f;
const uint kNowhere = 0xFFFFFFFFu;
/// How an alpha image goes on beyond 0 to 1.
const uint kAlphaRepeat = 0u;
const uint kAlphaMirror = 1u;
const uint kAlphaExtend = 2u;
const uint kAlphaClip = 3u;
const uint kBackFace = 0x80000000u;
/// Deeper than anything.
const float kOpenSky = 3e38f;
/// See TexelStep::gain.
const float kGainUnits = 268435456.0f;
/// Pixels on every side of a tile that its neighbours own: what lies at its edge looks at them, too.
const int kTileMargin = 1;
/// Texels a work group handles; an object's texels begin at a multiple of it.
const uint kTexelGroup = 1024u;
/// Invocations of a work group, and how many such blocks make a group of texels.
const uint kBlock = 64u;
const uint kBlocksAGroup = kTexelGroup / kBlock;
/// Where the numbers begin in a list of groups.
const uint kGroupListBegin = 8u;
/// A group's state: snow lies on one of its texels.
const uint kHoldsSnow = 1u;
/// Work groups in one direction that OpenGL promises for a dispatch.
const uint kMostGroups = 65535u;
/// Largest LOCAL_SIZE, see native/snow/step/gl/driver.h.
const uint kMaxLocalSize = 64u;
/// Pixels of a row that a work group takes.
const uint kRowRun = 1024u;

#ifndef SNOWBOUGH_GLSL
}  // namespace snowbough::shared
#endif
