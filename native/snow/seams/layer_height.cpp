#include "snow/seams/layer_height.h"

#include <cmath>

#include "base/simd.h"

namespace snowbough::snow {
namespace {

constexpr float kMaxGrowth = 1.25f;
/// Fraction of the folding height that a layer may reach.
constexpr float kFold = 0.98f;
constexpr int kNewtonSteps = 5;
constexpr float kMinSlope = 0.05f;

inline float smaller(float a, float b) {
  return a < b ? a : b;
}
inline float larger(float a, float b) {
  return a > b ? a : b;
}

/// Height per held volume, 1 on flat ground: y of y + a y^2 + b y^3 = 1.
inline float growth(float a, float b) {
  const float root = a * a - 3.0f * b;
  const float turn = root >= 0.0f ? std::sqrt(larger(root, 0.0f)) - a : 0.0f;
  // The layer folds at 1 + 2 a y + 3 b y^2 = 0.
  const float fold = turn > 0.0f ? kFold / (turn > 0.0f ? turn : 1.0f) : kMaxGrowth;
  const float most = smaller(fold, kMaxGrowth);
  const float without_b = 1.0f + 4.0f * a;
  const float guess = smaller(2.0f / (1.0f + std::sqrt(larger(without_b, 0.0f))), most);
  float y = without_b > 0.0f ? guess : most;
  for (int step = 0; step < kNewtonSteps; ++step) {
    const float excess = y * (1.0f + y * (a + y * b)) - 1.0f;
    const float slope = 1.0f + y * (2.0f * a + y * 3.0f * b);
    y = smaller(larger(y - excess / larger(slope, kMinSlope), 0.0f), most);
  }
  return most * (1.0f + most * (a + most * b)) <= 1.0f ? most : y;
}

}  // namespace

SNOWBOUGH_WIDE void raise_layers(const LayerView& layers, int32_t count) {
  float* __restrict height = layers.height;
  const float* __restrict x = layers.x;
  const float* __restrict y = layers.y;
  const float* __restrict z = layers.z;
  for (int32_t i = 0; i < count; ++i) {
    const float level = height[i] / x[i];
    height[i] = level * growth(y[i] * level / x[i], z[i] * level * level / x[i]);
  }
}

}  // namespace snowbough::snow
