#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tree/obj/obj_scene.h"

namespace snowbough::tree {

/// A limb as rings: what a tube or a row of squares comes down to.
struct Limb {
  /// Ring centres, radii (mean distance of the ring's vertices from the centre) and polygon areas.
  std::vector<glm::vec3> points;
  std::vector<float> radii;
  std::vector<float> areas;
  /// Both ends look alike (both open or both closed, nearly equally thick): root and tip may be
  /// swapped by whoever knows the surroundings.
  bool reversible = false;
};

/// Centre, radius and area of one ring whose vertices stand in cyclic order, appended to `limb`.
void append_ring(std::span<const glm::vec3> ring, Limb& limb);

/// Turns the limb round: tip becomes root.
void reverse_limb(Limb& limb);

/// Length of the centreline.
float limb_length(const Limb& limb);

/// Why a component is no tube.
enum class NotATube : uint8_t {
  kNone,
  /// No ring inside its outline.
  kFlat,
  /// A limb shorter than a quarter of its radius.
  kDisc,
  /// Hangs together only at single points, or is a line without thickness.
  kLoose,
  /// Cross-sections of very different numbers of vertices.
  kUneven,
  /// The surface forks.
  kForks,
};

/// In words, for the import report.
std::string reason_text(NotATube reason);

/// Finds the rings of a tube, given as one index-connected component.
///
/// Rows of k consecutive vertices, as modellers write them, are the fast path. Otherwise the rings
/// are the layers that a walk over the faces meets, starting at a boundary loop, or at an end where
/// the tube is closed. A tube that was split along its texture seam is closed again by welding
/// equal positions inside the component, never beyond it.
///
/// The thicker end is the root; the open one where the other ends in a single vertex.
///
/// @param faces, vertices the component's faces and its vertices (ascending).
/// @param why receives the reason when the component is no tube.
/// @return the limb, root first, at least two points.
std::optional<Limb> trace_tube(const ObjScene& scene, std::span<const int32_t> faces,
                               std::span<const int32_t> vertices, NotATube& why);

}  // namespace snowbough::tree
