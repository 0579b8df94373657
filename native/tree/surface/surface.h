#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "tree/skeleton/tree_mesh.h"

namespace snowbough::tree {

/// Four vertices around a limb. Corner k+1 follows corner k anticlockwise seen from the tip.
struct Ring {
  std::array<int32_t, 4> vertices{};
  glm::dvec3 centre{0.0};
  glm::dvec3 normal{0.0, 0.0, 1.0};
  /// Distance of the corners from the centre; for a hole in the parent's side, that of a square of
  /// equal area.
  double corner = 0.0;
  /// Arc length on the branch's own centreline, which determines the ring's bones.
  double bone_length = 0.0;
};

/// One branch's strip: ring 0 is the root's own, the parent's end ring, or the hole in the parent.
struct LimbSurface {
  std::vector<Ring> rings;
  /// Ring 0 is the parent's end ring.
  bool continues_parent = false;
};

/// A child's exit through its parent's side.
struct Junction {
  int32_t parent = -1;
  int32_t child = -1;
  /// Row of the knuckle in the parent's strip, and its side.
  int32_t row = 0;
  int32_t side = 0;
  /// The hole is smaller than the side: four kInset quads lie around it.
  bool inset = false;
  /// Arc length on the parent's own centreline, which determines the bones of an inset's vertices.
  double parent_bone_length = 0.0;
};

struct Surface {
  std::vector<glm::dvec3> vertices;
  std::vector<Quad> quads;
  std::vector<FaceOrigin> origins;
  /// One per branch.
  std::vector<LimbSurface> limbs;
  /// Per branch: the limb that it leaves, or -1 (surface_parents).
  std::vector<int32_t> parents;
  std::vector<Junction> junctions;
  /// Branches thicker than their parent at their exit.
  std::vector<int32_t> clamped;
  /// Branches whose hole is shorter along the parent than they are wide, by more than a fifth,
  /// because the parent lacks room.
  std::vector<int32_t> squeezed;
};

struct SurfaceOptions {
  bool close_root = true;
  bool close_tips = true;
};

}  // namespace snowbough::tree
