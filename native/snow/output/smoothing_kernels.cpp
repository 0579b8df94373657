#include "snow/output/smoothing_kernels.h"

#include <bit>

namespace snowbough::snow {

SNOWBOUGH_WIDE bool holds_anything(const float* values, int32_t count) {
  uint32_t bits = 0;
  for (int32_t i = 0; i < count; ++i) bits |= std::bit_cast<uint32_t>(values[i]) << 1;
  return bits != 0;
}

SNOWBOUGH_WIDE void load_run(const float* __restrict map, const float* __restrict inverse_area,
                             float* __restrict height, float* __restrict inverse_weight,
                             int32_t begin, int32_t end) {
  for (int32_t i = begin; i < end; ++i) {
    height[i] = inverse_area[i] > 0.0f ? map[i] : 0.0f;
    inverse_weight[i] = inverse_area[i];
  }
}

SNOWBOUGH_WIDE void open_links_run(const float* __restrict height, const ClosenessView& closeness,
                                   const EdgeArrays& edges, int32_t begin, int32_t end) {
  uint8_t* __restrict right = edges.right;
  uint8_t* __restrict above = edges.above;
  const ptrdiff_t size = closeness.size;
  for (int32_t i = begin; i < end; ++i) {
    right[i] = is_open(height[i], height[i + 1]) & (closeness.right[i] != 0) ? 255 : 0;
  }
  for (int32_t i = begin; i < end; ++i) {
    above[i] = is_open(height[i], height[i + size]) & (closeness.above[i] != 0) ? 255 : 0;
  }
}

namespace {

/// The closest of a cell's links on the grid.
inline float closest(const ClosenessView& closeness, int32_t i) {
  uint16_t most = std::max(closeness.right[i], closeness.above[i]);
  if (i > 0) most = std::max(most, closeness.right[i - 1]);
  if (i >= closeness.size) most = std::max(most, closeness.above[i - closeness.size]);
  return from_half(most);
}

}  // namespace

float find_edges_run(const float* height, const ClosenessView& closeness, float least_variance,
                     const EdgeArrays& edges, int32_t begin, int32_t end) {
  const auto size = static_cast<int32_t>(closeness.size);
  float widest = 0.0f;
  const auto is_edge = [&](int32_t i, int32_t other) {
    return std::fabs(height[i]) >= std::fabs(height[other]);
  };
  for (int32_t i = begin; i < end; ++i) {
    // Neighbours that are all open, or no surface at all: nearly always so.
    uint8_t edge = 0;
    edge |= closeness.right[i] != 0 && edges.right[i] == 0 && is_edge(i, i + 1);
    edge |= closeness.above[i] != 0 && edges.above[i] == 0 && is_edge(i, i + size);
    if (i > 0) edge |= closeness.right[i - 1] != 0 && edges.right[i - 1] == 0 && is_edge(i, i - 1);
    if (i >= size) {
      edge |= closeness.above[i - size] != 0 && edges.above[i - size] == 0 && is_edge(i, i - size);
    }
    const bool counts = edge != 0 && height[i] != 0.0f;
    edges.distance[i] = counts ? 0 : kFarFromEdge;
    edges.next[i] = kFarFromEdge;
    if (!counts) continue;
    const float variance = std::max(least_variance, third_squared(height[i]));
    widest = std::max(widest, variance * closest(closeness, i));
  }
  return widest;
}

SNOWBOUGH_WIDE void spread_distance_run(const EdgeArrays& edges, ptrdiff_t size, int32_t begin,
                                        int32_t end) {
  const uint8_t* __restrict from = edges.distance;
  uint8_t* __restrict to = edges.next;
  const uint8_t* __restrict right = edges.right;
  const uint8_t* __restrict above = edges.above;
  const auto via = [](uint8_t distance, uint8_t open) {
    return static_cast<uint8_t>(static_cast<uint8_t>(distance + 1) | static_cast<uint8_t>(~open));
  };
  const auto least = [](uint8_t a, uint8_t b) { return a < b ? a : b; };
  for (int32_t i = begin; i < end; ++i) {
    const uint8_t along = least(via(from[i + 1], right[i]), via(from[i - 1], right[i - 1]));
    const uint8_t across =
        least(via(from[i + size], above[i]), via(from[i - size], above[i - size]));
    to[i] = least(from[i], least(along, across));
  }
}

void shape_run(const float* height, const ClosenessView& closeness, float least_variance,
               float widest, const uint8_t* distance, float* inverse_weight, int32_t begin,
               int32_t end) {
  for (int32_t i = begin; i < end; ++i) {
    if (distance[i] >= widest || height[i] == 0.0f) continue;
    const float variance = std::max(least_variance, third_squared(height[i]));
    const float width =
        std::max(1.0f, std::min(widest, kShoulder * std::sqrt(variance * closest(closeness, i))));
    const float part = (static_cast<float>(distance[i]) + 0.5f) / width;
    if (part < 1.0f) inverse_weight[i] /= part * (2.0f - part);
  }
}

SNOWBOUGH_WIDE float conduct_run(const float* __restrict height, const float* __restrict inverse,
                                 const uint16_t* __restrict closeness,
                                 float* __restrict conductances, const ConductanceTerms& of,
                                 ptrdiff_t stride, int32_t begin, int32_t end) {
  const ConductanceTerms terms = of;
  float largest = 0.0f;
  for (int32_t i = begin; i < end; ++i) {
    const LinkConductance link = conductance(height[i], height[i + stride], inverse[i],
                                             inverse[i + stride], from_half(closeness[i]), terms);
    conductances[i] = link.conductance;
    largest = largest > link.wanted ? largest : link.wanted;
  }
  return largest;
}

SNOWBOUGH_WIDE void divide_run(float* __restrict height, const float* __restrict inverse_area,
                               const float* __restrict inverse_weight, int32_t begin,
                               int32_t end) {
  for (int32_t i = begin; i < end; ++i) {
    const float area = inverse_area[i];
    const float ratio = inverse_weight[i] / (area > 0.0f ? area : 1.0f);
    height[i] *= ratio;
  }
}

SNOWBOUGH_WIDE void store_run(const float* __restrict height, const float* __restrict inverse_area,
                              const float* __restrict inverse_weight, float* __restrict map,
                              int32_t begin, int32_t end) {
  for (int32_t i = begin; i < end; ++i) {
    const float weight = inverse_weight[i];
    const float profile = inverse_area[i] / (weight > 0.0f ? weight : 1.0f);
    map[i] = weight > 0.0f ? height[i] * profile : map[i];
  }
}

SNOWBOUGH_WIDE void stage_run(const float* __restrict from, float* __restrict to,
                              const float* __restrict right, const float* __restrict above,
                              const float* __restrict inverse, ptrdiff_t size, int32_t begin,
                              int32_t end) {
  for (int32_t i = begin; i < end; ++i) {
    const float own = from[i];
    const float flux = right[i] * (from[i + 1] - own) + right[i - 1] * (from[i - 1] - own) +
                       (above[i] * (from[i + size] - own) + above[i - size] * (from[i - size] - own));
    to[i] = own + inverse[i] * flux;
  }
}

}  // namespace snowbough::snow
