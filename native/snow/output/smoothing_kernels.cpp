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

namespace {

/// State of a link between these heights for EdgeArrays.
inline uint8_t noted_link(uint16_t link, float own, float beside) {
  const bool linked = link != 0;
  const float other = linked ? beside : 0.0f;
  const float one = linked ? std::fabs(own) : 0.0f;
  const float two = std::fabs(other);
  const int32_t own_edge = ((one >= two) & (one > 0.0f)) ? kOwnEdge : 0;
  const int32_t other_edge = ((two >= one) & (two > 0.0f)) ? kOtherEdge : 0;
  const int32_t edges = own_edge | other_edge;
  return static_cast<uint8_t>(is_open(own, other) ? kOpenLink : edges);
}

}  // namespace

SNOWBOUGH_WIDE void open_upwards_run(const float* __restrict height, const ClosenessView& closeness,
                                     uint8_t* __restrict above, int32_t begin, int32_t end) {
  const uint16_t* __restrict upwards = closeness.above;
  const ptrdiff_t size = closeness.size;
  for (int32_t i = begin; i < end; ++i) {
    above[i] = noted_link(upwards[i], height[i], height[i + size]);
  }
}

SNOWBOUGH_WIDE bool open_links_run(const float* __restrict height, const ClosenessView& closeness,
                                   const EdgeArrays& edges, int32_t begin, int32_t end) {
  uint8_t* __restrict right = edges.right;
  uint8_t* __restrict above = edges.above;
  const uint16_t* __restrict to_right = closeness.right;
  // The cell before the run is bare; its link may lead into the run.
  for (int32_t i = begin - 1; i < end; ++i) {
    right[i] = noted_link(to_right[i], height[i], height[i + 1]);
  }
  open_upwards_run(height, closeness, above, begin, end);
  uint8_t noted = 0;
  for (int32_t i = begin; i < end; ++i) noted |= right[i] | above[i];
  return (noted & ~kOpenLink) != 0;
}

SNOWBOUGH_WIDE void mark_edges_run(const EdgeArrays& edges, ptrdiff_t size, int32_t begin,
                                   int32_t end) {
  const uint8_t* __restrict right = edges.right;
  const uint8_t* __restrict above = edges.above;
  uint8_t* __restrict distance = edges.distance;
  for (int32_t i = begin; i < end; ++i) {
    const int32_t after = (right[i] | above[i]) & kOwnEdge;
    const int32_t before = (right[i - 1] | above[i - size]) & kOtherEdge;
    distance[i] = (after | before) != 0 ? 0 : kFarFromEdge;
  }
}

float shoulder_profile(uint8_t distance, float height, float closest, float least_variance,
                       float widest) {
  const float variance = std::max(least_variance, third_squared(height));
  const float width = std::max(1.0f, std::min(widest, kShoulder * std::sqrt(variance * closest)));
  const float part = (static_cast<float>(distance) + 0.5f) / width;
  return part < 1.0f ? part * (2.0f - part) : 1.0f;
}

SNOWBOUGH_WIDE float conduct_run(const float* __restrict height, const float* __restrict inverse,
                                 const ClosenessView& closeness, float* __restrict right,
                                 float* __restrict above, const ConductanceTerms& of, int32_t begin,
                                 int32_t end) {
  const ConductanceTerms terms = of;
  const uint16_t* __restrict to_right = closeness.right;
  const uint16_t* __restrict upwards = closeness.above;
  const ptrdiff_t size = closeness.size;
  // Non-negative floats sort like their bits, which vectorise better.
  int32_t largest = 0;
  for (int32_t i = begin; i < end; ++i) {
    const LinkConductance along = conductance(height[i], height[i + 1], inverse[i], inverse[i + 1],
                                              from_half(to_right[i]), terms);
    const LinkConductance across = conductance(height[i], height[i + size], inverse[i],
                                               inverse[i + size], from_half(upwards[i]), terms);
    right[i] = along.conductance;
    above[i] = across.conductance;
    largest = std::max(largest, std::bit_cast<int32_t>(along.wanted));
    largest = std::max(largest, std::bit_cast<int32_t>(across.wanted));
  }
  return std::bit_cast<float>(largest);
}

SNOWBOUGH_WIDE bool any_near_foot(const uint8_t* proximity, int32_t count) {
  uint8_t bits = 0;
  for (int32_t i = 0; i < count; ++i) bits |= proximity[i];
  return bits != 0;
}

SNOWBOUGH_WIDE void limit_feet_run(const uint8_t* __restrict proximity,
                                   const float* __restrict inverse, const ClosenessView& closeness,
                                   float* __restrict right, float* __restrict above,
                                   const ConductanceTerms& of, int32_t begin, int32_t end) {
  const ConductanceTerms terms = of;
  const uint16_t* __restrict to_right = closeness.right;
  const uint16_t* __restrict upwards = closeness.above;
  const ptrdiff_t size = closeness.size;
  for (int32_t i = begin; i < end; ++i) {
    const float along = foot_conductance(proximity[i], proximity[i + 1], inverse[i], inverse[i + 1],
                                         from_half(to_right[i]), terms);
    const float across = foot_conductance(proximity[i], proximity[i + size], inverse[i],
                                          inverse[i + size], from_half(upwards[i]), terms);
    // `along` is NaN where both cells are bare.
    right[i] = along < right[i] ? along : right[i];
    above[i] = across < above[i] ? across : above[i];
  }
}

namespace {

inline float deepest(float a, float b) {
  return std::fabs(a) < std::fabs(b) ? b : a;
}

}  // namespace

SNOWBOUGH_WIDE void restrict_run(const float* __restrict low, const float* __restrict high,
                                 const BlockRows& rows, float* __restrict mean,
                                 float* __restrict inverse, int32_t count) {
  const float* __restrict low_inverse = rows.inverse[0];
  const float* __restrict high_inverse = rows.inverse[1];
  const uint8_t* __restrict low_joins = rows.joins[0];
  const uint8_t* __restrict high_joins = rows.joins[1];
  for (int32_t i = 0; i < count; ++i) {
    const float a = low[2 * i] * static_cast<float>(low_joins[2 * i]);
    const float b = low[2 * i + 1] * static_cast<float>(low_joins[2 * i + 1]);
    const float c = high[2 * i] * static_cast<float>(high_joins[2 * i]);
    const float d = high[2 * i + 1] * static_cast<float>(high_joins[2 * i + 1]);
    const float most = deepest(deepest(a, b), deepest(c, d));
    // Bare cells have no weight and no open links.
    const auto weight = [most](float height, float inverse_weight) {
      return is_open(height, most) ? 1.0f / inverse_weight : 0.0f;
    };
    const float of_a = weight(a, low_inverse[2 * i]);
    const float of_b = weight(b, low_inverse[2 * i + 1]);
    const float of_c = weight(c, high_inverse[2 * i]);
    const float of_d = weight(d, high_inverse[2 * i + 1]);
    const float sum = (of_a + of_b) + (of_c + of_d);
    const float inverse_sum = sum > 0.0f ? 1.0f / sum : 0.0f;
    mean[i] = ((of_a * a + of_b * b) + (of_c * c + of_d * d)) * inverse_sum;
    inverse[i] = inverse_sum;
  }
}

SNOWBOUGH_WIDE void prolong_run(float* __restrict low, float* __restrict high,
                                const BlockRows& rows, const float* __restrict before,
                                const float* __restrict now, const DampingTerms& of,
                                int32_t count) {
  const DampingTerms terms = of;
  const uint8_t* __restrict proximity = of.proximity;
  const uint8_t* __restrict low_joins = rows.joins[0];
  const uint8_t* __restrict high_joins = rows.joins[1];
  for (int32_t i = 0; i < count; ++i) {
    const float closeness =
        from_half(terms.right[i] > terms.above[i] ? terms.right[i] : terms.above[i]);
    const float kept =
        damping(before[i], closeness, proximity[i], terms.least_variance, terms.done_below);
    const float mean = before[i] != 0.0f ? before[i] : 1.0f;
    const float ratio = now[i] / mean;
    const float base = now[i] * (1.0f - kept);
    const float slope = ratio * kept;
    const float a = low[2 * i] * static_cast<float>(low_joins[2 * i]);
    const float b = low[2 * i + 1] * static_cast<float>(low_joins[2 * i + 1]);
    const float c = high[2 * i] * static_cast<float>(high_joins[2 * i]);
    const float d = high[2 * i + 1] * static_cast<float>(high_joins[2 * i + 1]);
    const float most = deepest(deepest(a, b), deepest(c, d));
    low[2 * i] = is_open(a, most) ? base + slope * a : low[2 * i];
    low[2 * i + 1] = is_open(b, most) ? base + slope * b : low[2 * i + 1];
    high[2 * i] = is_open(c, most) ? base + slope * c : high[2 * i];
    high[2 * i + 1] = is_open(d, most) ? base + slope * d : high[2 * i + 1];
  }
}

SNOWBOUGH_WIDE void divide_run(float* __restrict height, const float* __restrict inverse_area,
                               const float* __restrict inverse_weight, int32_t begin, int32_t end) {
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
    const float flux =
        right[i] * (from[i + 1] - own) + right[i - 1] * (from[i - 1] - own) +
        (above[i] * (from[i + size] - own) + above[i - size] * (from[i - size] - own));
    to[i] = own + inverse[i] * flux;
  }
}

}  // namespace snowbough::snow
