#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "support/chart_measure.h"
#include "tree/skeleton/skeleton.h"
#include "tree/skeleton/tree_mesh.h"

namespace snowbough::tree::test {

using Ring = std::array<int32_t, 4>;

/// Four-sided limbs put together by hand, in the conventions of tree_mesh.h.
struct LimbBuilder {
  TreeMesh mesh;
  Skeleton skeleton;
  /// Last ring of every limb.
  std::vector<Ring> ends;

  /// A square of vertices with `half_diagonal` from its centre to its corners, corners
  /// anticlockwise seen from where `axis` points to.
  Ring add_ring(const glm::vec3& centre, const glm::vec3& axis, float half_diagonal) {
    const glm::vec3 along = glm::normalize(axis);
    const glm::vec3 helper = std::abs(along.z) < 0.9f ? glm::vec3(0, 0, 1) : glm::vec3(1, 0, 0);
    const glm::vec3 a = glm::normalize(glm::cross(helper, along));
    const glm::vec3 b = glm::cross(along, a);
    const auto first = static_cast<int32_t>(mesh.vertices.size());
    for (const glm::vec3& direction : {a, b, -a, -b}) {
      mesh.vertices.push_back(centre + direction * half_diagonal);
    }
    return {first, first + 1, first + 2, first + 3};
  }

  int32_t add_branch(int32_t parent) {
    Branch branch;
    branch.parent = parent;
    branch.points = {glm::vec3(0.0f)};
    skeleton.branches.push_back(branch);
    ends.emplace_back();
    return static_cast<int32_t>(skeleton.branches.size()) - 1;
  }

  void add_quad(const Quad& quad, const FaceOrigin& origin) {
    mesh.quads.push_back(quad);
    mesh.origins.push_back(origin);
  }

  void add_wall(int32_t branch, int32_t row, int32_t side, const Ring& low, const Ring& high) {
    const int32_t next = (side + 1) % 4;
    add_quad({low[side], low[next], high[next], high[side]},
             {branch, row, side, 0, FacePart::kWall});
  }

  void add_row(int32_t branch, int32_t row, const Ring& low, const Ring& high) {
    for (int32_t side = 0; side < 4; ++side) {
      add_wall(branch, row, side, low, high);
    }
  }

  void add_root_cap(int32_t branch, const Ring& ring) {
    add_quad({ring[0], ring[3], ring[2], ring[1]}, {branch, 0, 0, 0, FacePart::kRootCap});
  }

  void add_tip_cap(int32_t branch, int32_t rows, const Ring& ring) {
    add_quad({ring[0], ring[1], ring[2], ring[3]}, {branch, rows, 0, 0, FacePart::kTipCap});
  }

  /// A straight limb of its own, closed at both ends, in `rows` rows from radius r0 to r1.
  int32_t add_limb(const glm::vec3& root, const glm::vec3& tip, float r0, float r1, int32_t rows) {
    const int32_t branch = add_branch(-1);
    Ring low = add_ring(root, tip - root, r0);
    add_root_cap(branch, low);
    for (int32_t row = 0; row < rows; ++row) {
      const float t = static_cast<float>(row + 1) / static_cast<float>(rows);
      const Ring high = add_ring(root + (tip - root) * t, tip - root, r0 + (r1 - r0) * t);
      add_row(branch, row, low, high);
      low = high;
    }
    add_tip_cap(branch, rows, low);
    ends[branch] = low;
    return branch;
  }
};

inline UvLayoutMeasure measure_snow(const TreeMesh& mesh, int resolution) {
  UvSurface surface;
  surface.vertices = mesh.vertices;
  for (size_t quad = 0; quad < mesh.quads.size(); ++quad) {
    for (int corner = 0; corner < 4; ++corner) {
      surface.corner_vertex.push_back(mesh.quads[quad][corner]);
      surface.corner_uv.push_back(mesh.uv_snow[quad][corner]);
    }
  }
  return measure_uv_layout(surface, resolution);
}

/// The quad with this origin; -1 if there is none.
inline int32_t find_quad(const TreeMesh& mesh, int32_t branch, int32_t row, int32_t side,
                         FacePart part = FacePart::kWall, int32_t inset = 0) {
  for (size_t quad = 0; quad < mesh.quads.size(); ++quad) {
    const FaceOrigin& origin = mesh.origins[quad];
    if (origin.branch == branch && origin.row == row && origin.side == side &&
        origin.part == part && origin.inset == inset) {
      return static_cast<int32_t>(quad);
    }
  }
  return -1;
}

}  // namespace snowbough::tree::test
