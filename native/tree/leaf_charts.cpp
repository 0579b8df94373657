#include "tree/leaf_charts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>
#include <utility>

namespace snowbough::tree {
namespace {

/// Leaves that a thread takes at a time.
constexpr size_t kLeafBlock = 512;
/// A face that shows less than this share of its area along the sheet's normal gets its own chart.
constexpr double kMinFacing = 0.25;
/// Sheets with a longer outline are taken apart, as testing them for folds grows with its square.
constexpr size_t kMaxOutline = 400;
/// Size in metres of what stands for a face without area; it is widened later.
constexpr double kNoSize = 1e-12;

using Point = glm::dvec2;

/// An edge of a face, and the two points where it starts and ends.
struct Edge {
  /// Its vertices, the lower one first.
  uint64_t vertices;
  bool forward;
  /// Counted from the sheet's first one.
  int32_t face;
  int32_t point, next_point;
};

Edge edge_between(int32_t from, int32_t to, int32_t face, int32_t point, int32_t next_point) {
  const auto low = static_cast<uint32_t>(std::min(from, to));
  const auto high = static_cast<uint32_t>(std::max(from, to));
  return {uint64_t{low} << 32U | high, from < to, face, point, next_point};
}

/// An edge of the outline, with the sheet on its left.
struct Segment {
  uint64_t vertices;
  Point a, b;

  bool shares_vertex(const Segment& other) const {
    const auto low = static_cast<uint32_t>(vertices >> 32U);
    const auto high = static_cast<uint32_t>(vertices);
    const auto other_low = static_cast<uint32_t>(other.vertices >> 32U);
    const auto other_high = static_cast<uint32_t>(other.vertices);
    return low == other_low || low == other_high || high == other_low || high == other_high;
  }
};

/// Twice the signed area of a triangle.
double turn(const Point& a, const Point& b, const Point& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

bool touch(const Segment& p, const Segment& q) {
  return turn(p.a, p.b, q.a) * turn(p.a, p.b, q.b) <= 0.0 &&
         turn(q.a, q.b, p.a) * turn(q.a, q.b, p.b) <= 0.0;
}

/// Whether an outline goes round `centre` once, always anticlockwise: then it does not cross
/// itself.
bool is_star(const std::vector<Segment>& outline, const Point& centre) {
  int rounds = 0;
  for (const Segment& edge : outline) {
    if (turn(centre, edge.a, edge.b) <= 0.0) {
      return false;
    }
    // Going up, it passes on the right.
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

/// Turns the points so that their widest spread stands upright, and moves them to the origin.
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
  // The covariance's first axis lies at half the angle of (xx - yy, 2 xy).
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

/// Lays leaves flat, one after the other. Vectors are kept from one to the next.
class LeafFlattener {
 public:
  /// @param result  the faces of the leaves to come and their points are its to change.
  /// @param charts  where charts are added.
  LeafFlattener(const Foliage& foliage, LeafCharts& result, std::vector<LeafChart>& charts)
      : foliage_(foliage), result_(result), charts_(charts) {}

  /// Adds the charts of the leaf that has faces [first, last) of the result's.
  void add_leaf(int32_t first, int32_t last) {
    sort_edges(first, last);
    if (group_sheets(last - first) == 1) {
      add_sheet(first, last);
      return;
    }
    // One sheet's faces after another's, each in their order.
    std::vector<int32_t> faces(result_.faces.begin() + first, result_.faces.begin() + last);
    std::vector<int32_t> order(faces.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(),
                     [this](int32_t a, int32_t b) { return group_[a] < group_[b]; });
    const std::vector<int32_t> group = group_;
    for (size_t i = 0; i < order.size(); ++i) {
      result_.faces[first + i] = faces[order[i]];
    }
    for (size_t begin = 0; begin < order.size();) {
      size_t end = begin + 1;
      while (end < order.size() && group[order[end]] == group[order[begin]]) {
        ++end;
      }
      const auto sheet_first = static_cast<int32_t>(first + begin);
      const auto sheet_last = static_cast<int32_t>(first + end);
      sort_edges(sheet_first, sheet_last);
      add_sheet(sheet_first, sheet_last);
      begin = end;
    }
  }

 private:
  int32_t corner_begin(int32_t at) const { return foliage_.face_begin[result_.faces[at]]; }
  int32_t corner_end(int32_t at) const { return foliage_.face_begin[result_.faces[at] + 1]; }

  /// The edges of some faces, equal ones side by side.
  void sort_edges(int32_t first, int32_t last) {
    edges_.clear();
    if (last - first == 1) {
      return;
    }
    int32_t point = 0;
    for (int32_t at = first; at < last; ++at) {
      const int32_t* const vertex = foliage_.corner_vertex.data() + corner_begin(at);
      const int32_t count = corner_end(at) - corner_begin(at);
      for (int32_t k = 0; k + 1 < count; ++k) {
        edges_.push_back(
            edge_between(vertex[k], vertex[k + 1], at - first, point + k, point + k + 1));
      }
      edges_.push_back(
          edge_between(vertex[count - 1], vertex[0], at - first, point + count - 1, point));
      point += count;
    }
    std::sort(edges_.begin(), edges_.end(), [](const Edge& a, const Edge& b) {
      return a.vertices != b.vertices ? a.vertices < b.vertices : a.point < b.point;
    });
  }

  /// Groups faces that hang together by edges: group_ has the first face of each one's sheet.
  /// @return number of sheets.
  int group_sheets(int32_t face_count) {
    group_.resize(face_count);
    std::iota(group_.begin(), group_.end(), 0);
    const auto find = [this](int32_t i) {
      while (group_[i] != i) {
        i = group_[i] = group_[group_[i]];
      }
      return i;
    };
    int sheets = face_count;
    for (size_t i = 1; i < edges_.size(); ++i) {
      if (edges_[i].vertices == edges_[i - 1].vertices) {
        const int32_t a = find(edges_[i].face);
        const int32_t b = find(edges_[i - 1].face);
        sheets -= a != b ? 1 : 0;
        group_[std::max(a, b)] = std::min(a, b);
      }
    }
    for (int32_t face = 0; face < face_count; ++face) {
      group_[face] = group_[group_[face]];
    }
    return sheets;
  }

  /// Adds a sheet, whose edges are sorted, as one chart, or else each of its faces as one.
  void add_sheet(int32_t first, int32_t last) {
    if (project(first, last) && (last - first == 1 || lies_flat())) {
      add_chart(first, last, straighten(points_));
    } else if (last - first == 1) {
      make_placeholder(corner_end(first) - corner_begin(first));
      add_chart(first, last, Point(2.0 * kNoSize));
    } else {
      for (int32_t at = first; at < last; ++at) {
        add_sheet(at, at + 1);
      }
    }
  }

  /// Newell's normal of a polygon: twice its area along each axis.
  static glm::dvec3 area_normal(std::span<const glm::dvec3> corners) {
    glm::dvec3 sum(0.0);
    for (size_t i = 2; i < corners.size(); ++i) {
      sum += glm::cross(corners[i - 1] - corners[0], corners[i] - corners[0]);
    }
    return sum;
  }

  /// Sees faces along their mean normal: fills points_ and faces_front_. False if there is none.
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
    faces_front_ = std::all_of(normals_.begin(), normals_.end(), [&](const glm::dvec3& face) {
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

  /// Whether the sheet lies flat without covering itself: every face shows its front, every inner
  /// edge has a face on either side, and the outline does not cross itself.
  bool lies_flat() {
    if (!faces_front_) {
      return false;
    }
    outline_.clear();
    for (size_t i = 0; i < edges_.size();) {
      size_t end = i + 1;
      while (end < edges_.size() && edges_[end].vertices == edges_[i].vertices) {
        ++end;
      }
      if (end - i > 2 || (end - i == 2 && edges_[i].forward == edges_[i + 1].forward)) {
        return false;
      }
      if (end - i == 1) {
        outline_.push_back(
            {edges_[i].vertices, points_[edges_[i].point], points_[edges_[i].next_point]});
      }
      i = end;
    }
    if (is_star(outline_, mean(points_))) {
      return true;
    }
    if (outline_.size() > kMaxOutline) {
      return false;
    }
    for (size_t i = 0; i < outline_.size(); ++i) {
      for (size_t j = i + 1; j < outline_.size(); ++j) {
        if (!outline_[i].shares_vertex(outline_[j]) && touch(outline_[i], outline_[j])) {
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
  std::vector<Edge> edges_;
  /// A parent in the faces' sheets; once they are known the first face of each one's.
  std::vector<int32_t> group_;
  /// The sheet's corners, face by face, and its faces' normals.
  std::vector<glm::dvec3> corners_;
  std::vector<glm::dvec3> normals_;
  /// The corners seen flat, and whether all of its faces show their front.
  std::vector<Point> points_;
  bool faces_front_ = false;
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

LeafCharts flatten_leaves(const Foliage& foliage, const Execution& execution) {
  LeafCharts result;
  result.faces = faces_by_leaf(foliage);
  result.points.assign(foliage.corner_vertex.size(), glm::vec2(0.0f));
  // Where each leaf's faces begin, and where the last one's end.
  std::vector<int32_t> leaves;
  for (size_t i = 0; i < result.faces.size(); ++i) {
    if (i == 0 || foliage.face_leaf[result.faces[i]] != foliage.face_leaf[result.faces[i - 1]]) {
      leaves.push_back(static_cast<int32_t>(i));
    }
  }
  const size_t leaf_count = leaves.size();
  leaves.push_back(static_cast<int32_t>(result.faces.size()));
  std::vector<std::vector<LeafChart>> parts((leaf_count + kLeafBlock - 1) / kLeafBlock);
  parallel_blocks(leaf_count, kLeafBlock, execution, [&](size_t begin, size_t end) {
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
