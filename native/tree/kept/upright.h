#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "tree/skeleton/skeleton.h"

namespace snowbough::tree {

/// A limb through the middle of some points, from their lowest to their highest: the skeleton of a
/// surface without limbs.
/// @param used  per point: whether it counts; at least one does.
/// @param up  axis that points up: 1 = Y, 2 = Z.
Branch upright_limb(const std::vector<glm::vec3>& points, const std::vector<char>& used, int up);

}  // namespace snowbough::tree
