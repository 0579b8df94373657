#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "snow/surface/surface_points.h"

namespace snowbough::snow {

/// The points in hollows in which snow that grows along the normals would pass through that of the
/// other side. There the level parts of the offsets and the heights of the columns of snow change
/// evenly (harmonically) between those of the points around. Points that rise straight up, as
/// in a bowl, do not become lower.
struct Folds {
  /// Ascending.
  std::vector<int32_t> point;
  /// The points beside point[i], from beside_begin[i] on.
  std::vector<int32_t> beside_begin{0}, beside;
};

/// Adds the points of triangles that a frame draws upside down, and those around them. Fronts hang
/// over: theirs count only beside points that have been added. Returns whether it added any.
/// @param drawn the points of the surface in the frame.
/// @param shown as in heights_now.
/// @param out by point, the level direction in which a front hangs over; 0 where there is none.
bool add_folds(Folds& folds, const SurfacePoints& points, const std::vector<glm::vec3>& drawn,
               const std::vector<float>& shown, const std::vector<glm::vec3>& out);

/// Sets the offsets in folds.
/// @param normal of the points.
void even_out(const Folds& folds, const std::vector<glm::vec3>& normal,
              std::vector<glm::vec3>& offsets);

}  // namespace snowbough::snow
