#include "tree/original/original_uvs.h"

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>

#include "base/triangle_tree.h"
#include "tree/original/unrolled.h"

namespace snowbough::tree {
namespace {

/// Faces per thread at a time.
constexpr size_t kBlock = 1024;

/// Polylines, one per branch, and nearest-place queries on them.
class Polylines {
 public:
  /// @param points_of  the points of branch b.
  template <typename PointsOf>
  Polylines(size_t count, const PointsOf& points_of) {
    for (size_t b = 0; b < count; ++b) {
      const std::vector<glm::vec3>& points = points_of(b);
      const auto first = static_cast<int32_t>(points_.size());
      points_.insert(points_.end(), points.begin(), points.end());
      const auto last = static_cast<int32_t>(points_.size()) - 1;
      if (first == last) segments_.push_back({first, first, first});
      for (int32_t i = first; i < last; ++i) segments_.push_back({i, i + 1, i + 1});
      begin_.push_back(static_cast<int32_t>(segments_.size()));
    }
  }

  base::TriangleTree tree() const { return {points_, segments_, begin_}; }
  glm::dvec3 from(int32_t segment) const { return points_[segments_[segment][0]]; }
  glm::dvec3 to(int32_t segment) const { return points_[segments_[segment][1]]; }

 private:
  std::vector<glm::vec3> points_;
  std::vector<std::array<int32_t, 3>> segments_;
  std::vector<int32_t> begin_{0};
};

/// The positions of the rebuilt limbs' points around the original axes.
class Axes {
 public:
  explicit Axes(const Skeleton& skeleton)
      : ours_(
            skeleton.branches.size(),
            [&](size_t b) -> const auto& { return skeleton.branches[b].points; }),
        original_(
            skeleton.branches.size(),
            [&](size_t b) -> const auto& { return skeleton.wood.centrelines[b]; }),
        near_ours_(ours_.tree()),
        near_original_(original_.tree()) {}

  AxisPlace place(int32_t branch, const glm::dvec3& p) const {
    const glm::dvec3 on_ours = near_ours_.nearest(branch, p).point;
    const base::TriangleTree::Nearest on_original = near_original_.nearest(branch, on_ours);
    AxisPlace place;
    place.axis = on_original.point;
    const glm::dvec3 segment =
        original_.to(on_original.triangle) - original_.from(on_original.triangle);
    const double length = glm::length(segment);
    if (length > 0.0) place.along = segment / length;
    const glm::dvec3 off = p - on_ours;
    place.beyond = glm::dot(off, place.along);
    place.across = off - place.along * place.beyond;
    return place;
  }

 private:
  Polylines ours_, original_;
  base::TriangleTree near_ours_, near_original_;
};

/// Looks up the faces of a mesh, one by one.
class FaceLookup {
 public:
  FaceLookup(const Skeleton& skeleton, const TreeMesh& mesh)
      : mesh_(mesh),
        wood_(skeleton.wood),
        axes_(skeleton),
        triangles_(wood_.vertices, wood_.triangles, wood_.piece_begin),
        unrolled_(wood_) {}

  /// Computes the places of all vertices on the first branch that uses them: most faces then need
  /// no searches for their corners.
  void place_vertices(const base::Execution& execution) {
    branch_of_.assign(mesh_.vertices.size(), -1);
    for (size_t f = 0; f < mesh_.quads.size(); ++f) {
      for (const int32_t v : mesh_.quads[f]) {
        if (branch_of_[v] < 0) branch_of_[v] = mesh_.origins[f].branch;
      }
    }
    places_.resize(mesh_.vertices.size());
    base::parallel_for(places_.size(), kBlock, execution, [&](size_t begin, size_t end) {
      for (size_t v = begin; v < end; ++v) {
        const int32_t branch = branch_of_[v];
        if (branch >= 0) places_[v] = axes_.place(branch, glm::dvec3(mesh_.vertices[v]));
      }
    });
  }

  /// @param uv receives the coordinates, if the piece has any.
  /// @return the face's material.
  int32_t look_up(size_t face, int32_t branch, int32_t piece, QuadUv& uv) const {
    const Quad& quad = mesh_.quads[face];
    glm::dvec3 centre(0.0);
    for (const int32_t v : quad) centre += glm::dvec3(mesh_.vertices[v]) / 4.0;
    const AxisPlace place = axes_.place(branch, centre);
    // Relative to the original's axis, not the rebuilt one.
    const glm::dvec3 there = place.axis + place.across + place.along * place.beyond;
    const int32_t nearest = triangles_.nearest(piece, there).triangle;
    const int32_t middle = unrolled_.walk(place, nearest).triangle;
    if (wood_.piece_textured[piece] != 0) {
      for (int k = 0; k < 4; ++k) {
        const int32_t v = quad[k];
        const AxisPlace corner = branch_of_[v] == branch
                                     ? places_[v]
                                     : axes_.place(branch, glm::dvec3(mesh_.vertices[v]));
        uv[k] = unrolled_.walk(corner, middle).uv;
      }
    }
    return wood_.triangle_material[middle];
  }

 private:
  const TreeMesh& mesh_;
  const OriginalWood& wood_;
  Axes axes_;
  base::TriangleTree triangles_;
  Unrolled unrolled_;
  std::vector<int32_t> branch_of_;
  std::vector<AxisPlace> places_;
};

}  // namespace

OriginalUvs original_uvs(const Skeleton& skeleton, const TreeMesh& mesh,
                         const base::Execution& execution) {
  const OriginalWood& wood = skeleton.wood;
  OriginalUvs result;
  result.material.assign(mesh.quads.size(), -1);
  const auto piece_of = [&](size_t face) {
    return skeleton.branches[mesh.origins[face].branch].piece;
  };
  for (size_t f = 0; f < mesh.quads.size(); ++f) {
    if (piece_of(f) >= 0) result.material[f] = wood.piece_material[piece_of(f)];
  }
  if (wood.triangles.empty()) return result;

  const bool textured = std::find(wood.piece_textured.begin(), wood.piece_textured.end(), 1) !=
                        wood.piece_textured.end();
  if (textured) result.uv = mesh.uv_bark;
  FaceLookup lookup(skeleton, mesh);
  if (textured) lookup.place_vertices(execution);
  base::parallel_for(mesh.quads.size(), kBlock, execution, [&](size_t begin, size_t end) {
    QuadUv none{};
    for (size_t f = begin; f < end; ++f) {
      const int32_t piece = piece_of(f);
      if (piece < 0 || wood.piece_begin[piece] == wood.piece_begin[piece + 1]) continue;
      QuadUv& uv = textured ? result.uv[f] : none;
      result.material[f] = lookup.look_up(f, mesh.origins[f].branch, piece, uv);
    }
  });
  return result;
}

}  // namespace snowbough::tree
