#include "snow/texels/uv_clip.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace snowbough::snow {
namespace {

constexpr uint64_t kWholeTexel = ~uint64_t{0};

/// Sutherland and Hodgman, Reentrant Polygon Clipping (CACM 1974), against one axis-aligned line;
/// keeps the part at or over `limit` (kSign = 1) or at or under it (kSign = -1).
template <int kAxis, int kSign>
void clip_half(const ClipPolygon& polygon, double limit, ClipPolygon& result) {
  result.count = 0;
  if (polygon.count == 0) return;
  const auto inside = [limit](const glm::dvec2& p) { return kSign * (p[kAxis] - limit); };
  glm::dvec2 a = polygon.points[0];
  double da = inside(a);
  for (int32_t i = 0; i < polygon.count; ++i) {
    const glm::dvec2 b = polygon.points[i + 1 == polygon.count ? 0 : i + 1];
    const double db = inside(b);
    if (da >= 0.0) result.points[result.count++] = a;
    if ((da > 0.0 && db < 0.0) || (da < 0.0 && db > 0.0)) {
      glm::dvec2 crossing = a + (b - a) * (da / (da - db));
      crossing[kAxis] = limit;
      result.points[result.count++] = crossing;
    }
    // Rounding may make a sliver cross more often than a convex polygon can.
    if (result.count >= 7) break;
    a = b;
    da = db;
  }
}

/// The part of a polygon with bounds `low` to `high` that lies in [lower, upper]: itself, or a copy
/// in `scratch`.
template <int kAxis>
const ClipPolygon& clip(const ClipPolygon& polygon, double low, double high, double lower,
                        double upper, std::array<ClipPolygon, 2>& scratch) {
  const ClipPolygon* result = &polygon;
  if (low < lower) {
    clip_half<kAxis, 1>(*result, lower, scratch[0]);
    result = &scratch[0];
  }
  if (high > upper) {
    clip_half<kAxis, -1>(*result, upper, scratch[1]);
    result = &scratch[1];
  }
  return *result;
}

}  // namespace

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
    // The same order of an edge's ends in both its triangles gives the same crossings.
    if (b.y < a.y || (b.y == a.y && b.x < a.x)) std::swap(a, b);
    edges[k] = {a, b.y, b.y > a.y ? (b.x - a.x) / (b.y - a.y) : 0.0};
  }
}

SampleRow::SampleRow(const SampleEdges& triangle, int32_t row) {
  for (size_t line = 0; line < left_.size(); ++line) {
    const double y = row + (static_cast<double>(line) + 0.5) / 8.0;
    double left = std::numeric_limits<double>::infinity();
    double right = -left;
    for (const SampleEdges::Edge& edge : triangle.edges) {
      if (y < edge.low.y || y >= edge.high_y) continue;
      const double crossing = edge.low.x + edge.slope * (y - edge.low.y);
      left = std::min(left, crossing);
      right = std::max(right, crossing);
    }
    left_[line] = left;
    right_[line] = right;
  }
}

uint64_t SampleRow::inside(int32_t column) const {
  // Number of a line's samples, at column + (sample + 0.5) / 8, before x.
  const auto before = [column](double x) {
    const double samples = std::clamp((x - column) * 8.0 - 0.5, 0.0, 8.0);
    const int whole = static_cast<int>(samples);
    return whole + (samples > whole ? 1 : 0);
  };
  uint64_t mask = 0;
  for (size_t line = 0; line < left_.size(); ++line) {
    const uint64_t bits =
        ((uint64_t{1} << before(right_[line])) - 1) & ~((uint64_t{1} << before(left_[line])) - 1);
    mask |= bits << (8 * line);
  }
  return mask;
}

Fragment whole_fragment(int32_t texel, int32_t triangle, int32_t resolution) {
  return {texel, triangle, 1.0, texel_centre(texel, resolution), kWholeTexel};
}

double cut_triangle(const UvTriangle& triangle, int32_t index, int32_t resolution,
                    int32_t row_begin, int32_t row_end, TriangleCuts& cuts) {
  const SampleEdges edges(triangle);
  ClipPolygon whole;
  whole.count = 3;
  for (int k = 0; k < 3; ++k) whole.points[k] = triangle[k];
  const double low = std::min({triangle[0].y, triangle[1].y, triangle[2].y});
  const double high = std::max({triangle[0].y, triangle[1].y, triangle[2].y});
  const int32_t first_row = std::max(row_begin, static_cast<int32_t>(std::floor(low)));
  const int32_t last_row = std::min(row_end - 1, static_cast<int32_t>(std::floor(high)));

  std::array<ClipPolygon, 2> strip_scratch;
  std::array<ClipPolygon, 2> part_scratch;
  double sum = 0.0;
  for (int32_t row = first_row; row <= last_row; ++row) {
    const ClipPolygon& strip = clip<1>(whole, low, high, row, row + 1.0, strip_scratch);
    if (strip.count < 3) continue;
    constexpr double kFar = std::numeric_limits<double>::infinity();
    double left = kFar;
    double right = -kFar;
    // Between these the strip extends from the row's lower to its upper line.
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
    const SampleRow samples(edges, row);
    for (int32_t column = first_column; column <= last_column; ++column) {
      const int32_t texel = row * resolution + column;
      if (whole_from <= column && column + 1.0 <= whole_to) {
        WholeRun run{texel, 1, index};
        while (column < last_column && column + 2.0 <= whole_to) {
          ++run.count;
          ++column;
        }
        cuts.whole.push_back(run);
        sum += run.count;
        continue;
      }
      const AreaCentroid part =
          area_and_centroid(clip<0>(strip, left, right, column, column + 1.0, part_scratch));
      if (part.area <= 0.0) continue;
      cuts.parts.push_back({texel, index, part.area, part.centroid, samples.inside(column)});
      sum += part.area;
    }
  }
  return sum;
}

}  // namespace snowbough::snow
