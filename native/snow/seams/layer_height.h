#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "snow/seams/curvature.h"

namespace snowbough::snow {

/// Volumes of layers (m3/m2), which raise_layers replaces by heights, and their terms.
struct LayerView {
  float* height;
  const float* x;
  const float* y;
  const float* z;
};

/// Storage for `Count` layers.
template <size_t Count>
struct LayerBlock {
  std::array<float, Count> height;
  std::array<float, Count> x;
  std::array<float, Count> y;
  std::array<float, Count> z;

  void set(int32_t number, float held, LayerTerms terms) {
    const auto k = static_cast<size_t>(number);
    height[k] = held;
    x[k] = terms.x;
    y[k] = terms.y;
    z[k] = terms.z;
  }
  LayerView view() { return {height.data(), x.data(), y.data(), z.data()}; }
};

/// Computes the heights in metres at which `count` layers hold their volumes. A height is negative
/// on the back of the surface, whose curvature is reversed. In hollows it is limited to where the
/// layer would fold over itself, and to 1.25 times the volume: narrow folds would otherwise form
/// ridges.
void raise_layers(const LayerView& layers, int32_t count);

}  // namespace snowbough::snow
