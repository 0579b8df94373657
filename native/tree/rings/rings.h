#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tree/obj/obj_scene.h"

namespace snowbough::tree {

/// A limb as rings, from a tube or a row of squares.
struct Limb {
  /// Ring centres, radii (mean distance of the ring's vertices from the centre) and polygon areas.
  std::vector<glm::vec3> points;
  std::vector<float> radii;
  std::vector<float> areas;
  /// Both ends look alike (both open or both closed, nearly equally thick): the caller may swap
  /// root and tip.
  bool reversible = false;
};

/// Appends centre, radius and area of one ring, whose vertices are in cyclic order, to `limb`.
void append_ring(std::span<const glm::vec3> ring, Limb& limb);

/// Reverses the limb: the tip becomes the root.
void reverse_limb(Limb& limb);

/// Why a component is not a tube.
enum class NotATube : uint8_t {
  kNone,
  /// No ring inside its outline.
  kFlat,
  /// A limb shorter than a quarter of its radius.
  kDisc,
  /// Connected only at single points, or a line without thickness.
  kLoose,
  /// Cross-sections with very different numbers of vertices.
  kUneven,
  /// The surface forks.
  kForks,
};

/// Text for the import report.
std::string reason_text(NotATube reason);

/// Finds the rings of a tube, given as one index-connected component.
///
/// Rows of k consecutive vertices, as modellers write them, are the fast path. Otherwise the rings
/// are the layers of a walk over the faces, starting at a boundary loop or, for a closed tube, at
/// an end. A tube that is split along its texture seam is closed by welding equal positions within
/// the component.
///
/// The thicker end is the root; if the other end is a single vertex, the open end is.
///
/// @param faces, vertices the component's faces and its vertices (ascending).
/// @param why receives the reason if the component is not a tube.
/// @return the limb, root first, with at least two points.
std::optional<Limb> trace_tube(const ObjScene& scene, std::span<const int32_t> faces,
                               std::span<const int32_t> vertices, NotATube& why);

}  // namespace snowbough::tree
