#pragma once

#include <cstdint>
#include <vector>

#include "render/data/sources.h"
#include "shaders/lib/leaf_vertex.h"

namespace snowbough::render {

/// Triangles of leaves of one material, three vertices each, in the order of their drop points (see
/// leaf_drop_point): from each distance, those that may be drawn come first.
struct LeafTriangles {
  std::vector<shared::LeafVertex> vertices;
  std::vector<float> drop_points;
};

/// The triangles of each material. @throws std::invalid_argument with the reason: arrays of
/// different lengths, or indices out of range.
std::vector<LeafTriangles> leaf_triangles(const LeafSource& source, int32_t bone_count);

}  // namespace snowbough::render
