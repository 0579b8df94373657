#pragma once

#include <algorithm>
#include <cmath>
#include <fstream>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <map>
#include <numeric>
#include <sstream>
#include <string>
#include <vector>

#include "snow/texels/texel_table.h"

// Meshes with snow layouts for the tests of seams, smoothing and normals.
namespace snowbough::snow {

struct LaidOutMesh {
  MapTopology topology;
  std::vector<glm::vec3> positions;
};

/// Positions and triangles of an OBJ file (faces as fans); empty when it is not there.
inline LaidOutMesh read_obj_mesh(const std::string& path) {
  LaidOutMesh mesh;
  std::ifstream file(path);
  std::string line;
  while (std::getline(file, line)) {
    std::istringstream words(line);
    std::string key;
    words >> key;
    if (key == "v") {
      glm::vec3 p;
      words >> p.x >> p.y >> p.z;
      mesh.positions.push_back(p);
    } else if (key == "f") {
      std::vector<int32_t> corners;
      for (std::string word; words >> word;) corners.push_back(std::stoi(word) - 1);
      for (size_t k = 2; k < corners.size(); ++k) {
        mesh.topology.triangles.insert(mesh.topology.triangles.end(),
                                       {corners[0], corners[k - 1], corners[k]});
      }
    }
  }
  mesh.topology.vertex_count = static_cast<int32_t>(mesh.positions.size());
  return mesh;
}

/// A layout as automatic unwrapping makes it: connected triangles that face the same of six
/// directions are projected along it into one chart, turned by a different angle each, and packed
/// in shelves with `gutter` texels between them.
inline void lay_out_by_direction(LaidOutMesh& mesh, int32_t resolution, float gutter) {
  MapTopology& topology = mesh.topology;
  topology.resolution = resolution;
  const auto triangle_count = static_cast<int32_t>(topology.triangles.size() / 3);
  std::vector<int32_t> direction(static_cast<size_t>(triangle_count));
  std::map<std::pair<int32_t, int32_t>, std::vector<int32_t>> edges;
  for (int32_t t = 0; t < triangle_count; ++t) {
    const int32_t* c = topology.triangles.data() + 3 * t;
    const glm::vec3 n = glm::cross(mesh.positions[c[1]] - mesh.positions[c[0]],
                                   mesh.positions[c[2]] - mesh.positions[c[0]]);
    int32_t axis = 0;
    for (int32_t k = 1; k < 3; ++k) {
      if (std::abs(n[k]) > std::abs(n[axis])) axis = k;
    }
    direction[t] = 2 * axis + (n[axis] < 0.0f ? 1 : 0);
    for (int k = 0; k < 3; ++k) edges[std::minmax(c[k], c[(k + 1) % 3])].push_back(t);
  }
  std::vector<int32_t> root(static_cast<size_t>(triangle_count));
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](int32_t t) {
    while (root[t] != t) t = root[t] = root[root[t]];
    return t;
  };
  for (const auto& [edge, sides] : edges) {
    for (size_t i = 1; i < sides.size(); ++i) {
      if (direction[sides[0]] == direction[sides[i]]) {
        const int32_t a = find(sides[0]), b = find(sides[i]);
        root[std::max(a, b)] = std::min(a, b);
      }
    }
  }
  std::map<int32_t, std::vector<int32_t>> charts;
  for (int32_t t = 0; t < triangle_count; ++t) charts[find(t)].push_back(t);

  struct Box {
    int32_t chart;
    glm::vec2 low, size;
  };
  std::vector<Box> boxes;
  std::vector<glm::vec2> flat(topology.triangles.size());
  float area = 0.0f;
  for (const auto& [chart, members] : charts) {
    const int32_t axis = direction[chart] / 2;
    const float angle = 0.4f * static_cast<float>(chart % 17);
    Box box{chart, glm::vec2(1e30f), glm::vec2(-1e30f)};
    for (const int32_t t : members) {
      for (int k = 0; k < 3; ++k) {
        const glm::vec3 p = mesh.positions[topology.triangles[3 * t + k]];
        const glm::vec2 q(p[(axis + 1) % 3], p[(axis + 2) % 3]);
        const glm::vec2 turned(std::cos(angle) * q.x - std::sin(angle) * q.y,
                               std::sin(angle) * q.x + std::cos(angle) * q.y);
        flat[3 * t + k] = turned;
        box.low = glm::min(box.low, turned);
        box.size = glm::max(box.size, turned);
      }
    }
    box.size -= box.low;
    area += box.size.x * box.size.y;
    boxes.push_back(box);
  }
  std::stable_sort(boxes.begin(), boxes.end(),
                   [](const Box& a, const Box& b) { return a.size.y > b.size.y; });
  // Smaller until the shelves fit.
  std::map<int32_t, glm::vec2> offset;
  float scale = 1.0f / std::sqrt(area);
  for (bool fits = false; !fits; scale *= 0.97f) {
    fits = true;
    const float gap = gutter / static_cast<float>(resolution);
    glm::vec2 pen(gap);
    float shelf = 0.0f;
    for (const Box& box : boxes) {
      const glm::vec2 size = box.size * scale;
      if (pen.x + size.x + gap > 1.0f) {
        pen = {gap, pen.y + shelf + gap};
        shelf = 0.0f;
      }
      if (pen.x + size.x + gap > 1.0f || pen.y + size.y + gap > 1.0f) {
        fits = false;
        break;
      }
      offset[box.chart] = pen - box.low * scale;
      shelf = std::max(shelf, size.y);
      pen.x += size.x + gap;
    }
    if (fits) {
      topology.corner_uv.resize(flat.size());
      for (size_t i = 0; i < flat.size(); ++i) {
        topology.corner_uv[i] = flat[i] * scale + offset[find(static_cast<int32_t>(i / 3))];
      }
    }
  }
}

/// A layout in which every triangle is a chart of its own: two in each square of a grid, with gaps.
inline void lay_out_apart(LaidOutMesh& mesh, int32_t resolution) {
  MapTopology& topology = mesh.topology;
  topology.resolution = resolution;
  const size_t count = topology.triangles.size() / 3;
  const auto side = static_cast<size_t>(std::ceil(std::sqrt(0.5 * static_cast<double>(count))));
  const glm::vec2 corner[2][3] = {{{0.06f, 0.06f}, {0.82f, 0.06f}, {0.06f, 0.82f}},
                                  {{0.94f, 0.94f}, {0.18f, 0.94f}, {0.94f, 0.18f}}};
  for (size_t t = 0; t < count; ++t) {
    const glm::vec2 square(t / 2 % side, t / 2 / side);
    for (size_t k = 0; k < 3; ++k) {
      topology.corner_uv[3 * t + k] = (square + corner[t % 2][k]) / static_cast<float>(side);
    }
  }
}

/// An open cylinder around Z, `around` x `along` quads, its wall one chart with a seam at angle 0.
inline LaidOutMesh cylinder(int32_t around, int32_t along, float radius, float height,
                            int32_t resolution) {
  LaidOutMesh mesh;
  mesh.topology.resolution = resolution;
  for (int32_t j = 0; j <= along; ++j) {
    for (int32_t i = 0; i < around; ++i) {
      const float angle = 6.2831853f * static_cast<float>(i) / static_cast<float>(around);
      mesh.positions.emplace_back(radius * std::cos(angle), radius * std::sin(angle),
                                  height * static_cast<float>(j) / static_cast<float>(along));
    }
  }
  mesh.topology.vertex_count = static_cast<int32_t>(mesh.positions.size());
  const auto uv = [&](int32_t i, int32_t j) {
    return glm::vec2(0.1f + 0.8f * static_cast<float>(i) / static_cast<float>(around),
                     0.1f + 0.8f * static_cast<float>(j) / static_cast<float>(along));
  };
  for (int32_t j = 0; j < along; ++j) {
    for (int32_t i = 0; i < around; ++i) {
      const int32_t a = j * around + i, b = j * around + (i + 1) % around;
      mesh.topology.triangles.insert(mesh.topology.triangles.end(),
                                     {a, b, b + around, a, b + around, a + around});
      mesh.topology.corner_uv.insert(
          mesh.topology.corner_uv.end(),
          {uv(i, j), uv(i + 1, j), uv(i + 1, j + 1), uv(i, j), uv(i + 1, j + 1), uv(i, j + 1)});
    }
  }
  return mesh;
}

}  // namespace snowbough::snow
