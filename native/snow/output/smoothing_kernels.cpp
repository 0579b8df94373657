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
  const uint8_t* __restrict low_joins = rows.joins[0];
  const uint8_t* __restrict high_joins = rows.joins[1];
  for (int32_t i = 0; i < count; ++i) {
    const float closeness =
        from_half(terms.right[i] > terms.above[i] ? terms.right[i] : terms.above[i]);
    const float kept = damping(before[i], closeness, terms.least_variance, terms.done_below);
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

SNOWBOUGH_WIDE void store_run(const float* __restrict height, const float* __restrict inverse_area,
                              float* __restrict map, int32_t begin, int32_t end) {
  for (int32_t i = begin; i < end; ++i) map[i] = inverse_area[i] > 0.0f ? height[i] : map[i];
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
