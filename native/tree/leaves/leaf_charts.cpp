#include "tree/leaves/leaf_charts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <numbers>
#include <span>
#include <utility>

#include "tree/leaves/islands.h"

namespace snowbough::tree {
namespace {

/// Leaves per thread at a time.
constexpr size_t kLeafBlock = 512;
/// A face with less than this fraction of its area visible along the island's normal gets its own
/// chart.
constexpr double kMinFacing = 0.25;
/// Islands with a longer outline are split: testing them for folds takes quadratic time.
constexpr size_t kMaxOutline = 400;
/// Size in metres of the replacement for a face without area; it is widened later.
constexpr double kNoSize = 1e-12;

using Point = glm::dvec2;

/// An edge of the flattened outline, with the island on its left.
struct Segment {
  Point a, b;
};

/// Twice the signed area of a triangle.
double turn(const Point& a, const Point& b, const Point& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

bool touch(const Segment& p, const Segment& q) {
  return turn(p.a, p.b, q.a) * turn(p.a, p.b, q.b) <= 0.0 &&
         turn(q.a, q.b, p.a) * turn(q.a, q.b, p.b) <= 0.0;
}

/// Whether an outline goes around `centre` once, always anticlockwise: then it does not intersect
/// itself.
bool is_star(const std::vector<Segment>& outline, const Point& centre) {
  int rounds = 0;
  for (const Segment& edge : outline) {
    if (turn(centre, edge.a, edge.b) <= 0.0) {
      return false;
    }
    // An upward edge passes on the right.
    rounds += edge.a.y < centre.y && edge.b.y >= centre.y ? 1 : 0;
  }
  return rounds == 1;
}

Point mean(const std::vector<Point>& points) {
  Point sum(0.0);
  for (const Point& p : points) {
    sum += p;
  }
  return sum / static_cast<double>(points.size());
}

/// Rotates the points so that their largest extent is vertical, and moves them to the origin.
/// @return their extent.
Point straighten(std::vector<Point>& points) {
  const Point centre = mean(points);
  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;
  for (const Point& p : points) {
    const Point d = p - centre;
    xx += d.x * d.x;
    xy += d.x * d.y;
    yy += d.y * d.y;
  }
  // The principal axis has half the angle of (xx - yy, 2 xy).
  const double x = xx - yy;
  const double y = 2.0 * xy;
  const double length = std::sqrt(x * x + y * y);
  Point axis(1.0, 0.0);
  if (length > 0.0) {
    const double larger = std::sqrt(0.5 * (1.0 + std::abs(x) / length));
    const double smaller = 0.5 * y / (length * larger);
    axis = x >= 0.0 ? Point(larger, smaller) : Point(std::abs(smaller), std::copysign(larger, y));
  }
  Point low(std::numeric_limits<double>::infinity());
  Point high = -low;
  for (Point& p : points) {
    p = Point(axis.y * p.x - axis.x * p.y, axis.x * p.x + axis.y * p.y);
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  for (Point& p : points) {
    p -= low;
  }
  return high - low;
}

/// Flattens leaves, one after the other. Reuses its vectors.
class LeafFlattener {
 public:
  /// @param result  it changes the order of the leaves' faces, and their points.
  /// @param charts  receives the charts.
  LeafFlattener(const Foliage& foliage, LeafCharts& result, std::vector<LeafChart>& charts)
      : foliage_(foliage), result_(result), charts_(charts) {}

  /// Adds the charts of the leaf with faces [first, last) of the result.
  void add_leaf(int32_t first, int32_t last) {
    if (last - first == 1) {
      add_island(first, last);
      return;
    }
    connections_.find(foliage_, faces(first, last));
    if (connections_.island_count() == 1) {
      add_island(first, last);
      return;
    }
    // Faces grouped by island, each group in order.
    std::vector<std::pair<int32_t, int32_t>> by_island;
    for (int32_t at = first; at < last; ++at) {
      by_island.emplace_back(connections_.island_of()[at - first], result_.faces[at]);
    }
    std::sort(by_island.begin(), by_island.end());
    for (int32_t at = first; at < last; ++at) {
      result_.faces[at] = by_island[at - first].second;
    }
    for (int32_t begin = first; begin < last;) {
      int32_t end = begin + 1;
      while (end < last && by_island[end - first].first == by_island[begin - first].first) {
        ++end;
      }
      connections_.find(foliage_, faces(begin, end));
      add_island(begin, end);
      begin = end;
    }
  }

 private:
  int32_t corner_begin(int32_t at) const { return foliage_.face_begin[result_.faces[at]]; }
  int32_t corner_end(int32_t at) const { return foliage_.face_begin[result_.faces[at] + 1]; }

  std::span<const int32_t> faces(int32_t first, int32_t last) const {
    return std::span(result_.faces).subspan(first, last - first);
  }

  /// Adds an island, whose connectivity is known, as one chart, or as one chart per face.
  void add_island(int32_t first, int32_t last) {
    if (project(first, last) && (last - first == 1 || lies_flat())) {
      add_chart(first, last, straighten(points_));
    } else if (last - first == 1) {
      make_placeholder(corner_end(first) - corner_begin(first));
      add_chart(first, last, Point(2.0 * kNoSize));
    } else {
      for (int32_t at = first; at < last; ++at) {
        add_island(at, at + 1);
      }
    }
  }

  /// Newell's normal of a polygon, with a length of twice its area.
  static glm::dvec3 area_normal(std::span<const glm::dvec3> corners) {
    glm::dvec3 sum(0.0);
    for (size_t i = 2; i < corners.size(); ++i) {
      sum += glm::cross(corners[i - 1] - corners[0], corners[i] - corners[0]);
    }
    return sum;
  }

  /// Projects faces along their mean normal: fills points_ and faces_agree_. False if there is
  /// none.
  bool project(int32_t first, int32_t last) {
    corners_.clear();
    normals_.clear();
    glm::dvec3 normal(0.0);
    for (int32_t at = first; at < last; ++at) {
      const size_t begin = corners_.size();
      for (int32_t corner = corner_begin(at); corner < corner_end(at); ++corner) {
        corners_.emplace_back(foliage_.vertices[foliage_.corner_vertex[corner]]);
      }
      normals_.push_back(area_normal(std::span(corners_).subspan(begin)));
      normal += normals_.back();
    }
    const double length = glm::length(normal);
    if (!(length > 0.0) || !std::isfinite(length)) {
      return false;
    }
    normal /= length;
    faces_agree_ = std::all_of(normals_.begin(), normals_.end(), [&](const glm::dvec3& face) {
      const double shown = glm::dot(face, normal);
      return shown > 0.0 && shown >= kMinFacing * glm::length(face);
    });
    const glm::dvec3 helper = std::abs(normal.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
    const glm::dvec3 right = glm::normalize(glm::cross(helper, normal));
    const glm::dvec3 up = glm::cross(normal, right);
    points_.clear();
    for (const glm::dvec3& corner : corners_) {
      const glm::dvec3 d = corner - corners_[0];
      points_.emplace_back(glm::dot(d, right), glm::dot(d, up));
    }
    return true;
  }

  /// Whether the island is flat without overlap: all faces agree with their mean normal, every
  /// inner edge has a face on either side, and the outline does not intersect itself.
  bool lies_flat() {
    if (!faces_agree_ || !connections_.two_sided()) {
      return false;
    }
    const std::vector<FaceEdge>& edges = connections_.outline();
    outline_.clear();
    for (const FaceEdge& edge : edges) {
      outline_.push_back({points_[edge.point], points_[edge.next_point]});
    }
    if (is_star(outline_, mean(points_))) {
      return true;
    }
    if (outline_.size() > kMaxOutline) {
      return false;
    }
    for (size_t i = 0; i < outline_.size(); ++i) {
      for (size_t j = i + 1; j < outline_.size(); ++j) {
        if (!edges[i].shares_vertex(edges[j]) && touch(outline_[i], outline_[j])) {
          return false;
        }
      }
    }
    return true;
  }

  void make_placeholder(int32_t count) {
    points_.clear();
    for (int32_t i = 0; i < count; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / count;
      points_.push_back(kNoSize * Point(1.0 + std::cos(angle), 1.0 + std::sin(angle)));
    }
  }

  /// Adds points_ as a chart.
  void add_chart(int32_t first, int32_t last, const Point& size) {
    charts_.push_back({first, last, size});
    size_t point = 0;
    for (int32_t at = first; at < last; ++at) {
      for (int32_t corner = corner_begin(at); corner < corner_end(at); ++corner) {
        result_.points[corner] = points_[point++];
      }
    }
  }

  const Foliage& foliage_;
  LeafCharts& result_;
  std::vector<LeafChart>& charts_;
  FaceConnections connections_;
  /// The island's corners, face by face, and its faces' normals.
  std::vector<glm::dvec3> corners_;
  std::vector<glm::dvec3> normals_;
  /// The projected corners, and whether all faces point along their mean normal.
  std::vector<Point> points_;
  bool faces_agree_ = false;
  std::vector<Segment> outline_;
};

/// All faces of three or more corners, leaf by leaf.
std::vector<int32_t> faces_by_leaf(const Foliage& foliage) {
  std::vector<int32_t> faces;
  faces.reserve(foliage.face_leaf.size());
  for (size_t face = 0; face < foliage.face_leaf.size(); ++face) {
    if (foliage.face_begin[face + 1] - foliage.face_begin[face] >= 3) {
      faces.push_back(static_cast<int32_t>(face));
    }
  }
  const auto by_leaf = [&foliage](int32_t a, int32_t b) {
    return foliage.face_leaf[a] < foliage.face_leaf[b];
  };
  if (!std::is_sorted(faces.begin(), faces.end(), by_leaf)) {
    std::stable_sort(faces.begin(), faces.end(), by_leaf);
  }
  return faces;
}

}  // namespace

LeafCharts flatten_leaves(const Foliage& foliage, const base::Execution& execution) {
  LeafCharts result;
  result.faces = faces_by_leaf(foliage);
  result.points.assign(foliage.corner_vertex.size(), glm::vec2(0.0f));
  // First face of each leaf, and the end of the last one.
  std::vector<int32_t> leaves;
  for (size_t i = 0; i < result.faces.size(); ++i) {
    if (i == 0 || foliage.face_leaf[result.faces[i]] != foliage.face_leaf[result.faces[i - 1]]) {
      leaves.push_back(static_cast<int32_t>(i));
    }
  }
  const size_t leaf_count = leaves.size();
  leaves.push_back(static_cast<int32_t>(result.faces.size()));
  std::vector<std::vector<LeafChart>> parts((leaf_count + kLeafBlock - 1) / kLeafBlock);
  base::parallel_for(leaf_count, kLeafBlock, execution, [&](size_t begin, size_t end) {
    std::vector<LeafChart>& charts = parts[begin / kLeafBlock];
    charts.reserve(end - begin);
    LeafFlattener flattener(foliage, result, charts);
    for (size_t leaf = begin; leaf < end; ++leaf) {
      flattener.add_leaf(leaves[leaf], leaves[leaf + 1]);
    }
  });
  for (const std::vector<LeafChart>& part : parts) {
    result.charts.insert(result.charts.end(), part.begin(), part.end());
  }
  return result;
}

}  // namespace snowbough::tree
