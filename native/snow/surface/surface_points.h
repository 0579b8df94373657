#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "snow/surface/height_samples.h"
#include "snow/surface/surface_mesh.h"

namespace snowbough::snow {

/// The points of a snow surface without snow, on the receiver in its planned pose.
struct SurfacePoints {
  SurfaceMesh mesh;
  /// The receiver's triangle that carries each point, and the weights of its second and third
  /// corner.
  std::vector<int32_t> triangle;
  std::vector<glm::vec2> weight;
  /// Offset from the flat triangle to the curved surface that the shading normals describe.
  std::vector<glm::vec3> curvature;
  /// Unit normals, along which snow grows: see find_normals.
  std::vector<glm::vec3> normal;

  size_t count() const { return mesh.position.size(); }
};

/// Places the points of a refined mesh on the receiver's triangles. Leaves the normals out.
SurfacePoints carried_points(SurfaceMesh mesh, const SurfaceSource& source);

/// Sets the normals: a weighted mean over the corners of each point, smoothed over creases.
/// @param samples those of the points: their neighbours.
/// @param depth of the snow on open ground, in metres.
void find_normals(SurfacePoints& points, const HeightSamples& samples, float depth);

}  // namespace snowbough::snow
