#pragma once

// Data that the snow passes read and write on the GPU, declared once for C++ and GLSL.
#include "shared_functions.h"
#include "shared_types.h"

#ifndef SNOWBOUGH_GLSL
namespace snowbough::shared {
#endif

/// A triangle of the scene: its vertices in the scene's position buffer, and its object's slot, with kReceives if the
/// object gathers snow and kTwoSided if the triangle does so on both sides.
struct SceneTriangle {
  uint a;
  uint b;
  uint c;
  uint object;
};
SNOWBOUGH_SHARED_SIZE(SceneTriangle, 16)

/// A receiver's triangle on its map.
struct MapTriangle {
  vec2 uv_a;
  vec2 uv_b;
  vec2 uv_c;
  vec2 unused_row_end;
};
SNOWBOUGH_SHARED_SIZE(MapTriangle, 32)

/// A triangle on the image whose alpha cuts holes into it.
struct AlphaTriangle {
  vec2 uv_a;
  vec2 uv_b;
  vec2 uv_c;
  /// 1 + index of an AlphaMaskHeader; 0 = the triangle is opaque.
  uint mask;
  uint unused_row_end;
};
SNOWBOUGH_SHARED_SIZE(AlphaTriangle, 32)

/// An alpha mask in the buffer of all masks' bits.
struct AlphaMaskHeader {
  uint first_word;
  uint width;
  uint height;
  /// kAlphaRepeat and so on.
  uint extension;
};
SNOWBOUGH_SHARED_SIZE(AlphaMaskHeader, 16)

/// The part of a triangle in a texel.
struct Fragment {
  uint triangle;
  /// Fraction of the triangle's area, 0 to 1.
  float share;
  /// Weights of the triangle's second and third corner at the part's centroid.
  float weight_b;
  float weight_c;
};
SNOWBOUGH_SHARED_SIZE(Fragment, 16)

/// A texel's data in a step.
struct TexelStep {
  /// Gained snow, in units of the step's thickness perpendicular to the fall / kGainUnits: a fully visible texel that
  /// faces the fall gains kGainUnits. Integers, so that the sum over tiles does not depend on their layout. kBackSide:
  /// the snow falls on the back. kMixedSides: the gains of both sides take kMixedBits each, in units of 1 /
  /// kMixedUnits.
  uint gain;
  /// Covered area in m2.
  float area;
  /// Upward part of the normal, 1 on level ground.
  float up;
  /// The same of the back's normal for two-sided parts; 0 without any.
  float back_up;
};
SNOWBOUGH_SHARED_SIZE(TexelStep, 16)

/// The surface that the sky sees in a pixel.
struct SeenPixel {
  /// 1 + triangle with kBackFace, 0 = none.
  uint triangle;
  /// In metres along the fall; kOpenSky without a surface.
  float depth;
};
SNOWBOUGH_SHARED_SIZE(SeenPixel, 8)

/// The projection of one step: the direction of the fall and the grid perpendicular to it. Local pixels are counted
/// from the grid pixel `base`, so that floats stay exact far from the world's origin.
struct ProjectionFrame {
  /// xyz: a point near the scene's middle, subtracted first.
  vec4 anchor;
  /// xy: position of a texel's samples in their cell in this step, 0 to 1.
  vec4 sampling;
  /// xyz: the grid's axes divided by the pixel size; w: the anchor in local pixels.
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
/// The anchor in local pixels.
SNOWBOUGH_SHARED_FUNCTION vec2 anchor_pixel(KERNEL_CONST_REF(ProjectionFrame) frame) {
  return vec2(frame.grid_x.w, frame.grid_y.w);
}
/// Position of a texel's samples in their cell in this step, 0 to 1.
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
/// Mean thickness in metres, perpendicular to the fall, of a step's snow.
SNOWBOUGH_SHARED_FUNCTION float snow_depth(KERNEL_CONST_REF(ProjectionFrame) frame) {
  return frame.range.z;
}
/// Probability, 0 to 1, that a pixel receives snow.
SNOWBOUGH_SHARED_FUNCTION float noise_density(KERNEL_CONST_REF(ProjectionFrame) frame) {
  return frame.range.w;
}

/// Arguments of an indirect dispatch as OpenGL reads them, padded to a row.
struct DispatchIndirectArgs {
  uint groups_x;
  uint groups_y;
  uint groups_z;
  uint unused_row_end;
};
SNOWBOUGH_SHARED_SIZE(DispatchIndirectArgs, 16)

/// Header of a list of groups of texels for a pass; the group numbers follow. `blocks`: one invocation per texel,
/// kBlocksAGroup work groups per group; `whole`: one work group per group. groups_y counts the groups.
struct GroupListHeader {
  DispatchIndirectArgs blocks;
  DispatchIndirectArgs whole;
};
SNOWBOUGH_SHARED_SIZE(GroupListHeader, 32)

/// The work groups of a batch that hold an object's texels.
struct StatisticsSegment {
  uint slot;
  uint first_group;
  uint group_count;
  uint unused_row_end;
};
SNOWBOUGH_SHARED_SIZE(StatisticsSegment, 16)

/// One receiver's balance. Volumes in m3.
struct ObjectSums {
  /// Of the last step. `held_before`: volume at its start, on the surface of that moment.
  double deposited;
  double slid;
  double held;
  double held_before;
  /// Area seen by the sky, perpendicular to the fall, in m2: of faces that gather, and of back faces.
  double visible_area;
  double back_face_area;
  /// Of all steps. `total_stretched`: change of volume from stretching surfaces.
  double total_deposited;
  double total_slid;
  double total_stretched;
  double total_visible_area;
  /// Volume that came onto the map through the air.
  double landed;
  double total_landed;
  /// Volume that masks have refused, that objects have pressed or cleared away, that has melted, and that the wind has
  /// carried away less what it has brought: in the last step all of it, of all steps each kind.
  double removed;
  double total_masked;
  double total_pressed;
  double total_cleared;
  double total_melted;
  double total_drifted;
};
SNOWBOUGH_SHARED_SIZE(ObjectSums, 144)

const uint kReceives = 0x80000000u;
const uint kTwoSided = 0x40000000u;
/// Mask for the slot in a SceneTriangle's `object`.
const uint kSlotBits = 0x3FFFFFFFu;
/// Flags in a TexelStep's gain; gains stay below them: no texel gains more than 3 * kGainUnits.
const uint kBackSide = 0x80000000u;
const uint kMixedSides = 0x40000000u;
const uint kMixedBits = 15u;
const uint kMixedMask = (1u << kMixedBits) - 1u;
const float kMixedUnits = 4096.0f;
const uint kNowhere = 0xFFFFFFFFu;
/// Extension of an alpha image beyond 0 to 1.
const uint kAlphaRepeat = 0u;
const uint kAlphaMirror = 1u;
const uint kAlphaExtend = 2u;
const uint kAlphaClip = 3u;
const uint kBackFace = 0x80000000u;
/// Deeper than any surface.
const float kOpenSky = 3e38f;
/// See TexelStep::gain.
const float kGainUnits = 268435456.0f;
/// Margin of a tile in pixels: points at its edge also sample these pixels of its neighbours.
const int kTileMargin = 1;
/// Texels of a group; an object's texels begin at a multiple of it.
const uint kTexelGroup = 1024u;
/// Work-group size, and number of such blocks in a group of texels.
const uint kBlock = 64u;
const uint kBlocksAGroup = kTexelGroup / kBlock;
/// Position of the group numbers in a list of groups.
const uint kGroupListBegin = 8u;
/// A group's state: snow lies on one of its texels.
const uint kHoldsSnow = 1u;
/// Largest LOCAL_SIZE, see native/snow/step/gl/driver.h.
const uint kMaxLocalSize = 64u;
/// Pixels of a row per work group.
const uint kRowRun = 1024u;

#ifndef SNOWBOUGH_GLSL
}  // namespace snowbough::shared
#endif
