#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "tree/skeleton/tree_mesh.h"
#include "tree/surface/surface.h"

namespace snowbough::tree {

/// The sections of all limbs, branch by branch: one per row of a branch's strip.
std::vector<LimbSection> limb_sections(const Surface& surface);

/// Projects a point onto a section's radius: the nearest point on its infinite line plus the radius
/// along the offset. Points on the line itself stay.
///
/// Source: D. T. Reynolds, PhD thesis, University of East Anglia, 2014, eq. 3.4.2.
glm::dvec3 on_limb(const LimbSection& section, const glm::dvec3& p);

}  // namespace snowbough::tree
