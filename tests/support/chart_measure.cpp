#include "support/chart_measure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>

#include "base/union_find.h"
#include "tree/uv/chart_shape.h"

namespace snowbough::tree {
namespace {

/// Fraction of a texel below which a chart does not touch it: float32 coordinates on a map of 8192
/// texels are rounded by up to 3e-4 of a texel.
constexpr double kMinShare = 5e-4;
/// Coverage above which a texel is covered twice, with a margin for rounded corners.
constexpr double kFullTexel = 1.0 + 1e-3;

using Point = glm::dvec2;

void check(const UvSurface& surface, int resolution) {
  if (surface.sides < 3 || surface.sides > 4) {
    throw std::invalid_argument("faces must have three or four corners");
  }
  if (resolution < 1 || resolution > 16384) {
    throw std::invalid_argument("resolution must be 1 to 16384, not " + std::to_string(resolution));
  }
  if (surface.corner_vertex.size() % surface.sides != 0 ||
      surface.corner_uv.size() != surface.corner_vertex.size()) {
    throw std::invalid_argument("uv and faces must have one entry per corner");
  }
  for (const int32_t vertex : surface.corner_vertex) {
    if (vertex < 0 || static_cast<size_t>(vertex) >= surface.vertices.size()) {
      throw std::invalid_argument("vertex index " + std::to_string(vertex) + " is out of range");
    }
  }
}

/// Chart of every face, numbered in the order of first faces.
std::vector<int32_t> find_charts(const UvSurface& surface, int32_t& chart_count) {
  struct Edge {
    int32_t a, b;
    glm::vec2 uv_a, uv_b;
    int32_t face;
    auto key() const { return std::tuple(a, b, uv_a.x, uv_a.y, uv_b.x, uv_b.y); }
  };
  const auto face_count = static_cast<int32_t>(surface.corner_vertex.size() / surface.sides);
  std::vector<Edge> edges;
  edges.reserve(surface.corner_vertex.size());
  for (int32_t face = 0; face < face_count; ++face) {
    for (int side = 0; side < surface.sides; ++side) {
      const size_t i = static_cast<size_t>(face) * surface.sides + side;
      const size_t j = static_cast<size_t>(face) * surface.sides + (side + 1) % surface.sides;
      Edge edge{surface.corner_vertex[i], surface.corner_vertex[j], surface.corner_uv[i],
                surface.corner_uv[j], face};
      if (edge.a > edge.b) {
        std::swap(edge.a, edge.b);
        std::swap(edge.uv_a, edge.uv_b);
      }
      edges.push_back(edge);
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
    return std::tuple(a.key(), a.face) < std::tuple(b.key(), b.face);
  });
  base::UnionFind joined(static_cast<size_t>(face_count));
  for (size_t i = 1; i < edges.size(); ++i) {
    if (edges[i].key() == edges[i - 1].key()) joined.join(edges[i].face, edges[i - 1].face);
  }
  std::vector<int32_t> chart(face_count);
  chart_count = 0;
  for (int32_t face = 0; face < face_count; ++face) {
    const int32_t first = joined.find(face);
    chart[face] = first == face ? chart_count++ : chart[first];
  }
  return chart;
}

/// A face in texels, possibly clipped. Each cut adds at most one corner.
struct Polygon {
  std::array<Point, 12> points;
  int count = 0;

  void add(const Point& p) { points[count++] = p; }
};

double signed_area(const Polygon& polygon) {
  double twice = 0.0;
  for (int i = 0; i < polygon.count; ++i) {
    const Point a = polygon.points[i] - polygon.points[0];
    const Point b = polygon.points[(i + 1) % polygon.count] - polygon.points[0];
    twice += a.x * b.y - a.y * b.x;
  }
  return 0.5 * twice;
}

/// Sutherland and Hodgman, Reentrant Polygon Clipping, CACM 17 (1974): keeps the part on the `sign`
/// side of the line `axis = at`.
Polygon clip(const Polygon& polygon, int axis, double at, double sign) {
  Polygon result;
  for (int i = 0; i < polygon.count; ++i) {
    const Point& a = polygon.points[i];
    const Point& b = polygon.points[(i + 1) % polygon.count];
    const double da = sign * (a[axis] - at);
    const double db = sign * (b[axis] - at);
    if (da >= 0.0) {
      result.add(a);
    }
    if ((da > 0.0 && db < 0.0) || (da < 0.0 && db > 0.0)) {
      result.add(a + (b - a) * (da / (da - db)));
    }
  }
  return result;
}

std::pair<double, double> extent(const Polygon& polygon, int axis) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (int i = 0; i < polygon.count; ++i) {
    low = std::min(low, polygon.points[i][axis]);
    high = std::max(high, polygon.points[i][axis]);
  }
  return {low, high};
}

/// Coverage of texels: per texel its first chart (-1 = none), the covered area, and whether a
/// second chart touches it.
struct Coverage {
  int resolution;
  std::vector<int32_t> chart;
  std::vector<float> covered;
  std::vector<uint8_t> shared;
};

void rasterise(const Polygon& face, int32_t chart, Coverage& coverage) {
  const int last = coverage.resolution - 1;
  const auto [bottom, top] = extent(face, 1);
  const int y_end = std::min(static_cast<int>(std::floor(top)), last);
  for (int y = std::max(static_cast<int>(std::floor(bottom)), 0); y <= y_end; ++y) {
    const Polygon row = clip(clip(face, 1, y, 1.0), 1, y + 1.0, -1.0);
    if (row.count < 3) {
      continue;
    }
    const auto [left, right] = extent(row, 0);
    const int x_end = std::min(static_cast<int>(std::floor(right)), last);
    for (int x = std::max(static_cast<int>(std::floor(left)), 0); x <= x_end; ++x) {
      const double area = std::abs(signed_area(clip(clip(row, 0, x, 1.0), 0, x + 1.0, -1.0)));
      if (area <= kMinShare) {
        continue;
      }
      const size_t texel = static_cast<size_t>(y) * coverage.resolution + x;
      coverage.shared[texel] |= coverage.chart[texel] >= 0 && coverage.chart[texel] != chart;
      coverage.chart[texel] = chart;
      coverage.covered[texel] += static_cast<float>(area);
    }
  }
}

bool other_chart_within(const Coverage& coverage, int x, int y, int distance) {
  const int32_t own = coverage.chart[static_cast<size_t>(y) * coverage.resolution + x];
  const int last = coverage.resolution - 1;
  for (int ny = std::max(y - distance, 0); ny <= std::min(y + distance, last); ++ny) {
    for (int nx = std::max(x - distance, 0); nx <= std::min(x + distance, last); ++nx) {
      const int32_t chart = coverage.chart[static_cast<size_t>(ny) * coverage.resolution + nx];
      if (chart >= 0 && chart != own) {
        return true;
      }
    }
  }
  return false;
}

double percentile(const std::vector<std::pair<double, double>>& sorted, double total,
                  double share) {
  double sum = 0.0;
  for (const auto& [value, weight] : sorted) {
    sum += weight;
    if (sum >= share * total) {
      return value;
    }
  }
  return sorted.empty() ? 0.0 : sorted.back().first;
}

}  // namespace

UvLayoutMeasure measure_uv_layout(const UvSurface& surface, int resolution) {
  check(surface, resolution);
  UvLayoutMeasure measure;
  int32_t chart_count = 0;
  const std::vector<int32_t> charts = find_charts(surface, chart_count);
  measure.chart_count = chart_count;
  if (charts.empty()) {
    return measure;
  }
  const double inf = std::numeric_limits<double>::infinity();
  struct Box {
    Point low, high;
    double area = 0.0;
  };
  std::vector<Box> boxes(chart_count, {{inf, inf}, {-inf, -inf}, 0.0});
  const size_t texel_count = static_cast<size_t>(resolution) * resolution;
  Coverage coverage{resolution, std::vector<int32_t>(texel_count, -1),
                    std::vector<float>(texel_count, 0.0f), std::vector<uint8_t>(texel_count, 0)};
  std::vector<std::pair<double, double>> densities;
  double total_area = 0.0;
  double total_texels = 0.0;
  measure.min_face_area = inf;
  for (size_t face = 0; face < charts.size(); ++face) {
    Polygon polygon;
    double area = 0.0;
    const auto vertex = [&](int corner) {
      return glm::dvec3(surface.vertices[surface.corner_vertex[face * surface.sides + corner]]);
    };
    Box& box = boxes[charts[face]];
    bool outside = false;
    for (int corner = 0; corner < surface.sides; ++corner) {
      const glm::vec2& uv = surface.corner_uv[face * surface.sides + corner];
      const Point p = Point(uv) * static_cast<double>(resolution);
      polygon.add(p);
      box.low = glm::min(box.low, p);
      box.high = glm::max(box.high, p);
      outside = outside || !(uv.x >= 0.0f && uv.x <= 1.0f && uv.y >= 0.0f && uv.y <= 1.0f);
      if (corner >= 2) {
        area += 0.5 *
                glm::length(glm::cross(vertex(corner - 1) - vertex(0), vertex(corner) - vertex(0)));
      }
    }
    if (outside) {
      ++measure.outside_faces;
      continue;
    }
    const double texels = signed_area(polygon);
    measure.min_face_area = std::min(measure.min_face_area, texels);
    box.area += std::abs(texels);
    total_texels += std::abs(texels);
    rasterise(polygon, charts[face], coverage);
    if (area > 0.0) {
      densities.emplace_back(std::abs(texels) / area, area);
      total_area += area;
    }
  }
  measure.fill = total_texels / static_cast<double>(texel_count);
  measure.min_chart_extent = measure.min_chart_mean_width = inf;
  std::vector<uint8_t> wide(chart_count, 0);
  for (int32_t chart = 0; chart < chart_count; ++chart) {
    const Point size = boxes[chart].high - boxes[chart].low;
    const double longest = std::max(size.x, size.y);
    wide[chart] = std::min(size.x, size.y) > kWideChart + kMinShare;
    measure.min_chart_extent = std::min({measure.min_chart_extent, size.x, size.y});
    measure.min_chart_mean_width =
        std::min(measure.min_chart_mean_width, longest > 0.0 ? boxes[chart].area / longest : 0.0);
  }
  for (int y = 0; y < resolution; ++y) {
    for (int x = 0; x < resolution; ++x) {
      const size_t texel = static_cast<size_t>(y) * resolution + x;
      const int32_t chart = coverage.chart[texel];
      if (chart < 0) {
        continue;
      }
      measure.overlap_texels += coverage.shared[texel] || coverage.covered[texel] > kFullTexel;
      measure.narrow_gutter_texels += other_chart_within(coverage, x, y, 1);
      measure.narrow_wide_gutter_texels += wide[chart] && other_chart_within(coverage, x, y, 2);
    }
  }
  std::sort(densities.begin(), densities.end());
  measure.density_p5 = percentile(densities, total_area, 0.05);
  measure.density_p50 = percentile(densities, total_area, 0.50);
  measure.density_p95 = percentile(densities, total_area, 0.95);
  return measure;
}

}  // namespace snowbough::tree
