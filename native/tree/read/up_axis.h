#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "tree/skeleton/skeleton.h"

namespace snowbough::tree {

/// Whether the tree grows along Y rather than Z, by the roots' directions from base to tip,
/// weighted by thickness. A tree that leans equally both ways counts as Y up, Xfrog's axis.
bool grows_along_y(const std::vector<Branch>& branches);

/// Converts Y up to Z up, a rotation by 90 degrees about X: (x, y, z) -> (x, -z, y).
inline glm::vec3 y_up_to_z_up(const glm::vec3& p) {
  return {p.x, -p.z, p.y};
}

/// The same for whole branches.
void turn_y_up_to_z_up(std::vector<Branch>& branches);

}  // namespace snowbough::tree
