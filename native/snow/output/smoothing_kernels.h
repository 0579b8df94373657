#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>

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
inline constexpr float kLeastPart = 0.02f;
/// Width of a shoulder in standard deviations.
inline constexpr float kShoulder = 1.0f;
/// Maximum sigma near a foot, as a fraction of the distance to it. A straight slope gets steeper by
/// its square, one around a corner by half as much again: 0.4 degrees of 65.
inline constexpr float kFootSigmaShare = 0.1f;
/// Range of the foot's influence in cells: a level's stages spread snow by less than a tenth of it.
inline constexpr float kFootRange = 15.0f;
/// Proximity of a foot in 1/kProximitySteps of a cell: from kAtFoot, at the foot, down to 1; 0:
/// farther away than kFootRange.
inline constexpr int32_t kProximitySteps = 8;
inline constexpr int32_t kAtFoot = static_cast<int32_t>(kFootRange) * kProximitySteps + 1;
/// Slopes under 40 degrees have no foot.
inline constexpr float kLeastFootSlope = 0.84f;
/// Snow that ends higher than this, in cells (a slope of 80 degrees does not), ends in a cliff.
inline constexpr float kHighestFoot = 6.0f;
/// A distance from the edge, in links, greater than any shoulder's width.
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

/// Maximum of half the variance over distance^2 at this distance from a foot.
inline float foot_limit(float cells) {
  return 0.5f * kFootSigmaShare * kFootSigmaShare * cells * cells;
}

/// kFootRange for cells that are not near a foot.
inline float cells_to_foot(uint8_t proximity) {
  const float cells =
      static_cast<float>(kAtFoot - proximity) * (1.0f / static_cast<float>(kProximitySteps));
  return cells < kFootRange ? cells : kFootRange;
}

/// Maximum conductance of a link near a foot; infinite elsewhere.
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

/// State of a link: open; or present but closed, with the ends that are an edge of snow (the deeper
/// one, or both).
inline constexpr uint8_t kOpenLink = 128;
inline constexpr uint8_t kOwnEdge = 1;
inline constexpr uint8_t kOtherEdge = 2;

/// Per cell: links to the nearest edge; state of the links to the right and above.
struct EdgeArrays {
  uint8_t* distance;
  uint8_t* right;
  uint8_t* above;
};

bool holds_anything(const float* values, int32_t count);
/// Loads heights where there is a surface.
void load_run(const float* map, const float* inverse_area, float* height, float* inverse_weight,
              int32_t begin, int32_t end);
/// Finds the state of the links upwards only.
void open_upwards_run(const float* height, const ClosenessView& closeness, uint8_t* above,
                      int32_t begin, int32_t end);
/// Finds the state of a run's links and of the link that enters it from the left. Returns whether a
/// cell with snow has a closed link, other than to an earlier cell.
bool open_links_run(const float* height, const ClosenessView& closeness, const EdgeArrays& edges,
                    int32_t begin, int32_t end);
/// Sets the distance of edge cells to 0 and of the others to kFarFromEdge.
void mark_edges_run(const EdgeArrays& edges, ptrdiff_t size, int32_t begin, int32_t end);
/// Calls visit(cell) for the edge cells.
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
/// A shoulder's profile at `distance` links from its edge, in cells that carry `height`. `widest`:
/// width of the widest shoulder, in links.
float shoulder_profile(uint8_t distance, float height, float closest, float least_variance,
                       float widest);
/// Computes the conductances to the right and above. Returns the largest LinkConductance::wanted.
float conduct_run(const float* height, const float* inverse, const ClosenessView& closeness,
                  float* right, float* above, const ConductanceTerms& terms, int32_t begin,
                  int32_t end);
/// Whether one of the cells is near a foot.
bool any_near_foot(const uint8_t* proximity, int32_t count);
/// Limits the conductances near a foot.
void limit_feet_run(const uint8_t* proximity, const float* inverse, const ClosenessView& closeness,
                    float* right, float* above, const ConductanceTerms& terms, int32_t begin,
                    int32_t end);
/// Converts heights to heights over profile, and back.
void divide_run(float* height, const float* inverse_area, const float* inverse_weight,
                int32_t begin, int32_t end);
void store_run(const float* height, const float* inverse_area, const float* inverse_weight,
               float* map, int32_t begin, int32_t end);
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

/// Input for damping the differences within blocks: the blocks' closeness and proximity to a foot;
/// see ConductanceTerms.
struct DampingTerms {
  const uint16_t* right;
  const uint16_t* above;
  const uint8_t* proximity;
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
inline float damping(float before, float closeness, uint8_t proximity, float least_variance,
                     float done_below) {
  const float by_depth = 0.5f * third_squared(before) * closeness;
  const float limit = proximity != 0 ? foot_limit(cells_to_foot(proximity)) : by_depth;
  const float wanted = by_depth < limit ? by_depth : limit;
  const float least = 0.5f * least_variance * closeness;
  return damping(wanted > least ? wanted : least, done_below);
}

}  // namespace snowbough::snow
