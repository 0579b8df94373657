#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "base/simd.h"
#include "snow/output/smoothing_grid.h"

// The inner loops of Smoother over runs of cells. Arrays begin at cell 0 and have a margin.
namespace snowbough::snow {

/// Maximum fraction of a height difference exchanged per link per stage.
inline constexpr float kStageShare = 0.2f;
/// Stages of a level on the way up and on the way down.
inline constexpr int32_t kStagesUp = 1;
inline constexpr int32_t kStagesDown = 3;
inline constexpr auto kStages = static_cast<float>(kStagesUp + kStagesDown);
/// A link to a cell with less than this fraction of the snow is closed.
inline constexpr float kMinPart = 0.02f;
inline float third_squared(float height) {
  return height * height * (1.0f / 9.0f);
}

/// Whether snow may cross a link between these heights.
inline bool is_open(float a, float b) {
  const float one = std::fabs(a);
  const float other = std::fabs(b);
  const float less = one < other ? one : other;
  const float more = one < other ? other : one;
  return (a * b > 0.0f) & (less > kMinPart * more);
}

/// Least variance in m2; variance that finer levels provide; number of stages.
struct ConductanceTerms {
  float least_variance;
  float done_below;
  float stages;
};

struct LinkConductance {
  float conductance;
  /// Half the variance over distance^2.
  float wanted;
};

inline LinkConductance conductance(float a, float b, float inverse_a, float inverse_b,
                                   float closeness, const ConductanceTerms& terms) {
  const float one = third_squared(a);
  const float other = third_squared(b);
  const float less = one < other ? one : other;
  const float wanted =
      0.5f * (less > terms.least_variance ? less : terms.least_variance) * closeness;
  const float most = kStageShare * terms.stages;
  float own = wanted - terms.done_below;
  own = own > 0.0f ? own : 0.0f;
  own = own < most ? own : most;
  const float inverse = inverse_a > inverse_b ? inverse_a : inverse_b;
  const bool open = is_open(a, b);
  return {open ? own / (terms.stages * inverse) : 0.0f, open ? wanted : 0.0f};
}

/// Closeness of the links of a level's grid.
struct ClosenessView {
  const uint16_t* right;
  const uint16_t* above;
  ptrdiff_t size;
};

bool holds_anything(const float* values, int32_t count);
/// Loads heights where there is a surface.
void load_run(const float* map, const float* inverse_area, float* height, float* inverse_weight,
              int32_t begin, int32_t end);
/// Computes the conductances to the right and above. Returns the largest LinkConductance::wanted.
float conduct_run(const float* height, const float* inverse, const ClosenessView& closeness,
                  float* right, float* above, const ConductanceTerms& terms, int32_t begin,
                  int32_t end);
/// Stores heights where there is a surface.
void store_run(const float* height, const float* inverse_area, float* map, int32_t begin,
               int32_t end);
void stage_run(const float* from, float* to, const float* right, const float* above,
               const float* inverse, ptrdiff_t size, int32_t begin, int32_t end);

/// New height of a cell when the mean of its block changes from `before` to `now` and its deviation
/// from the mean is scaled by `kept`.
inline float changed(float height, float before, float now, float kept) {
  return now * (1.0f + kept * (height / before - 1.0f));
}

/// Two rows of a level's cells, starting at the first block of a run of the next level. `joins`
/// marks the cells of a 2 x 2 block that are merged: those of its chart whose snow is not too thin
/// compared with the block's deepest.
struct BlockRows {
  const float* inverse[2];
  const uint8_t* joins[2];
};

/// Input for damping the differences within blocks: the blocks' closeness; see ConductanceTerms.
struct DampingTerms {
  const uint16_t* right;
  const uint16_t* above;
  float least_variance;
  float done_below;
};

/// Weighted means of blocks, and 1 / their weights.
void restrict_run(const float* low, const float* high, const BlockRows& rows, float* mean,
                  float* inverse, int32_t count);
/// Applies the change of the means to the cells.
void prolong_run(float* low, float* high, const BlockRows& rows, const float* before,
                 const float* now, const DampingTerms& terms, int32_t count);

/// Factor by which differences within a block are damped: about a Gaussian's response at that
/// wavelength. `wanted`: half the block's variance over distance^2.
inline float damping(float wanted, float done_below) {
  const float left = wanted > done_below ? wanted - done_below : 0.0f;
  return 1.0f / (1.0f + 2.0f * left * (1.0f + left));
}
inline float damping(float before, float closeness, float least_variance, float done_below) {
  const float wanted = 0.5f * third_squared(before) * closeness;
  const float least = 0.5f * least_variance * closeness;
  return damping(wanted > least ? wanted : least, done_below);
}

}  // namespace snowbough::snow
