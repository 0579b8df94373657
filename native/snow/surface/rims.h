#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "base/triangle_tree.h"
#include "snow/surface/cell_grid.h"
#include "snow/surface/surface_mesh.h"

namespace snowbough::snow {

/// A segment of a rim: a line over which snow can lean, because the supporting surface ends or
/// turns down there. Where it turns down over a strip of faces, such as a bevel, the line lies
/// outside, where the planes of the supporting and the far face meet.
struct Rim {
  glm::vec3 from, to;
  /// Unit normals of the supporting face and of the far face; the latter is (0, 0, 0) if the
  /// surface ends at the rim.
  glm::vec3 support, far_normal;
  /// Unit vectors across the rim: outwards in the plane of the supporting face, and down the far
  /// face. The latter is (0, 0, 0) if there is no far face.
  glm::vec3 out, down;
  /// Length of the far face below the middle of the rim, in metres, up to the distance searched.
  float far_extent = 0.0f;
  /// Length of the supporting face behind the middle of the rim, up to where the surface ends or
  /// turns down, in metres, up to the distance searched; twice the length up to a wall.
  float extent = 0.0f;
  /// Distances from the rim to the strip's upper edge, against `out`, and to its lower edge, along
  /// `down`, in metres; 0 at an edge.
  float strip_out = 0.0f;
  float strip_down = 0.0f;
  /// Number of faces across the strip.
  int32_t strip_faces = 0;
  /// The ends of the edge in the mesh, and the part of the mesh (face_parts) that holds its
  /// supporting face.
  std::array<int32_t, 2> corner{};
  int32_t part = 0;
};

/// Position of a point on a face relative to the rims near it. Directions and `foot` (the nearest
/// point of the rim) are means over the rims at about the same distance, so that they turn smoothly
/// around corners.
struct RimPosition {
  /// No rim is near.
  bool is_far_off = true;
  /// Distance to the nearest rim in metres; negative for points on a far face. On a strip: how far
  /// the rim lies outwards, less how far the point lies below it.
  float distance = 0.0f;
  /// How far the point lies below the rim, along `down`; 0 on the supporting face.
  float below = 0.0f;
  /// Width of the strip and number of faces across it: 0 at an edge.
  float strip = 0.0f;
  int32_t strip_faces = 0;
  glm::vec3 out{0.0f}, level_out{0.0f}, down{0.0f}, foot{0.0f}, support{0.0f};
  bool has_far = false;
  float far_extent = 0.0f, extent = 0.0f;
  /// The rims of which the place is the mean: the nearest ones, with weights that sum to 1.
  struct Part {
    int32_t rim = 0;
    float weight = 0.0f;
    glm::vec3 foot{0.0f};
  };
  std::array<Part, 3> parts{};
};

/// The rims of a mesh in one pose.
class Rims {
 public:
  /// @param mesh the result of receiver_mesh.
  /// @param tree a tree over the triangles of `mesh`.
  /// @param shading as in SurfaceSource.
  /// @param reach greatest distance from a point to a rim that a query finds, in metres, over 0.
  /// @param far_reach greatest distance searched down the far faces, in metres.
  /// @param strip greatest width of a strip that is one rim, in metres.
  Rims(const SurfaceMesh& mesh, const base::TriangleTree& tree, const std::vector<int32_t>& shading,
       float reach, float far_reach, float strip);

  const std::vector<Rim>& all() const { return rims_; }
  /// The part of each triangle of the mesh that was passed to the constructor.
  const std::vector<int32_t>& parts() const { return part_of_triangle_; }

  /// Position of `point` relative to the rims of `part` near it. `normal`: unit normal of the face
  /// that holds the point. `softness`: distance in metres over which the result blends from one rim
  /// to the next.
  RimPosition place(const glm::vec3& point, const glm::vec3& normal, int32_t part,
                    float softness) const;

  /// Distance in metres from a point to the nearest rim on the same face, or `reach` if no rim is
  /// nearer. `normal`: unit normal of the face that holds the point. The face may be the rim's
  /// supporting face or, if `far_too`, its far face.
  float distance(const glm::vec3& point, const glm::vec3& normal, int32_t part, bool far_too) const;

  /// Free width of the supporting face behind `place.foot` in metres: the distance to the middle
  /// between this rim and those opposite or the end of the face, at most `most`.
  /// `narrow`: also of tops that are narrower than a few steps of the search, which else count as
  /// wide.
  float room(const RimPosition& place, int32_t part, float most, bool narrow = true) const;

  /// A rim that faces this one across a gap.
  struct Opposite {
    /// 0 without such a rim, 1 if it lies straight opposite.
    float nearness = 0.0f;
    float gap = 0.0f;
    /// Height of the other rim above this one, in metres.
    float step = 0.0f;
  };
  /// The nearest rims of any part opposite to the place's own rims, over gaps of at most `most`
  /// metres: the mean over its rims. The gap is measured along `place.level_out`.
  Opposite opposite(const RimPosition& place, float most) const;

  /// A rim of any part above a face.
  struct Step {
    /// Height of the rim above the face, in metres; 0 without a rim.
    float height = 0.0f;
    /// Level distance of the point from the rim, outwards.
    float out = 0.0f;
    glm::vec3 foot{0.0f}, level_out{0.0f};
  };
  /// The nearest rim beside which, or below which, a point lies: up to `reach` metres away, and up
  /// to `most` metres above the point's face, whose unit normal is `normal`.
  Step step_above(const glm::vec3& point, const glm::vec3& normal, float reach, float most) const;

 private:
  Opposite opposite_of(const Rim& rim, const glm::vec3& foot, float most) const;
  /// Calls visit(index) for the rims of a part that may lie within `reach_` of a point. It may
  /// visit a rim more than once.
  template <typename Visit>
  void visit_near(const glm::vec3& point, int32_t part, const Visit& visit) const;

  /// Sorted by part. The rims of part p have the indices part_begin_[p] to part_begin_[p + 1] - 1.
  std::vector<Rim> rims_;
  std::vector<int32_t> part_begin_;
  std::vector<int32_t> part_of_triangle_;
  float reach_;
  CellGrid grid_;
};

}  // namespace snowbough::snow
