#include "tree/original/original_uvs.h"

#include <algorithm>
#include <array>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <span>

#include "base/group_by_key.h"
#include "base/triangle_tree.h"
#include "tree/original/unrolled.h"

namespace snowbough::tree {
namespace {

/// Faces or vertices per thread at a time.
constexpr size_t kBlock = 1024;

/// Polylines, one per branch, and nearest-place queries on them. Most have a few points: there is a
/// box for each run of segments, and no tree.
class Polylines {
 public:
  struct Place {
    glm::dvec3 point{0.0};
    /// From the begin of the segment to its end.
    glm::dvec3 segment{0.0};
  };

  /// @param points_of  the points of branch b.
  template <typename PointsOf>
  Polylines(size_t count, const PointsOf& points_of) {
    for (size_t b = 0; b < count; ++b) {
      const std::vector<glm::vec3>& points = points_of(b);
      const size_t segments = points.size() > 1 ? points.size() - 1 : points.size();
      for (size_t i = 0; i < segments; ++i) {
        if (i % kRun == 0) runs_.push_back({segments_.size(), points[i], points[i]});
        const glm::vec3& end = points[std::min(i + 1, points.size() - 1)];
        segments_.push_back({points[i], end});
        Run& run = runs_.back();
        run.low = glm::min(run.low, glm::dvec3(end));
        run.high = glm::max(run.high, glm::dvec3(end));
      }
      first_run_.push_back(runs_.size());
    }
    runs_.push_back({segments_.size(), glm::dvec3(0.0), glm::dvec3(0.0)});
  }

  /// Of equally near segments the first.
  Place nearest(int32_t branch, const glm::dvec3& p) const {
    Place place;
    double least = std::numeric_limits<double>::infinity();
    for (size_t r = first_run_[branch]; r < first_run_[branch + 1]; ++r) {
      const glm::dvec3 outside = p - glm::clamp(p, runs_[r].low, runs_[r].high);
      if (glm::dot(outside, outside) >= least) continue;
      for (size_t i = runs_[r].begin; i < runs_[r + 1].begin; ++i) {
        const auto& [a, b] = segments_[i];
        const glm::dvec3 along = b - a;
        const double from_a = glm::dot(along, p - a), from_b = glm::dot(along, p - b);
        const glm::dvec3 point = from_a <= 0.0   ? a
                                 : from_b >= 0.0 ? b
                                                 : a + along * (from_a / (from_a - from_b));
        const double square = glm::dot(p - point, p - point);
        if (square < least) {
          least = square;
          place = {point, along};
        }
      }
    }
    return place;
  }

 private:
  static constexpr size_t kRun = 8;
  /// Segments from `begin` to the begin of the next run, and their bounding box.
  struct Run {
    size_t begin;
    glm::dvec3 low, high;
  };

  std::vector<std::array<glm::dvec3, 2>> segments_;
  std::vector<Run> runs_;
  std::vector<size_t> first_run_{0};
};

/// The positions of the rebuilt limbs' points around the original axes.
class Axes {
 public:
  explicit Axes(const Skeleton& skeleton)
      : ours_(
            skeleton.branches.size(),
            [&](size_t b) -> const auto& { return skeleton.branches[b].points; }),
        original_(
            skeleton.branches.size(), [&](size_t b) -> const auto& {
              return skeleton.wood.centrelines[b];
            }) {}

  AxisPlace place(int32_t branch, const glm::dvec3& p) const {
    const glm::dvec3 on_ours = ours_.nearest(branch, p).point;
    const Polylines::Place on_original = original_.nearest(branch, on_ours);
    AxisPlace place;
    place.axis = on_original.point;
    const double length = glm::length(on_original.segment);
    if (length > 0.0) place.along = on_original.segment / length;
    const glm::dvec3 off = p - on_ours;
    place.beyond = glm::dot(off, place.along);
    place.across = off - place.along * place.beyond;
    return place;
  }

 private:
  Polylines ours_, original_;
};

/// Looks up the faces of a mesh.
class FaceLookup {
 public:
  FaceLookup(const Skeleton& skeleton, const TreeMesh& mesh, const base::Execution& execution)
      : skeleton_(skeleton),
        mesh_(mesh),
        wood_(skeleton.wood),
        execution_(execution),
        axes_(skeleton),
        triangles_(wood_.vertices, wood_.triangles, wood_.piece_begin),
        unrolled_(wood_),
        middle_(mesh.quads.size(), -1) {}

  /// Finds the triangle at each face's centre.
  /// @param material receives their materials.
  void find_middles(std::vector<int32_t>& material) {
    base::parallel_for(mesh_.quads.size(), kBlock, execution_, [&](size_t begin, size_t end) {
      int32_t before = -1, piece_before = -1;
      for (size_t f = begin; f < end; ++f) {
        const int32_t branch = mesh_.origins[f].branch;
        const int32_t piece = skeleton_.branches[branch].piece;
        if (piece < 0 || wood_.piece_begin[piece] == wood_.piece_begin[piece + 1]) continue;
        glm::dvec3 centre(0.0);
        for (const int32_t v : mesh_.quads[f]) centre += glm::dvec3(mesh_.vertices[v]) / 4.0;
        const AxisPlace place = axes_.place(branch, centre);
        // Relative to the original's axis, not the rebuilt one.
        const glm::dvec3 there = place.axis + place.across + place.along * place.beyond;
        // Successive faces are close together.
        const int32_t hint = piece == piece_before ? before : -1;
        before = triangles_.nearest(piece, there, hint).triangle;
        piece_before = piece;
        middle_[f] = unrolled_.walk(place, before).triangle;
        material[f] = wood_.triangle_material[middle_[f]];
      }
    });
  }

  /// Walks from the faces' middles to their corners. Faces around a vertex mostly have one middle
  /// or two: as many walks are made.
  /// @param uv receives the coordinates of faces whose piece has any.
  void find_corners(std::vector<QuadUv>& uv) const {
    std::vector<size_t> first;
    std::vector<int32_t> corners;
    const auto for_corners = [&](const auto& visit) {
      for (size_t f = 0; f < mesh_.quads.size(); ++f) {
        const bool textured =
            middle_[f] >= 0 &&
            wood_.piece_textured[skeleton_.branches[mesh_.origins[f].branch].piece] != 0;
        for (int k = 0; textured && k < 4; ++k) {
          visit(mesh_.quads[f][k], static_cast<int32_t>(4 * f) + k);
        }
      }
    };
    base::group_by_key(mesh_.vertices.size(), for_corners, first, corners);
    base::parallel_for(mesh_.vertices.size(), kBlock, execution_, [&](size_t begin, size_t end) {
      for (size_t v = begin; v < end; ++v) {
        const std::span around(corners.data() + first[v], first[v + 1] - first[v]);
        AxisPlace place;
        int32_t branch = -1;
        for (size_t i = 0; i < around.size(); ++i) {
          const int32_t face = around[i] / 4;
          glm::vec2& found = uv[face][around[i] % 4];
          const auto same = std::find_if(around.begin(), around.begin() + i, [&](int32_t other) {
            return middle_[other / 4] == middle_[face] &&
                   mesh_.origins[other / 4].branch == mesh_.origins[face].branch;
          });
          if (same != around.begin() + i) {
            found = uv[*same / 4][*same % 4];
            continue;
          }
          if (mesh_.origins[face].branch != branch) {
            branch = mesh_.origins[face].branch;
            place = axes_.place(branch, glm::dvec3(mesh_.vertices[v]));
          }
          found = unrolled_.walk(place, middle_[face]).uv;
        }
      }
    });
  }

 private:
  const Skeleton& skeleton_;
  const TreeMesh& mesh_;
  const OriginalWood& wood_;
  const base::Execution& execution_;
  Axes axes_;
  base::TriangleTree triangles_;
  Unrolled unrolled_;
  /// Per face: the triangle at its centre, or -1 if its piece has none.
  std::vector<int32_t> middle_;
};

}  // namespace

OriginalUvs original_uvs(const Skeleton& skeleton, const TreeMesh& mesh,
                         const base::Execution& execution) {
  const OriginalWood& wood = skeleton.wood;
  OriginalUvs result;
  result.material.assign(mesh.quads.size(), -1);
  for (size_t f = 0; f < mesh.quads.size(); ++f) {
    const int32_t piece = skeleton.branches[mesh.origins[f].branch].piece;
    if (piece >= 0) result.material[f] = wood.piece_material[piece];
  }
  if (wood.triangles.empty()) return result;

  FaceLookup lookup(skeleton, mesh, execution);
  lookup.find_middles(result.material);
  if (std::find(wood.piece_textured.begin(), wood.piece_textured.end(), 1) !=
      wood.piece_textured.end()) {
    result.uv = mesh.uv_bark;
    lookup.find_corners(result.uv);
  }
  return result;
}

}  // namespace snowbough::tree
