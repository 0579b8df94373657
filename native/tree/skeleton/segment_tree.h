#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <vector>

#include "base/simd.h"
#include "tree/skeleton/skeleton.h"

namespace snowbough::tree {

/// Where on a centreline a point is nearest.
struct NearestSegment {
  /// -1 when no branch qualifies.
  int32_t branch = -1;
  int32_t segment = 0;
  /// 0..1 along the segment.
  float t = 0.0f;
  glm::vec3 point{0.0f};
  float distance = 0.0f;
  /// Limb radius there, interpolated.
  float radius = 0.0f;
  /// The distance in the measure asked for.
  double cost = 0.0;
};

/// What "nearest" means.
enum class Measure {
  /// Metres to the centreline.
  kDistance,
  /// Distance in radii of the limb found.
  kRadii,
  /// Metres to the limb's surface; inside and on it, a twentieth of those to the centreline.
  kSurface,
};

/// The centreline segments of all branches in a bounding volume hierarchy of four children a node.
class SegmentTree {
 public:
  /// @param order per branch, any numbers: a search sees branches with a smaller order than it asks
  ///   for. Branches of one point count as a segment of no length; those of none are left out.
  /// @param radius_floor added to radii in kRadii, so that a limb of no thickness can win too.
  SegmentTree(const std::vector<Branch>& branches, std::vector<int32_t> order, float radius_floor);

  /// The nearest segment among branches whose order is below `below_order`. Of equals the one whose
  /// branch, then segment, has the smallest index.
  /// @param excluded per branch: not to be found; null = none.
  /// @param limit only what is nearer than this, in the measure, is found.
  NearestSegment nearest(const glm::vec3& point, int32_t below_order, Measure measure,
                         const std::vector<char>* excluded = nullptr,
                         double limit = std::numeric_limits<double>::infinity()) const;

 private:
  struct Segment {
    glm::vec3 a, b;
    float radius_a, radius_b;
    int32_t branch, segment;
  };
  /// Four boxes around segments, with the largest radius and the smallest order in each. A lane
  /// that is not used has the largest order there is.
  struct Node {
    std::array<base::Float4, 3> low, high;
    base::Float4 radius;
    base::Int4 order;
    /// The node, or the first of `count` entries of fours_, that a box is around.
    std::array<int32_t, 4> child;
    std::array<int32_t, 4> count;
  };
  /// Up to four segments_ from `first` on, as floats, to tell most of those that are too far.
  struct Four {
    std::array<base::Float4, 3> from, along;
    /// One over the squared length, 0 for a segment of none.
    base::Float4 inverse;
    /// The larger of both ends' radii.
    base::Float4 radius;
    /// By how much rounding may enlarge a distance.
    base::Float4 slack;
    base::Int4 order;
    int32_t first;
  };
  class Search;

  int32_t build(int32_t begin, int32_t end);
  int32_t split(int32_t begin, int32_t end);
  void add_fours(int32_t begin, int32_t end);

  std::vector<Segment> segments_;
  std::vector<Node> nodes_;
  std::vector<Four> fours_;
  std::vector<int32_t> order_;
  float radius_floor_;
};

}  // namespace snowbough::tree
