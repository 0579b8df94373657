#pragma once

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <vector>

#include "base/triangle_tree.h"
#include "snow/surface/rims.h"
#include "snow/surface/surface_mesh.h"

// Small receivers for the tests of the snow surface.
namespace snowbough::snow {

constexpr int32_t kResolution = 64;
/// Texels between a chart and the border of its cell of the map.
constexpr float kGutter = 2.0f;

/// Rows and columns of cells in a map with a chart a face.
inline int32_t cells_across(size_t faces) {
  return static_cast<int32_t>(std::ceil(std::sqrt(static_cast<double>(faces))));
}

/// Faces of four corners, each of which fills a cell of the map.
inline SurfaceSource quads(std::vector<glm::vec3> positions,
                           const std::vector<std::array<int32_t, 4>>& faces) {
  SurfaceSource source;
  source.positions = std::move(positions);
  source.topology.vertex_count = static_cast<int32_t>(source.positions.size());
  source.topology.resolution = kResolution;
  const int32_t across = cells_across(faces.size());
  const float cell = 1.0f / static_cast<float>(across);
  const float gutter = kGutter / static_cast<float>(kResolution);
  for (size_t f = 0; f < faces.size(); ++f) {
    const auto number = static_cast<int32_t>(f);
    const glm::vec2 low = glm::vec2(number % across, number / across) * cell + gutter;
    const float size = cell - 2.0f * gutter;
    const std::array<glm::vec2, 4> uv{low, low + glm::vec2(size, 0), low + size,
                                      low + glm::vec2(0, size)};
    for (const size_t k : {0, 1, 2, 0, 2, 3}) {
      source.topology.triangles.push_back(faces[f][k]);
      source.topology.corner_uv.push_back(uv[k]);
    }
  }
  return source;
}

/// A map in which face f of quads() has height[f]; faces beyond the list are bare.
inline std::vector<float> map_of(const SurfaceSource& source, const std::vector<float>& height) {
  const int32_t across = cells_across(source.topology.triangles.size() / 6);
  std::vector<float> map(static_cast<size_t>(kResolution) * kResolution, 0.0f);
  for (int32_t y = 0; y < kResolution; ++y) {
    for (int32_t x = 0; x < kResolution; ++x) {
      const auto face =
          static_cast<size_t>(y * across / kResolution * across + x * across / kResolution);
      if (face < height.size()) map[static_cast<size_t>(y * kResolution + x)] = height[face];
    }
  }
  return map;
}

/// A level card around the origin.
inline SurfaceSource card(float size_x, float size_y) {
  const float x = 0.5f * size_x, y = 0.5f * size_y;
  return quads({{-x, -y, 0}, {x, -y, 0}, {x, y, 0}, {-x, y, 0}}, {{0, 1, 2, 3}});
}

struct Box {
  glm::vec3 low, high;
};

/// Boxes of six faces each, the top first.
inline SurfaceSource boxes(const std::vector<Box>& all) {
  std::vector<glm::vec3> positions;
  std::vector<std::array<int32_t, 4>> faces;
  for (const auto& [low, high] : all) {
    const auto first = static_cast<int32_t>(positions.size());
    for (int k = 0; k < 8; ++k) {
      positions.emplace_back((k & 1) != 0 ? high.x : low.x, (k & 2) != 0 ? high.y : low.y,
                             (k & 4) != 0 ? high.z : low.z);
    }
    for (const std::array<int32_t, 4> face : {std::array{4, 5, 7, 6},
                                              {0, 2, 3, 1},
                                              {0, 1, 5, 4},
                                              {2, 6, 7, 3},
                                              {0, 4, 6, 2},
                                              {1, 3, 7, 5}}) {
      faces.push_back({first + face[0], first + face[1], first + face[2], first + face[3]});
    }
  }
  return quads(std::move(positions), faces);
}

/// Its top is at z = 0.
inline SurfaceSource slab(float size, float thickness) {
  return boxes({{{-0.5f * size, -0.5f * size, -thickness}, {0.5f * size, 0.5f * size, 0.0f}}});
}

/// A map with snow on the tops of boxes() alone.
inline std::vector<float> on_tops(const SurfaceSource& source, float height) {
  std::vector<float> heights(source.topology.triangles.size() / 6, 0.0f);
  for (size_t f = 0; f < heights.size(); f += 6) heights[f] = height;
  return map_of(source, heights);
}

/// A closed ball of flat faces.
inline SurfaceSource ball(float radius, int32_t around, int32_t rings) {
  std::vector<glm::vec3> positions;
  std::vector<std::array<int32_t, 4>> faces;
  constexpr float kPi = std::numbers::pi_v<float>;
  for (int32_t ring = 0; ring <= rings; ++ring) {
    const float rise = kPi * (static_cast<float>(ring) / static_cast<float>(rings) - 0.5f);
    for (int32_t i = 0; i < around; ++i) {
      const float turn = 2.0f * kPi * static_cast<float>(i) / static_cast<float>(around);
      positions.push_back(radius * glm::vec3(std::cos(rise) * std::cos(turn),
                                             std::cos(rise) * std::sin(turn), std::sin(rise)));
      const int32_t next = (i + 1) % around;
      if (ring < rings) {
        const int32_t row = ring * around;
        faces.push_back({row + i, row + next, row + around + next, row + around + i});
      }
    }
  }
  return quads(std::move(positions), faces);
}

/// A receiver's mesh with its rims.
struct RimmedMesh {
  explicit RimmedMesh(const SurfaceSource& source, float reach = 0.3f, float far_reach = 0.05f,
                      float strip = 0.04f)
      : shading(source.shading),
        mesh(receiver_mesh(source)),
        tree(mesh.position, mesh.triangle, {0, static_cast<int32_t>(mesh.triangle.size())}),
        rims(mesh, tree, shading, reach, far_reach, strip) {}

  std::vector<int32_t> shading;
  SurfaceMesh mesh;
  base::TriangleTree tree;
  Rims rims;
};

inline float area_of(const SurfaceMesh& mesh) {
  double area = 0.0;
  for (size_t t = 0; t < mesh.triangle.size(); ++t)
    area += 0.5 * glm::length(triangle_cross(mesh, t));
  return static_cast<float>(area);
}

/// How many triangles meet at each edge of surface_edges.
inline std::vector<int32_t> faces_at_edges(const SurfaceEdges& edges) {
  std::vector<int32_t> count(edges.ends.size(), 0);
  for (const auto& triangle : edges.of_triangle) {
    for (const int32_t e : triangle) ++count[static_cast<size_t>(e)];
  }
  return count;
}

}  // namespace snowbough::snow
