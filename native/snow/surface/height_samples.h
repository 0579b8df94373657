#pragma once

#include <algorithm>
#include <cstdint>
#include <glm/vec2.hpp>
#include <vector>

#include "base/parallel_for.h"
#include "snow/surface/surface_mesh.h"

namespace snowbough::snow {

/// How the points of a surface get their heights from the map, and how heights are smoothed over
/// the surface. They depend on the triangles between the points.
struct HeightSamples {
  int32_t resolution = 0;
  /// Samples of the map; those of point p start at begin[p].
  std::vector<int32_t> begin;
  std::vector<int32_t> texel;
  std::vector<glm::vec2> share;
  std::vector<float> weight;
  /// 1 or -1: the side of the receiver's faces that carries the snow.
  std::vector<float> side;
  /// Area of the receiver's surface that a point represents, in m2.
  std::vector<float> area;
  /// Upward component of the normals of the faces at a point, the level ones above all.
  std::vector<float> up;
  /// Neighbours, weighted by distance; those of point p start at neighbour_begin[p]. Points on
  /// level faces have none on walls, so that snow at the foot of a wall stays as high as beside it.
  /// With the point's own weight, their sum is 1.
  std::vector<float> own_weight;
  std::vector<int32_t> neighbour_begin;
  std::vector<int32_t> neighbour;
  std::vector<float> neighbour_weight;

  size_t count() const { return begin.size() - 1; }
};

/// @param reach distance over which heights are smoothed, in metres.
HeightSamples height_samples(const SurfaceMesh& mesh, const SurfaceSource& source, float reach);

/// Smooths less at the points at which is_sharp is 1.
void sharpen(HeightSamples& samples, const std::vector<uint8_t>& is_sharp);

/// Thickness of the snow at each point by a map, in metres; snow on the other side counts as 0.
std::vector<float> sampled_heights(const HeightSamples& samples, const float* map);

/// Averages the values at the points with those at their neighbours.
void smooth(const HeightSamples& samples, std::vector<float>& values, int rounds);

/// Calls work(block, begin, end) for blocks of the points 0 to count - 1. One thread processes a
/// block; sums over blocks that are added in order do not depend on the number of threads.
constexpr size_t kPointBlock = 2048;
template <typename Work>
void for_point_blocks(size_t count, const Work& work) {
  base::for_each_item((count + kPointBlock - 1) / kPointBlock, 1, [&](size_t block) {
    work(block, block * kPointBlock, std::min(count, (block + 1) * kPointBlock));
  });
}

}  // namespace snowbough::snow
