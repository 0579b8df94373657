#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "base/triangle_tree.h"
#include "snow/surface/cell_grid.h"
#include "snow/surface/surface_mesh.h"

namespace snowbough::snow {

/// A piece of a rim: an edge over which snow can lean, because the surface that carries it ends or
/// turns down there.
struct Rim {
  glm::vec3 from, to;
  /// Unit normals of the carrying face and of the far one (0, 0, 0: the surface ends).
  glm::vec3 support, far_normal;
  /// Unit vectors across the rim: out of the carrying face in its plane, and down the far face (or
  /// 0, 0, 0).
  glm::vec3 out, down;
  /// Metres that the far face goes down at the rim's middle, as far as anybody asked.
  float far_extent = 0.0f;
  /// The connected part of the mesh that it belongs to.
  int32_t part = 0;
};

/// Where a point of a face is, as the rims near it see it. Directions and foot are means over all
/// rims about as near, so that they turn smoothly around corners.
struct RimPlace {
  /// No rim is near.
  bool is_far_off = true;
  /// Metres to the nearest rim; negative for points of a face that goes down from it.
  float distance = 0.0f;
  glm::vec3 out{0.0f}, level_out{0.0f}, down{0.0f}, foot{0.0f}, support{0.0f};
  bool has_far = false;
  float far_extent = 0.0f;
};

/// The rims of a mesh in one pose.
class Rims {
 public:
  /// @param mesh receiver_mesh; @param tree of it; @param shading as in SurfaceSource; @param reach
  /// metres within which points ask for rims, over 0; @param far_reach metres down the far faces
  /// that matter.
  Rims(const SurfaceMesh& mesh, const base::TriangleTree& tree, const std::vector<int32_t>& shading,
       float reach, float far_reach);

  const std::vector<Rim>& all() const { return rims_; }
  /// Of each triangle of the mesh given to the constructor its connected part.
  const std::vector<int32_t>& parts() const { return part_of_triangle_; }

  /// What the rims of `part` near `point`, which lies on a face with that normal, say. `softness`:
  /// metres over which a rim gives way to the next.
  RimPlace place(const glm::vec3& point, const glm::vec3& normal, int32_t part,
                 float softness) const;

  /// Metres from a point of a face with that normal to the nearest rim whose carrying or, if
  /// `far_too`, far face it may lie on; the reach where none is nearer.
  float distance(const glm::vec3& point, const glm::vec3& normal, int32_t part, bool far_too) const;

  /// Metres that lie free on the carrying face behind `place.foot`: to the middle between this rim
  /// and those opposite, at most `most`.
  float room(const RimPlace& place, int32_t part, float most) const;

  /// A rim that faces this one across a gap.
  struct Opposite {
    /// 0 where there is none, 1 where it lies straight opposite.
    float nearness = 0.0f;
    float gap = 0.0f;
    /// How much higher it is.
    float step = 0.0f;
  };
  /// The rim opposite to `place.foot`, of whatever part, that is nearest: over a gap of at most
  /// `most` metres.
  Opposite opposite(const RimPlace& place, float most) const;

 private:
  /// Calls visit(index) for the rims of a part that may lie within `reach_` of a point, some of
  /// them twice.
  template <typename Visit>
  void visit_near(const glm::vec3& point, int32_t part, const Visit& visit) const;

  /// Sorted by part; those of part p are from part_begin_[p] to part_begin_[p + 1].
  std::vector<Rim> rims_;
  std::vector<int32_t> part_begin_;
  std::vector<int32_t> part_of_triangle_;
  float reach_;
  CellGrid grid_;
};

}  // namespace snowbough::snow
