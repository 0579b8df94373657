#include "tree/rings/local_mesh.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "base/group_by_key.h"

namespace snowbough::tree {

LocalMesh extract_component(const ObjScene& scene, std::span<const int32_t> faces,
                            std::span<const int32_t> vertices) {
  LocalMesh mesh;
  mesh.positions.reserve(vertices.size());
  for (const int32_t v : vertices) mesh.positions.push_back(scene.positions[v]);
  const bool contiguous =
      vertices.back() - vertices.front() + 1 == static_cast<int32_t>(vertices.size());
  for (const int32_t f : faces) {
    for (int32_t c = scene.face_begin[f]; c < scene.face_begin[f + 1]; ++c) {
      const int32_t v = scene.corner_vertex[c];
      mesh.corners.push_back(
          contiguous ? v - vertices.front()
                     : static_cast<int32_t>(std::lower_bound(vertices.begin(), vertices.end(), v) -
                                            vertices.begin()));
    }
    mesh.face_begin.push_back(static_cast<int32_t>(mesh.corners.size()));
  }
  return mesh;
}

LocalMesh weld_equal_positions(const LocalMesh& mesh, std::vector<int32_t>* numbers_of) {
  LocalMesh welded;
  std::map<std::array<float, 3>, int32_t> numbers;
  std::vector<int32_t> renumbered;
  for (const glm::vec3& p : mesh.positions) {
    const auto [found, added] =
        numbers.try_emplace({p.x, p.y, p.z}, static_cast<int32_t>(welded.positions.size()));
    if (added) welded.positions.push_back(p);
    renumbered.push_back(found->second);
  }
  for (int32_t f = 0; f < mesh.face_count(); ++f) {
    const size_t first = welded.corners.size();
    for (const int32_t v : mesh.face(f)) {
      const int32_t w = renumbered[v];
      if (welded.corners.size() == first || welded.corners.back() != w) welded.corners.push_back(w);
    }
    while (welded.corners.size() > first + 1 && welded.corners.back() == welded.corners[first]) {
      welded.corners.pop_back();
    }
    if (welded.corners.size() < first + 3) {
      welded.corners.resize(first);
    } else {
      welded.face_begin.push_back(static_cast<int32_t>(welded.corners.size()));
    }
  }
  if (numbers_of != nullptr) *numbers_of = std::move(renumbered);
  return welded;
}

std::vector<std::pair<int32_t, int32_t>> polygon_edges(const LocalMesh& mesh) {
  std::vector<std::pair<int32_t, int32_t>> edges;
  for (int32_t f = 0; f < mesh.face_count(); ++f) {
    const std::span<const int32_t> face = mesh.face(f);
    for (size_t c = 0; c < face.size(); ++c) {
      edges.emplace_back(std::minmax(face[c], face[(c + 1) % face.size()]));
    }
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

Topology build_topology(const LocalMesh& mesh) {
  Topology topology;
  const size_t count = mesh.positions.size();
  const auto for_corners = [&](const auto& visit) {
    for (int32_t f = 0; f < mesh.face_count(); ++f) {
      for (const int32_t v : mesh.face(f)) visit(v, f);
    }
  };
  base::group_by_key(count, for_corners, topology.vertex_face_begin, topology.vertex_faces);
  const std::vector<std::pair<int32_t, int32_t>> edges = polygon_edges(mesh);
  std::vector<std::vector<int32_t>> neighbours(count);
  for (size_t i = 0; i < edges.size();) {
    size_t j = i;
    while (j < edges.size() && edges[j] == edges[i]) ++j;
    if (j == i + 1 && edges[i].first != edges[i].second) {
      neighbours[edges[i].first].push_back(edges[i].second);
      neighbours[edges[i].second].push_back(edges[i].first);
    }
    i = j;
  }
  std::vector<char> seen(count, 0);
  for (size_t v = 0; v < count; ++v) {
    if (seen[v] || neighbours[v].empty()) continue;
    std::vector<int32_t> loop{static_cast<int32_t>(v)};
    seen[v] = 1;
    for (size_t i = 0; i < loop.size(); ++i) {
      for (const int32_t w : neighbours[loop[i]]) {
        if (!seen[w]) {
          seen[w] = 1;
          loop.push_back(w);
        }
      }
    }
    std::sort(loop.begin(), loop.end());
    topology.boundary_loops.push_back(std::move(loop));
  }
  return topology;
}

Layers walk_layers(const LocalMesh& mesh, const Topology& topology, std::vector<int32_t> start,
                   size_t most_uneven) {
  std::vector<char> seen(mesh.positions.size(), 0);
  // A visited face adds nothing new for its other vertices.
  std::vector<char> seen_face(static_cast<size_t>(mesh.face_count()), 0);
  for (const int32_t v : start) seen[v] = 1;
  Layers layers;
  size_t fewest = mesh.positions.size();
  size_t most = 0;
  while (!start.empty()) {
    std::vector<int32_t> next;
    for (const int32_t v : start) {
      for (int32_t i = topology.vertex_face_begin[v]; i < topology.vertex_face_begin[v + 1]; ++i) {
        const int32_t f = topology.vertex_faces[i];
        if (seen_face[f]) continue;
        seen_face[f] = 1;
        for (const int32_t w : mesh.face(f)) {
          if (!seen[w]) {
            seen[w] = 1;
            next.push_back(w);
          }
        }
      }
    }
    std::sort(next.begin(), next.end());
    if (!next.empty() && (!layers.empty() || start.size() > 1)) {
      fewest = std::min(fewest, start.size());
      most = std::max(most, start.size());
      if (most_uneven > 0 && most > most_uneven * fewest) return {};
    }
    layers.push_back(std::move(start));
    start = std::move(next);
  }
  return layers;
}

}  // namespace snowbough::tree
