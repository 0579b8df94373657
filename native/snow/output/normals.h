#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "snow/seams/seam_table.h"
#include "snow/seams/surface_metric.h"
#include "snow/texels/texel_table.h"

namespace snowbough::snow {

/// The snow surface's normals in the tangent space that Blender and most renderers share
/// (MikkTSpace, OpenGL convention: x along the surface's tangent dP/du, y along cross(n, t) * sign,
/// z outwards).
///
/// Central differences of the height, `(h[+1] - h[-1]) / 2` per texel along u and v, across seams;
/// one-sided at the end of the surface. The layout's first fundamental form converts them to slopes
/// along tangent and bitangent, so that sheared and stretched layouts shade correctly.
/// M. S. Mikkelsen, Simulation of Wrinkled Surfaces Revisited, 2008.
///
/// `height`: one value per owned texel, metres. `metrics`: surface_metrics of the current
/// positions.
std::vector<glm::vec3> normals_on_cpu(const TexelTable& table, const SeamTable& seams,
                                      const std::vector<SurfaceMetric>& metrics,
                                      const std::vector<float>& height);

/// The same for a map of resolution^2 heights, extended beyond the charts: resolution^2 normals.
std::vector<glm::vec3> normal_map(const TexelTable& table, const SeamTable& seams,
                                  const std::vector<SurfaceMetric>& metrics,
                                  const std::vector<float>& map);

}  // namespace snowbough::snow
