#pragma once

#include <cstdint>
#include <vector>

#include "tree/skeleton/skeleton.h"
#include "tree/surface/frames.h"
#include "tree/surface/limb_base.h"
#include "tree/surface/limb_hull.h"
#include "tree/surface/limb_path.h"
#include "tree/surface/surface.h"

namespace snowbough::tree {

/// A child's start from its parent: its hole, or the parent's end ring.
struct LimbStart {
  Hole hole;
  /// The child continues the parent's end ring: only vertices and centre of the hole are valid.
  bool continues = false;
  Frame frame;
  /// Corner radius of the end ring.
  double corner = 0.0;
};

/// One limb's part of the surface. Its own vertices are numbered from 0; those of its start are -1
/// to -4.
struct LimbPart {
  std::vector<glm::dvec3> vertices;
  std::vector<Quad> quads;
  std::vector<FaceOrigin> origins;
  LimbSurface limb;
  /// Hull of its rings; empty for a limb without children.
  LimbHull hull;
  std::vector<Junction> junctions;
  /// Children thicker than the limb at their exit, and children without enough room.
  std::vector<int32_t> clamped, squeezed;
  /// One per child, in the plan's order.
  std::vector<LimbStart> starts;
};

/// Input for building all limbs of a surface.
struct LimbPlan {
  const Skeleton& skeleton;
  const std::vector<LimbPath>& paths;
  LengthLimits scale;
  SurfaceOptions options;
  /// Per branch: surface_parents, and the children, ascending.
  std::vector<int32_t> parents;
  std::vector<std::vector<int32_t>> children;
  /// Per branch: its index among its parent's children.
  std::vector<int32_t> sibling;
};

/// Builds one limb.
/// @param narrowing_steps  see build_surface; those of the branch and of its children matter.
/// @param start, parent  the branch's start, and its parent's hull; null for a root.
LimbPart build_limb(const LimbPlan& plan, int32_t branch,
                    const std::vector<uint8_t>& narrowing_steps, const LimbStart& start,
                    const LimbHull* parent);

}  // namespace snowbough::tree
