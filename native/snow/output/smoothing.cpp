#include "snow/output/smoothing.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>

namespace snowbough::snow {
namespace {

constexpr int32_t kMostPasses = 64;

/// Weights with the taps at `scale` times their offsets, each shared by the two texels beside it.
std::array<double, kFilterReach + 1> scaled_weights(double scale) {
  std::array<double, kFilterReach + 1> weights{};
  double sum = 0.0;
  for (int tap = 0; tap < 3; ++tap) {
    const double offset = kTapOffset[tap] * scale;
    const auto lower = static_cast<size_t>(offset);
    const double part = offset - static_cast<double>(lower);
    // Taps left and right that fall on the texel itself count twice there.
    const double sides = tap == 0 ? 1.0 : 2.0;
    sum += sides * kTapWeight[tap];
    weights[lower] += kTapWeight[tap] * (1.0 - part) * (lower == 0 ? sides : 1.0);
    if (part > 0.0) weights[lower + 1] += kTapWeight[tap] * part;
  }
  for (double& weight : weights) weight /= sum;
  return weights;
}

double variance_of(const std::array<double, kFilterReach + 1>& weights) {
  double variance = 0.0;
  for (int32_t k = 1; k <= kFilterReach; ++k) variance += 2.0 * k * k * weights[k];
  return variance;
}

struct FilterLevelTable {
  std::array<FilterWeights, kFilterLevels> weights{};
  std::array<uint16_t, kFilterLevels> scale{};
};

FilterLevelTable make_levels() {
  FilterLevelTable levels;
  const double full = std::sqrt(variance_of(scaled_weights(1.0)));
  for (int32_t level = 0; level < kFilterLevels; ++level) {
    const double sigma = full * level / (kFilterLevels - 1);
    // The variance grows with the scale, in straight pieces: bisection finds it exactly enough.
    double low = 0.0;
    double high = 1.0;
    for (int step = 0; step < 50; ++step) {
      const double middle = 0.5 * (low + high);
      (variance_of(scaled_weights(middle)) < sigma * sigma ? low : high) = middle;
    }
    const double scale = level == 0 ? 0.0 : (level == kFilterLevels - 1 ? 1.0 : high);
    levels.scale[level] = static_cast<uint16_t>(std::lround(scale / double{kFilterScaleStep}));
    const auto weights = scaled_weights(levels.scale[level] * double{kFilterScaleStep});
    for (int32_t k = 0; k <= kFilterReach; ++k) {
      levels.weights[level][k] = static_cast<float>(weights[k]);
    }
  }
  return levels;
}

const FilterLevelTable& level_table() {
  static const FilterLevelTable levels = make_levels();
  return levels;
}

/// Positive numbers into few boxes, the boxes in the numbers' order.
uint32_t box_of(float size) {
  return std::bit_cast<uint32_t>(size) >> 16;
}

/// The texel length that a tenth of the covered texels fall short of.
double fine_texel_size(const TexelTable& table, const SeamTable& seams) {
  // Sorting millions of texels would take longer than a frame: only a box of them is sorted.
  std::vector<double> boxes(size_t{1} << 15, 0.0);
  double total = 0.0;
  const auto for_each = [&](const auto& visit) {
    for (size_t i = 0; i < table.texel.size(); ++i) {
      for (const float size : {seams.texel_size[i].x, seams.texel_size[i].y}) {
        if (size > 0.0f) visit(size, table.coverage[i]);
      }
    }
  };
  for_each([&](float size, float coverage) {
    boxes[box_of(size)] += coverage;
    total += coverage;
  });
  double below = 0.0;
  uint32_t box = 0;
  while (box + 1 < boxes.size() && below + boxes[box] < 0.1 * total) below += boxes[box++];
  std::vector<std::pair<float, float>> sizes;
  for_each([&](float size, float coverage) {
    if (box_of(size) == box) sizes.emplace_back(size, coverage);
  });
  std::sort(sizes.begin(), sizes.end());
  for (const auto& [size, coverage] : sizes) {
    below += coverage;
    if (below >= 0.1 * total) return size;
  }
  return sizes.empty() ? 0.0 : sizes.back().first;
}

}  // namespace

const std::array<FilterWeights, kFilterLevels>& filter_levels() {
  return level_table().weights;
}

uint16_t filter_scale(int32_t level) {
  return level_table().scale[level];
}

double full_filter_sigma() {
  return std::sqrt(variance_of(scaled_weights(1.0)));
}

SmoothingPlan plan_smoothing(const TexelTable& table, const SeamTable& seams, float blur_radius) {
  if (!(blur_radius >= 0.0f) || !std::isfinite(blur_radius)) {
    throw std::invalid_argument("blur_radius must be 0 or more metres");
  }
  SmoothingPlan plan;
  const double size = fine_texel_size(table, seams);
  if (blur_radius == 0.0f || size == 0.0) return plan;
  // In variances of a full pass, which add up; a closing pass brings half of one.
  const double wanted = std::pow(blur_radius / (full_filter_sigma() * size), 2.0);
  plan.closing_passes = wanted > 1.0 ? 2 : 1;
  const double closing = 0.5 * plan.closing_passes;
  plan.passes =
      static_cast<int32_t>(std::clamp(std::ceil(wanted - closing), 0.0, double{kMostPasses}));
  const double pass_radius = blur_radius / std::sqrt(plan.passes + closing);
  const double full_size = pass_radius / full_filter_sigma();
  const auto level = [&](float texel_size) {
    if (texel_size <= 0.0f) return uint8_t{0};
    return static_cast<uint8_t>(
        std::lround(std::min(full_size / texel_size, 1.0) * (kFilterLevels - 1)));
  };
  plan.level_u.reserve(seams.texel_size.size());
  plan.level_v.reserve(seams.texel_size.size());
  for (const glm::vec2 texel_size : seams.texel_size) {
    plan.level_u.push_back(level(texel_size.x));
    plan.level_v.push_back(level(texel_size.y));
  }
  return plan;
}

}  // namespace snowbough::snow
