#include "tree/leaf_uvs.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <iterator>
#include <limits>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>

namespace snowbough::tree {
namespace {

/// Leaves that a thread takes at a time.
constexpr size_t kLeafBlock = 512;
constexpr int kMinResolution = 16;
constexpr int kMaxResolution = 16384;
constexpr double kMinExtent = 2.0;
constexpr double kWideChart = 4.0;
/// A face that shows less than this share of its area along the sheet's normal gets its own chart.
constexpr double kMinFacing = 0.25;
/// Sheets with a longer outline are taken apart, as testing them for folds grows with its square.
constexpr size_t kMaxOutline = 400;
constexpr int kSearchSteps = 40;

using Point = glm::dvec2;

/// Faces laid flat together. Metres, lower left corner of the bounding box at the origin.
struct FlatChart {
  std::vector<int32_t> corners;
  std::vector<Point> points;
  Point size{0.0};
};

/// An edge of a face, by its vertices and the corner it starts at.
struct Edge {
  int32_t low, high;
  bool forward;
  int32_t face;
  int32_t corner;
};

void check(const Foliage& foliage, int resolution) {
  if (resolution < kMinResolution || resolution > kMaxResolution) {
    throw std::invalid_argument("resolution must be " + std::to_string(kMinResolution) + " to " +
                                std::to_string(kMaxResolution) + ", not " +
                                std::to_string(resolution));
  }
  const std::vector<int32_t>& begin = foliage.face_begin;
  const size_t face_count = begin.empty() ? 0 : begin.size() - 1;
  const bool consistent =
      foliage.face_leaf.size() == face_count &&
      (begin.empty() ? foliage.corner_vertex.empty()
                     : begin.front() == 0 && std::is_sorted(begin.begin(), begin.end()) &&
                           static_cast<size_t>(begin.back()) == foliage.corner_vertex.size());
  if (!consistent) {
    throw std::invalid_argument("face_begin, face_leaf and corner_vertex contradict each other");
  }
  for (const int32_t vertex : foliage.corner_vertex) {
    if (vertex < 0 || static_cast<size_t>(vertex) >= foliage.vertices.size()) {
      throw std::invalid_argument("foliage vertex " + std::to_string(vertex) + " is out of range");
    }
  }
}

/// Edges of some faces, equal ones side by side.
std::vector<Edge> sorted_edges(const Foliage& foliage, const std::vector<int32_t>& faces) {
  std::vector<Edge> edges;
  for (const int32_t face : faces) {
    const int32_t begin = foliage.face_begin[face];
    const int32_t end = foliage.face_begin[face + 1];
    for (int32_t corner = begin; corner < end; ++corner) {
      const int32_t a = foliage.corner_vertex[corner];
      const int32_t b = foliage.corner_vertex[corner + 1 < end ? corner + 1 : begin];
      edges.push_back({std::min(a, b), std::max(a, b), a < b, face, corner});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
    return std::tie(a.low, a.high, a.corner) < std::tie(b.low, b.high, b.corner);
  });
  return edges;
}

bool same_edge(const Edge& a, const Edge& b) {
  return a.low == b.low && a.high == b.high;
}

/// Groups the faces of one leaf that hang together by edges, in the order of their first faces.
std::vector<std::vector<int32_t>> find_sheets(const Foliage& foliage,
                                              const std::vector<int32_t>& faces) {
  std::vector<int32_t> parent(faces.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto find = [&parent](int32_t i) {
    while (parent[i] != i) {
      i = parent[i] = parent[parent[i]];
    }
    return i;
  };
  const auto index_of = [&faces](int32_t face) {
    return static_cast<int32_t>(std::lower_bound(faces.begin(), faces.end(), face) - faces.begin());
  };
  const std::vector<Edge> edges = sorted_edges(foliage, faces);
  for (size_t i = 1; i < edges.size(); ++i) {
    if (same_edge(edges[i], edges[i - 1])) {
      const int32_t a = find(index_of(edges[i].face));
      const int32_t b = find(index_of(edges[i - 1].face));
      parent[std::max(a, b)] = std::min(a, b);
    }
  }
  std::vector<std::vector<int32_t>> sheets;
  std::vector<int32_t> sheet_of(faces.size(), -1);
  for (size_t i = 0; i < faces.size(); ++i) {
    int32_t& sheet = sheet_of[find(static_cast<int32_t>(i))];
    if (sheet < 0) {
      sheet = static_cast<int32_t>(sheets.size());
      sheets.emplace_back();
    }
    sheets[sheet].push_back(faces[i]);
  }
  return sheets;
}

/// Newell's normal: twice the polygon's area along each axis.
glm::dvec3 area_normal(const Foliage& foliage, int32_t face) {
  const int32_t begin = foliage.face_begin[face];
  const int32_t end = foliage.face_begin[face + 1];
  glm::dvec3 sum(0.0);
  for (int32_t corner = begin + 2; corner < end; ++corner) {
    const glm::dvec3 origin = foliage.vertices[foliage.corner_vertex[begin]];
    sum += glm::cross(glm::dvec3(foliage.vertices[foliage.corner_vertex[corner - 1]]) - origin,
                      glm::dvec3(foliage.vertices[foliage.corner_vertex[corner]]) - origin);
  }
  return sum;
}

/// Turns the points so that their widest spread stands upright, and moves them to the origin.
void straighten(FlatChart& chart) {
  Point centre(0.0);
  for (const Point& p : chart.points) {
    centre += p;
  }
  centre /= static_cast<double>(chart.points.size());
  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;
  for (const Point& p : chart.points) {
    const Point d = p - centre;
    xx += d.x * d.x;
    xy += d.x * d.y;
    yy += d.y * d.y;
  }
  // Angle of the covariance's first axis against y.
  const double angle = 0.5 * std::atan2(2.0 * xy, xx - yy) - 0.5 * std::numbers::pi;
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  Point low(std::numeric_limits<double>::infinity());
  Point high = -low;
  for (Point& p : chart.points) {
    p = Point(c * p.x + s * p.y, -s * p.x + c * p.y);
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  for (Point& p : chart.points) {
    p -= low;
  }
  chart.size = high - low;
}

double signed_area(const FlatChart& chart, size_t begin, size_t end) {
  double twice = 0.0;
  for (size_t i = begin; i < end; ++i) {
    const Point a = chart.points[i] - chart.points[begin];
    const Point b = chart.points[i + 1 < end ? i + 1 : begin] - chart.points[begin];
    twice += a.x * b.y - a.y * b.x;
  }
  return 0.5 * twice;
}

/// The faces seen along their mean normal. Empty if there is none.
FlatChart project(const Foliage& foliage, const std::vector<int32_t>& faces) {
  FlatChart chart;
  glm::dvec3 normal(0.0);
  for (const int32_t face : faces) {
    normal += area_normal(foliage, face);
  }
  const double length = glm::length(normal);
  if (!(length > 0.0) || !std::isfinite(length)) {
    return chart;
  }
  normal /= length;
  const glm::dvec3 helper = std::abs(normal.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
  const glm::dvec3 right = glm::normalize(glm::cross(helper, normal));
  const glm::dvec3 up = glm::cross(normal, right);
  const glm::dvec3 origin = foliage.vertices[foliage.corner_vertex[foliage.face_begin[faces[0]]]];
  for (const int32_t face : faces) {
    for (int32_t corner = foliage.face_begin[face]; corner < foliage.face_begin[face + 1];
         ++corner) {
      const glm::dvec3 d = glm::dvec3(foliage.vertices[foliage.corner_vertex[corner]]) - origin;
      chart.corners.push_back(corner);
      chart.points.emplace_back(glm::dot(d, right), glm::dot(d, up));
    }
  }
  straighten(chart);
  return chart;
}

double turn(const Point& a, const Point& b, const Point& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Whether the sheet lies flat without covering itself: every face shows its front, every inner
/// edge has a face on either side, and the outline does not cross itself.
bool lies_flat(const Foliage& foliage, const std::vector<int32_t>& faces, const FlatChart& chart) {
  size_t begin = 0;
  for (const int32_t face : faces) {
    const size_t end = begin + foliage.face_begin[face + 1] - foliage.face_begin[face];
    const double area = 0.5 * glm::length(area_normal(foliage, face));
    const double shown = signed_area(chart, begin, end);
    if (!(shown > 0.0) || shown < kMinFacing * area) {
      return false;
    }
    begin = end;
  }
  if (faces.size() == 1) {
    return true;
  }
  // Corners of a sheet's faces are stored one face after another: find a corner's place.
  std::vector<std::pair<int32_t, size_t>> places(chart.corners.size());
  for (size_t i = 0; i < chart.corners.size(); ++i) {
    places[i] = {chart.corners[i], i};
  }
  std::sort(places.begin(), places.end());
  const auto point_of = [&](int32_t corner) {
    const auto at =
        std::lower_bound(places.begin(), places.end(), std::pair<int32_t, size_t>{corner, 0});
    return chart.points[at->second];
  };
  struct Segment {
    int32_t low, high;
    Point a, b;
  };
  std::vector<Segment> outline;
  const std::vector<Edge> edges = sorted_edges(foliage, faces);
  for (size_t i = 0; i < edges.size();) {
    size_t end = i + 1;
    while (end < edges.size() && same_edge(edges[end], edges[i])) {
      ++end;
    }
    if (end - i > 2 || (end - i == 2 && edges[i].forward == edges[i + 1].forward)) {
      return false;
    }
    if (end - i == 1) {
      const int32_t corner = edges[i].corner;
      const int32_t face = edges[i].face;
      const int32_t next =
          corner + 1 < foliage.face_begin[face + 1] ? corner + 1 : foliage.face_begin[face];
      outline.push_back({edges[i].low, edges[i].high, point_of(corner), point_of(next)});
    }
    i = end;
  }
  if (outline.size() > kMaxOutline) {
    return false;
  }
  for (size_t i = 0; i < outline.size(); ++i) {
    for (size_t j = i + 1; j < outline.size(); ++j) {
      const Segment& p = outline[i];
      const Segment& q = outline[j];
      if (p.low == q.low || p.low == q.high || p.high == q.low || p.high == q.high) {
        continue;
      }
      if (turn(p.a, p.b, q.a) * turn(p.a, p.b, q.b) <= 0.0 &&
          turn(q.a, q.b, p.a) * turn(q.a, q.b, p.b) <= 0.0) {
        return false;
      }
    }
  }
  return true;
}

/// A face without area still needs a place: a regular polygon of no size, widened later.
FlatChart placeholder(const Foliage& foliage, int32_t face) {
  FlatChart chart;
  const int32_t begin = foliage.face_begin[face];
  const int32_t count = foliage.face_begin[face + 1] - begin;
  for (int32_t i = 0; i < count; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / count;
    chart.corners.push_back(begin + i);
    chart.points.emplace_back(1e-12 * (1.0 + std::cos(angle)), 1e-12 * (1.0 + std::sin(angle)));
  }
  chart.size = Point(2e-12);
  return chart;
}

void add_sheet(const Foliage& foliage, const std::vector<int32_t>& faces,
               std::vector<FlatChart>& charts) {
  FlatChart chart = project(foliage, faces);
  if (!chart.points.empty() && lies_flat(foliage, faces, chart)) {
    charts.push_back(std::move(chart));
  } else if (faces.size() == 1) {
    charts.push_back(placeholder(foliage, faces.front()));
  } else {
    for (const int32_t face : faces) {
      add_sheet(foliage, {face}, charts);
    }
  }
}

std::vector<FlatChart> flatten_leaves(const Foliage& foliage, const Execution& execution) {
  const auto face_count = static_cast<int32_t>(foliage.face_leaf.size());
  std::vector<int32_t> order;
  for (int32_t face = 0; face < face_count; ++face) {
    if (foliage.face_begin[face + 1] - foliage.face_begin[face] >= 3) {
      order.push_back(face);
    }
  }
  std::stable_sort(order.begin(), order.end(), [&foliage](int32_t a, int32_t b) {
    return foliage.face_leaf[a] < foliage.face_leaf[b];
  });
  // Where each leaf begins in `order`, and where the last one ends.
  std::vector<size_t> leaves;
  for (size_t i = 0; i < order.size(); ++i) {
    if (i == 0 || foliage.face_leaf[order[i]] != foliage.face_leaf[order[i - 1]]) {
      leaves.push_back(i);
    }
  }
  const size_t leaf_count = leaves.size();
  leaves.push_back(order.size());
  std::vector<std::vector<FlatChart>> parts((leaf_count + kLeafBlock - 1) / kLeafBlock);
  parallel_blocks(leaf_count, kLeafBlock, execution, [&](size_t begin, size_t end) {
    std::vector<FlatChart>& charts = parts[begin / kLeafBlock];
    for (size_t leaf = begin; leaf < end; ++leaf) {
      const std::vector<int32_t> faces(
          order.begin() + static_cast<std::ptrdiff_t>(leaves[leaf]),
          order.begin() + static_cast<std::ptrdiff_t>(leaves[leaf + 1]));
      for (const auto& sheet : find_sheets(foliage, faces)) {
        add_sheet(foliage, sheet, charts);
      }
    }
  });
  std::vector<FlatChart> charts;
  for (std::vector<FlatChart>& part : parts) {
    std::move(part.begin(), part.end(), std::back_inserter(charts));
  }
  return charts;
}

Point extent_at(const FlatChart& chart, double scale) {
  return glm::max(chart.size * scale, Point(kMinExtent));
}

/// Lays the charts, tallest first, on shelves from the bottom up. True if all fit; then `places`
/// has their lower left texels.
bool shelve(const std::vector<FlatChart>& charts, double scale, int resolution,
            std::vector<glm::ivec2>& places) {
  int gutter = 1;
  for (const FlatChart& chart : charts) {
    gutter = extent_at(chart, scale).x > kWideChart ? 2 : gutter;
  }
  places.resize(charts.size());
  int x = 1;
  int y = 1;
  int shelf_height = 0;
  for (size_t i = 0; i < charts.size(); ++i) {
    const Point extent = extent_at(charts[i], scale);
    if (extent.x > resolution || extent.y > resolution) {
      return false;
    }
    const int width = static_cast<int>(std::ceil(extent.x));
    const int height = static_cast<int>(std::ceil(extent.y));
    if (x + width > resolution - 1) {
      x = 1;
      y += shelf_height + gutter;
      shelf_height = 0;
    }
    if (x + width > resolution - 1 || y + height > resolution - 1) {
      return false;
    }
    places[i] = {x, y};
    x += width + gutter;
    shelf_height = std::max(shelf_height, height);
  }
  return true;
}

/// Largest scale at which the charts fit; 0 if they do not even at their smallest.
double search_scale(const std::vector<FlatChart>& charts, int resolution,
                    std::vector<glm::ivec2>& places) {
  double largest = 0.0;
  for (const FlatChart& chart : charts) {
    largest = std::max({largest, chart.size.x, chart.size.y});
  }
  double low = 0.0;
  double high = resolution / largest;
  if (!shelve(charts, low, resolution, places)) {
    return -1.0;
  }
  for (int step = 0; step < kSearchSteps; ++step) {
    const double middle = 0.5 * (low + high);
    (shelve(charts, middle, resolution, places) ? low : high) = middle;
  }
  shelve(charts, low, resolution, places);
  return low;
}

}  // namespace

LeafUvs layout_leaf_uvs(const Foliage& foliage, int resolution, const Execution& execution) {
  check(foliage, resolution);
  LeafUvs result;
  result.resolution = resolution;
  result.corner_uv.assign(foliage.corner_vertex.size(), glm::vec2(0.0f));
  std::vector<FlatChart> charts = flatten_leaves(foliage, execution.part(0.0f, 0.8f));
  report_progress(execution.progress, 0.8f);
  result.chart_count = static_cast<int64_t>(charts.size());
  if (charts.empty()) {
    return result;
  }
  std::stable_sort(charts.begin(), charts.end(),
                   [](const FlatChart& a, const FlatChart& b) { return a.size.y > b.size.y; });
  std::vector<glm::ivec2> places;
  result.scale = search_scale(charts, resolution, places);
  for (int larger = kMinResolution; result.scale < 0.0; larger *= 2) {
    if (larger > kMaxResolution) {
      throw std::invalid_argument(
          "the foliage's " + std::to_string(charts.size()) + " charts fit on no snow map up to " +
          std::to_string(kMaxResolution) + ": leave out the foliage or thin it");
    }
    if (larger > resolution) {
      result.resolution = larger;
      result.scale = search_scale(charts, larger, places);
    }
  }
  for (size_t i = 0; i < charts.size(); ++i) {
    const FlatChart& chart = charts[i];
    const Point stretch = extent_at(chart, result.scale) / chart.size;
    for (size_t j = 0; j < chart.corners.size(); ++j) {
      result.corner_uv[chart.corners[j]] = glm::vec2(
          (Point(places[i]) + chart.points[j] * stretch) / static_cast<double>(result.resolution));
    }
  }
  return result;
}

}  // namespace snowbough::tree
