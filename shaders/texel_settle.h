#pragma once

// Adds a texel's deposit of the step to its height and lets slide what the slope cannot hold: equation 4.2.2
// of D. T. Reynolds, Real-Time Rendering and Simulation of Trees and Snow, 2014, solved in closed form, so
// that the result does not depend on the length of a step.
//
// LAST_TILE: the shares of the step's last (mostly only) tile are worked out here, which saves a pass.
// DEPOSIT_MAP: the deposit lies on a map of its own.
// EARLIER_TILES: shares of further tiles wait in DepositShare.
#include "kernel.h"
#include "snow_shared.h"
#ifdef LAST_TILE
#include "texel_share.h"
#endif

#ifndef DEPOSIT_MAP
/// Left at 0 for the next step; read as a texture, which llvmpipe reads a whole vector at once from.
KERNEL_BLOCK_WRITEONLY(DepositUnits, uint, deposit_units);
KERNEL_VIEW_R32UI(units_before);
KERNEL_UNIFORM(float, step_depth);
#endif
#ifdef EARLIER_TILES
/// Read, and left at 0 for the next step.
KERNEL_BLOCK(DepositShare, float, deposit_share);
#endif
/// A TexelStep each.
KERNEL_VIEW_RGBA32UI(texel_steps);
KERNEL_UNIFORM(float, max_depth);
/// Seconds; the half-life is positive.
KERNEL_UNIFORM(float, dt);
KERNEL_UNIFORM(float, half_life);

/// (1 - 2^(-t / half_life)) / (t ln 2 / half_life): the part of a steady deposit that stays.
float staying_part(float t) {
  const float x = 0.69314718f * t / half_life;
  return x < 1e-2f ? 1.0f - x * (0.5f - x * (1.0f / 6.0f - x / 24.0f)) : (1.0f - exp(-x)) / x;
}

/// Parts of the whole step: of what is too much, that slides off; of a steady deposit, that stays.
struct WholeStep {
  float slides;
  float stays;
};

WholeStep whole_step() { return KERNEL_MAKE2(WholeStep, 1.0f - exp2(-dt / half_life), staying_part(dt)); }

float settle(float height, float deposit, float capacity, WholeStep whole) {
  if (height >= capacity) {
    // What goes is taken from the height, not what stays added to the capacity: beside a capacity of
    // metres past vertical a float would round the height away.
    return max(0.0f, height - (height - capacity) * whole.slides + deposit * whole.stays);
  }
  if (height + deposit <= capacity) {
    return height + deposit;
  }
  const float after_crossing = 1.0f - (capacity - height) / deposit;
  return capacity + deposit * after_crossing * staying_part(dt * after_crossing);
}

/// A texel's deposit in a step.
struct TexelDeposit {
  /// In metres.
  float thickness;
  /// 1 where its fixed-point sum was full, else 0.
  float saturated;
};

#ifndef DEPOSIT_MAP
/// The texel's deposit of the whole step; leaves the sums at 0.
TexelDeposit take_deposit(int index, uvec4 step) {
  const uint units = texelFetch(units_before, index).x;
  const float laid = float(units) * (step_depth / kDepthUnits);
  TexelDeposit deposit = KERNEL_MAKE2(TexelDeposit, laid, units == kNowhere ? 1.0f : 0.0f);
  if (units != 0u) {
    deposit_units[index] = 0u;
  }
#ifdef LAST_TILE
  if (KERNEL_IS_BOUND(weight_sum) && step.y != 0u) {
    deposit.thickness += share_of(uvec2(step), uintBitsToFloat(step.z));
  }
#endif
#ifdef EARLIER_TILES
  const float share = KERNEL_IS_BOUND(deposit_share) ? deposit_share[index] : 0.0f;
  if (share != 0.0f) {
    deposit.thickness += share;
    deposit_share[index] = 0.0f;
  }
#endif
  return deposit;
}
#endif

/// What a step does to a texel.
struct SettledTexel {
  float height;
  /// What it adds to the step's sums: deposited, slid and held volume in m3, number of saturated texels.
  vec4 sums;
};

SettledTexel settle_texel(float height, TexelDeposit deposit, uvec4 step, WholeStep whole) {
  const float area = uintBitsToFloat(step.z);
  const float settled = settle(height, deposit.thickness, max_depth * uintBitsToFloat(step.w), whole);
  const vec4 sums = vec4(deposit.thickness * area, (height + deposit.thickness - settled) * area,
                         settled * area, deposit.saturated);
  return KERNEL_MAKE2(SettledTexel, settled, sums);
}
