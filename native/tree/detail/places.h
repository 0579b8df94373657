#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "tree/detail/fork_field.h"
#include "tree/detail/limb_tubes.h"
#include "tree/skeleton/tree_mesh.h"

namespace snowbough::tree {

/// A vertex of the detailed mesh: a place on a base face, (0, 0) at its corner 0, (1, 0) at corner
/// 1, (1, 1) at corner 2.
struct FinePlace {
  int32_t face = -1;
  double u = 0.0, v = 0.0;
};

/// Where places on the base lie on the limbs' round sections. A limb that grows out of its
/// parent's side begins at the rim on the parent and becomes round within the fork's reach; caps
/// are flat.
std::vector<glm::dvec3> limb_positions(const Surface& surface, const LimbTubes& tubes,
                                       const std::vector<Fork>& forks,
                                       const std::vector<FinePlace>& places);

}  // namespace snowbough::tree
