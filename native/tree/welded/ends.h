#pragma once

#include <cstdint>
#include <vector>

#include "base/progress.h"
#include "tree/rings/local_mesh.h"
#include "tree/welded/geodesic.h"

namespace snowbough::tree {

/// The vertices of the widest open end; the surface must have one.
std::vector<int32_t> widest_loop(const LocalMesh& mesh, const Topology& topology);

/// The vertices at the thickest end of a surface without open ends, including the closing cap.
/// @throws Cancelled when progress says stop.
std::vector<int32_t> thickest_end(const LocalMesh& mesh,
                                  const std::vector<LocalTriangle>& triangles,
                                  const base::Progress& progress);

/// Where the tree begins if several thick roots end at the ground: the vertices around its trunk
/// just above them, so that the roots are limbs of the trunk. The trunk is the arc with most wood;
/// its roots reach less far than its crown. Else `root`.
/// @param root  a first guess, at any end.
/// @throws Cancelled when progress says stop.
std::vector<int32_t> above_roots(const LocalMesh& mesh, const std::vector<LocalTriangle>& triangles,
                                 const std::vector<int32_t>& root, const base::Progress& progress);

}  // namespace snowbough::tree
