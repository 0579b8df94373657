#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <numeric>
#include <vector>

#include "snow/texels/texel_table_builder.h"

// Layouts of rectangles for the tests of the texel table's steps one by one.
namespace snowbough::snow {

inline constexpr int32_t kRectangleResolution = 64;

/// A layout of rectangles, each a chart of two triangles, in texels of a map of 64.
struct RectangleLayout {
  MapTopology topology;

  RectangleLayout() { topology.resolution = kRectangleResolution; }

  RectangleLayout& rectangle(double left, double bottom, double right, double top) {
    const int32_t first = topology.vertex_count;
    for (const int32_t corner : {0, 1, 2, 0, 2, 3}) topology.triangles.push_back(first + corner);
    const glm::vec2 a(left / kRectangleResolution, bottom / kRectangleResolution);
    const glm::vec2 c(right / kRectangleResolution, top / kRectangleResolution);
    const glm::vec2 b(c.x, a.y);
    const glm::vec2 d(a.x, c.y);
    topology.corner_uv.insert(topology.corner_uv.end(), {a, b, c, a, c, d});
    topology.vertex_count += 4;
    return *this;
  }

  TexelTableBuilder cut() const {
    TexelTableBuilder builder(topology);
    cut_map(builder, 1);
    return builder;
  }
};

/// Texels' area that a chart's fragments hold in an owned texel.
inline double area_in(const TexelTableBuilder& builder, int32_t texel, int32_t chart) {
  const size_t i = builder.owned_index(texel);
  double area = 0.0;
  for (int32_t f = builder.table.fragment_begin[i]; f < builder.table.fragment_begin[i + 1]; ++f) {
    const int32_t triangle = builder.table.fragment_triangle[f];
    if (builder.chart_of(triangle) == chart) area += builder.table.fragment_share[f];
  }
  return area;
}

inline double total_area(const TexelTableBuilder& builder) {
  const std::vector<float>& areas = builder.table.fragment_share;
  return std::accumulate(areas.begin(), areas.end(), 0.0);
}

/// Four whole texels and six tenths of the fifth, which also holds a speck of a chart.
inline RectangleLayout wide_and_speck() {
  return RectangleLayout().rectangle(0.0, 0.0, 4.6, 1.0).rectangle(4.7, 0.2, 4.9, 0.4);
}

}  // namespace snowbough::snow
