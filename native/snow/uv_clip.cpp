#include "snow/uv_clip.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace snowbough::snow {
namespace {

constexpr uint64_t kWholeTexel = ~uint64_t{0};

/// Sutherland and Hodgman, Reentrant Polygon Clipping (CACM 1974), against one axis-aligned line;
/// keeps what lies at or over `limit` (sign = 1) or at or under it (sign = -1).
ClipPolygon clip_half(const ClipPolygon& polygon, int axis, double limit, double sign) {
  ClipPolygon result;
  for (int32_t i = 0; i < polygon.count; ++i) {
    const glm::dvec2 a = polygon.points[i];
    const glm::dvec2 b = polygon.points[i + 1 == polygon.count ? 0 : i + 1];
    const double da = sign * (a[axis] - limit);
    const double db = sign * (b[axis] - limit);
    if (da >= 0.0) result.points[result.count++] = a;
    if ((da > 0.0 && db < 0.0) || (da < 0.0 && db > 0.0)) {
      glm::dvec2 crossing = a + (b - a) * (da / (da - db));
      crossing[axis] = limit;
      result.points[result.count++] = crossing;
    }
    // Rounding may make a sliver cross more often than a convex polygon can.
    if (result.count >= 7) break;
  }
  return result;
}

}  // namespace

ClipPolygon clip_to_slab(const ClipPolygon& polygon, int axis, double lower, double upper) {
  return clip_half(clip_half(polygon, axis, lower, 1.0), axis, upper, -1.0);
}

AreaCentroid area_and_centroid(const ClipPolygon& polygon) {
  AreaCentroid result;
  if (polygon.count == 0) return result;
  const glm::dvec2 origin = polygon.points[0];
  glm::dvec2 weighted(0.0);
  double twice = 0.0;
  for (int32_t i = 1; i + 1 < polygon.count; ++i) {
    const glm::dvec2 a = polygon.points[i] - origin;
    const glm::dvec2 b = polygon.points[i + 1] - origin;
    const double cross = a.x * b.y - a.y * b.x;
    twice += cross;
    weighted += (a + b) * cross;
  }
  result.area = 0.5 * std::abs(twice);
  if (twice != 0.0) {
    result.centroid = origin + weighted / (3.0 * twice);
  } else {
    for (int32_t i = 0; i < polygon.count; ++i) result.centroid += polygon.points[i];
    result.centroid /= static_cast<double>(polygon.count);
  }
  return result;
}

SampleEdges::SampleEdges(const UvTriangle& triangle) {
  for (int k = 0; k < 3; ++k) {
    glm::dvec2 a = triangle[k];
    glm::dvec2 b = triangle[(k + 1) % 3];
    // One order of an edge's ends for both of its triangles gives both the same crossings.
    if (b.y < a.y || (b.y == a.y && b.x < a.x)) std::swap(a, b);
    edges[k] = {a, b.y, b.y > a.y ? (b.x - a.x) / (b.y - a.y) : 0.0};
  }
}

uint64_t sample_mask(const SampleEdges& triangle, glm::dvec2 corner) {
  uint64_t mask = 0;
  for (int row = 0; row < 8; ++row) {
    const double y = corner.y + (row + 0.5) / 8.0;
    double left = std::numeric_limits<double>::infinity();
    double right = -left;
    for (const SampleEdges::Edge& edge : triangle.edges) {
      if (y < edge.low.y || y >= edge.high_y) continue;
      const double crossing = edge.low.x + edge.slope * (y - edge.low.y);
      left = std::min(left, crossing);
      right = std::max(right, crossing);
    }
    if (left >= right) continue;
    // Samples at corner.x + (column + 0.5) / 8 in [left, right): columns first(left) on.
    const auto first = [&](double x) {
      const double column = std::clamp((x - corner.x) * 8.0 - 0.5, 0.0, 8.0);
      const int whole = static_cast<int>(column);
      return whole + (column > whole ? 1 : 0);
    };
    const uint64_t bits = ((uint64_t{1} << first(right)) - 1) & ~((uint64_t{1} << first(left)) - 1);
    mask |= bits << (8 * row);
  }
  return mask;
}

void cut_triangle(const UvTriangle& triangle, int32_t index, int32_t resolution, int32_t row_begin,
                  int32_t row_end, std::vector<Fragment>& fragments) {
  const SampleEdges samples(triangle);
  ClipPolygon whole;
  whole.count = 3;
  for (int k = 0; k < 3; ++k) whole.points[k] = triangle[k];
  const double low = std::min({triangle[0].y, triangle[1].y, triangle[2].y});
  const double high = std::max({triangle[0].y, triangle[1].y, triangle[2].y});
  const int32_t first_row = std::max(row_begin, static_cast<int32_t>(std::floor(low)));
  const int32_t last_row = std::min(row_end - 1, static_cast<int32_t>(std::floor(high)));

  for (int32_t row = first_row; row <= last_row; ++row) {
    const ClipPolygon strip = clip_to_slab(whole, 1, row, row + 1.0);
    if (strip.count < 3) continue;
    constexpr double kFar = std::numeric_limits<double>::infinity();
    double left = kFar;
    double right = -kFar;
    // Between these the strip reaches from the row's lower to its upper line.
    double full_left[2] = {kFar, kFar};
    double full_right[2] = {-kFar, -kFar};
    for (int32_t i = 0; i < strip.count; ++i) {
      const glm::dvec2 p = strip.points[i];
      left = std::min(left, p.x);
      right = std::max(right, p.x);
      for (int line = 0; line < 2; ++line) {
        if (p.y != static_cast<double>(row + line)) continue;
        full_left[line] = std::min(full_left[line], p.x);
        full_right[line] = std::max(full_right[line], p.x);
      }
    }
    const double whole_from = std::max(full_left[0], full_left[1]);
    const double whole_to = std::min(full_right[0], full_right[1]);
    const int32_t first_column = std::max(0, static_cast<int32_t>(std::floor(left)));
    const int32_t last_column = std::min(resolution - 1, static_cast<int32_t>(std::floor(right)));
    for (int32_t column = first_column; column <= last_column; ++column) {
      const int32_t texel = row * resolution + column;
      const glm::dvec2 corner(column, row);
      if (whole_from <= column && column + 1.0 <= whole_to) {
        fragments.push_back({texel, index, 1.0, corner + 0.5, kWholeTexel});
        continue;
      }
      const AreaCentroid part = area_and_centroid(clip_to_slab(strip, 0, column, column + 1.0));
      if (part.area <= 0.0) continue;
      fragments.push_back({texel, index, part.area, part.centroid, sample_mask(samples, corner)});
    }
  }
}

}  // namespace snowbough::snow
