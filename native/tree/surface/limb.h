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

/// What a parent prepared for a child: its hole, or its own end ring.
struct LimbStart {
  Hole hole;
  /// The child goes on from the parent's end ring: of the hole only vertices and centre count.
  bool continues = false;
  Frame frame;
  /// Corner radius of the end ring.
  double corner = 0.0;

  /// Whether a child grows the same way out of both; by which vertices does not matter.
  bool grows_like(const LimbStart& other) const;
};

/// One limb's share of the surface. It numbers its own vertices from 0; those that it starts from
/// are -1 to -4.
struct LimbPart {
  std::vector<glm::dvec3> vertices;
  std::vector<Quad> quads;
  std::vector<FaceOrigin> origins;
  LimbSurface limb;
  /// Of its rings; none for a limb without children.
  LimbHull hull;
  std::vector<Junction> junctions;
  /// Children that were thicker than the limb where they leave it, and those that lacked room.
  std::vector<int32_t> clamped, squeezed;
  /// One a child, in the plan's order.
  std::vector<LimbStart> starts;
};

/// What all limbs of a surface are built from.
struct LimbPlan {
  const Skeleton& skeleton;
  const std::vector<LimbPath>& paths;
  SurfaceScale scale;
  SurfaceOptions options;
  /// Per branch: its children, ascending.
  std::vector<std::vector<int32_t>> children;
  /// Per branch: which of its parent's children it is.
  std::vector<int32_t> sibling;
};

/// Builds one limb.
/// @param relief  see build_surface; that of the branch and of its children counts.
/// @param start, parent  what the parent prepared for the branch, and its hull; null for a root.
LimbPart build_limb(const LimbPlan& plan, int32_t branch,
                    const std::vector<uint8_t>& narrowing_steps, const LimbStart& start,
                    const LimbHull* parent);

}  // namespace snowbough::tree
