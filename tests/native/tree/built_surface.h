#pragma once

#include <cstdint>
#include <vector>

#include "native/tree/skeletons.h"
#include "tree/mesh/mesh_check.h"
#include "tree/skeleton/width.h"
#include "tree/surface/builder.h"
#include "tree/surface/limb_path.h"

namespace snowbough::tree {

/// A skeleton's surface before relief, and its inputs.
struct Built {
  LengthLimits scale;
  std::vector<LimbPath> paths;
  Surface surface;
};

inline Built build(const Skeleton& skeleton) {
  Built built;
  built.scale = length_limits(skeleton);
  built.paths = limb_paths(skeleton, limb_widths(skeleton, {}), built.scale);
  built.surface = build_surface(skeleton, built.paths, built.scale, {},
                                std::vector<uint8_t>(built.paths.size(), 0));
  return built;
}

inline MeshCheck check(const Surface& surface) {
  return check_mesh({surface.vertices.begin(), surface.vertices.end()}, surface.quads);
}

/// A branch of two segments off the trunk's middle line.
inline Branch side_branch(float height, float radius, glm::vec3 direction = {1.0f, 0.0f, 0.0f}) {
  const glm::vec3 root(0.0f, 0.0f, height);
  return make_branch(0, 1, {root, root + direction, root + 2.0f * direction},
                     {radius, radius, radius});
}

/// A trunk with `count` branches all round one place.
inline Skeleton whorl(int count) {
  std::vector<Branch> branches = {trunk()};
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * M_PI * i / count;
    branches.push_back(side_branch(5.5f, 0.05f, {std::cos(angle), std::sin(angle), 0.0}));
  }
  return make_skeleton(branches);
}

}  // namespace snowbough::tree
