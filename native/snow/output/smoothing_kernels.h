#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>

#include "base/simd.h"
#include "snow/output/smoothing_grid.h"

// The loops of Smoother over runs of cells. Arrays begin at cell 0 and have a margin around them.
namespace snowbough::snow {

/// What of a difference crosses a link in a stage, at most.
inline constexpr float kStageShare = 0.2f;
/// Stages of a level on the way up and on the way down.
inline constexpr int32_t kStagesUp = 1;
inline constexpr int32_t kStagesDown = 3;
inline constexpr auto kStages = static_cast<float>(kStagesUp + kStagesDown);
/// A neighbour that holds less than this part is no neighbour.
inline constexpr float kLeastPart = 0.02f;
/// Width of a shoulder in standard deviations.
inline constexpr float kShoulder = 1.0f;
/// Sigma in a bank, in parts of the distance to its foot, at most. A straight bank gets steeper by
/// this squared, one round a corner by half as much again: 0.4 degrees of 65.
inline constexpr float kFootSigmaShare = 0.1f;
/// How near a foot is that matters, in cells: a level's stages spread snow by less than a tenth.
inline constexpr float kFootRange = 15.0f;
/// How near a foot is, is noted in parts of a cell: from kAtFoot, at the foot, to 1; 0: further
/// away than kFootRange.
inline constexpr int32_t kProximitySteps = 8;
inline constexpr int32_t kAtFoot = static_cast<int32_t>(kFootRange) * kProximitySteps + 1;
/// What ends in slopes under 40 degrees is no feet.
inline constexpr float kLeastFootSlope = 0.84f;
/// Snow that ends higher than so many cells (a bank of 80 degrees does not) ends in a cliff.
inline constexpr float kHighestFoot = 6.0f;
/// More links from the edge than any shoulder is wide.
inline constexpr uint8_t kFarFromEdge = 200;

inline float third_squared(float height) {
  return height * height * (1.0f / 9.0f);
}

/// Whether snow may cross a link between these heights.
inline bool is_open(float a, float b) {
  const float one = std::fabs(a);
  const float other = std::fabs(b);
  const float less = one < other ? one : other;
  const float more = one < other ? other : one;
  return (a * b > 0.0f) & (less > kLeastPart * more);
}

/// m2; what lower levels see to and in how many stages.
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

/// Half the variance over distance^2 that is let through so many cells from a bank's foot.
inline float foot_limit(float cells) {
  return 0.5f * kFootSigmaShare * kFootSigmaShare * cells * cells;
}

/// kFootRange beyond banks.
inline float cells_to_foot(uint8_t proximity) {
  const float cells =
      static_cast<float>(kAtFoot - proximity) * (1.0f / static_cast<float>(kProximitySteps));
  return cells < kFootRange ? cells : kFootRange;
}

/// What a bank lets through a link at most; beyond banks more than any link conducts.
inline float foot_conductance(uint8_t proximity_a, uint8_t proximity_b, float inverse_a,
                              float inverse_b, float closeness, const ConductanceTerms& terms) {
  const float limit = foot_limit(0.5f * (cells_to_foot(proximity_a) + cells_to_foot(proximity_b)));
  const float least = 0.5f * terms.least_variance * closeness;
  const float own = (limit > least ? limit : least) - terms.done_below;
  const float inverse = inverse_a > inverse_b ? inverse_a : inverse_b;
  const float most = (own > 0.0f ? own : 0.0f) / (terms.stages * inverse);
  return (proximity_a | proximity_b) != 0 ? most : std::numeric_limits<float>::infinity();
}

/// Closeness of the links of a level's grid.
struct ClosenessView {
  const uint16_t* right;
  const uint16_t* above;
  ptrdiff_t size;
};

/// The closest of a cell's links on the grid.
inline float closest_link(const ClosenessView& closeness, int32_t i) {
  return from_half(std::max({closeness.right[i], closeness.above[i], closeness.right[i - 1],
                             closeness.above[i - closeness.size]}));
}

/// What is noted of a link: that snow may cross it; or, where it is there but closed, which of its
/// ends are an edge of snow, the deeper one or both.
inline constexpr uint8_t kOpenLink = 128;
inline constexpr uint8_t kOwnEdge = 1;
inline constexpr uint8_t kOtherEdge = 2;

/// Per cell: links to the nearest edge; what is noted of the link to the right and above.
struct EdgeArrays {
  uint8_t* distance;
  uint8_t* right;
  uint8_t* above;
};

bool holds_anything(const float* values, int32_t count);
/// Takes heights in where there is surface.
void load_run(const float* map, const float* inverse_area, float* height, float* inverse_weight,
              int32_t begin, int32_t end);
/// Notes the links upwards alone.
void open_upwards_run(const float* height, const ClosenessView& closeness, uint8_t* above,
                      int32_t begin, int32_t end);
/// Notes the links of a run and the one that leads into it from the left. Returns whether a cell
/// with snow has one that is not open, but for links to cells before.
bool open_links_run(const float* height, const ClosenessView& closeness, const EdgeArrays& edges,
                    int32_t begin, int32_t end);
/// Sets the distance of cells at an edge to 0, of others to kFarFromEdge.
void mark_edges_run(const EdgeArrays& edges, ptrdiff_t size, int32_t begin, int32_t end);
/// Calls visit(cell) for the cells at an edge.
template <typename Visit>
void for_each_edge(const uint8_t* distance, int32_t begin, int32_t end, const Visit& visit) {
  constexpr uint64_t kNone = kFarFromEdge * 0x0101010101010101u;
  for (int32_t i = begin; i < end;) {
    uint64_t eight;
    if (i + 8 <= end && (std::memcpy(&eight, distance + i, 8), eight == kNone)) {
      i += 8;
      continue;
    }
    for (const int32_t last = std::min(i + 8, end); i < last; ++i) {
      if (distance[i] == 0) visit(i);
    }
  }
}
/// The profile of a shoulder so many links from its edge, in cells that carry `height`. `widest`:
/// of a shoulder, in links.
float shoulder_profile(uint8_t distance, float height, float closest, float least_variance,
                       float widest);
/// Of the links to the right and above. Returns the largest LinkConductance::wanted.
float conduct_run(const float* height, const float* inverse, const ClosenessView& closeness,
                  float* right, float* above, const ConductanceTerms& terms, int32_t begin,
                  int32_t end);
/// Whether one of the cells is near the foot of a feet.
bool any_near_foot(const uint8_t* proximity, int32_t count);
/// Takes from conductances what banks do not let through.
void limit_feet_run(const uint8_t* proximity, const float* inverse, const ClosenessView& closeness,
                    float* right, float* above, const ConductanceTerms& terms, int32_t begin,
                    int32_t end);
/// Heights to heights over profile, and back.
void divide_run(float* height, const float* inverse_area, const float* inverse_weight,
                int32_t begin, int32_t end);
void store_run(const float* height, const float* inverse_area, const float* inverse_weight,
               float* map, int32_t begin, int32_t end);
void stage_run(const float* from, float* to, const float* right, const float* above,
               const float* inverse, ptrdiff_t size, int32_t begin, int32_t end);

/// What a height becomes when the mean of its block changes from `before` to `now`, and only the
/// part `kept` of what sets it apart from the mean is left.
inline float changed(float height, float before, float now, float kept) {
  return now * (1.0f + kept * (height / before - 1.0f));
}

/// Two rows of a level's cells, from the block on that a run of the next level begins with. Which
/// cells of a block of 2 x 2 count as one: those of its chart, and with snow not too thin beside
/// the block's deepest.
struct BlockRows {
  const float* inverse[2];
  const uint8_t* joins[2];
};

/// What is left of differences within blocks: closeness of the blocks and how near they are to the
/// foot of a bank; see ConductanceTerms.
struct DampingTerms {
  const uint16_t* right;
  const uint16_t* above;
  const uint8_t* proximity;
  float least_variance;
  float done_below;
};

/// Means of blocks by weight, and 1 / their weights.
void restrict_run(const float* low, const float* high, const BlockRows& rows, float* mean,
                  float* inverse, int32_t count);
/// Hands the change of the means on to the cells.
void prolong_run(float* low, float* high, const BlockRows& rows, const float* before,
                 const float* now, const DampingTerms& terms, int32_t count);

/// What is left of the differences within a block: about what a Gaussian leaves of waves as long.
/// `wanted`: half the block's variance over distance^2.
inline float damping(float wanted, float done_below) {
  const float left = wanted > done_below ? wanted - done_below : 0.0f;
  return 1.0f / (1.0f + 2.0f * left * (1.0f + left));
}
inline float damping(float before, float closeness, uint8_t proximity, float least_variance,
                     float done_below) {
  const float by_depth = 0.5f * third_squared(before) * closeness;
  const float limit = proximity != 0 ? foot_limit(cells_to_foot(proximity)) : by_depth;
  const float wanted = by_depth < limit ? by_depth : limit;
  const float least = 0.5f * least_variance * closeness;
  return damping(wanted > least ? wanted : least, done_below);
}

}  // namespace snowbough::snow
