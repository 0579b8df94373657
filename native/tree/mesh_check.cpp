#include "tree/mesh_check.h"

#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>
#include <algorithm>
#include <glm/geometric.hpp>
#include <numeric>
#include <stdexcept>
#include <string>

namespace snowbough::tree {
namespace {

using PolyMesh = OpenMesh::PolyMesh_ArrayKernelT<>;

/// An edge of a face: its lower and higher vertex, and which way the face runs through it.
struct DirectedEdge {
  int32_t low, high;
  bool upwards;

  bool operator<(const DirectedEdge& other) const {
    return low != other.low ? low < other.low : high < other.high;
  }
  bool same_place(const DirectedEdge& other) const {
    return low == other.low && high == other.high;
  }
};

void count_edges(const std::vector<Quad>& quads, MeshCheck& check) {
  std::vector<DirectedEdge> edges;
  edges.reserve(quads.size() * 4);
  for (const Quad& quad : quads) {
    for (int k = 0; k < 4; ++k) {
      const int32_t a = quad[k], b = quad[(k + 1) % 4];
      edges.push_back({std::min(a, b), std::max(a, b), a < b});
    }
  }
  std::sort(edges.begin(), edges.end());
  for (size_t i = 0; i < edges.size();) {
    size_t end = i + 1;
    while (end < edges.size() && edges[end].same_place(edges[i])) {
      ++end;
    }
    check.boundary_edges += end - i == 1;
    check.nonmanifold_edges += end - i > 2;
    check.flipped_edges += end - i == 2 && edges[i].upwards == edges[i + 1].upwards;
    i = end;
  }
}

/// Twice the area of each quad as a vector; the diagonals' cross product.
glm::dvec3 area_vector(const std::vector<glm::vec3>& vertices, const Quad& quad) {
  return glm::cross(glm::dvec3(vertices[quad[2]]) - glm::dvec3(vertices[quad[0]]),
                    glm::dvec3(vertices[quad[3]]) - glm::dvec3(vertices[quad[1]]));
}

double quad_volume(const std::vector<glm::vec3>& vertices, const Quad& quad,
                   const glm::dvec3& origin) {
  std::array<glm::dvec3, 4> p;
  for (int k = 0; k < 4; ++k) {
    p[k] = glm::dvec3(vertices[quad[k]]) - origin;
  }
  return (glm::dot(p[0], glm::cross(p[1], p[2])) + glm::dot(p[0], glm::cross(p[2], p[3]))) / 6.0;
}

/// Root of each vertex's piece.
std::vector<int32_t> pieces(size_t vertex_count, const std::vector<Quad>& quads) {
  std::vector<int32_t> root(vertex_count);
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](int32_t v) {
    while (root[v] != v) {
      root[v] = root[root[v]];
      v = root[v];
    }
    return v;
  };
  for (const Quad& quad : quads) {
    for (int k = 1; k < 4; ++k) {
      const int32_t a = find(quad[0]), b = find(quad[k]);
      root[std::max(a, b)] = std::min(a, b);
    }
  }
  for (int32_t v = 0; v < static_cast<int32_t>(vertex_count); ++v) {
    root[v] = find(v);
  }
  return root;
}

}  // namespace

MeshCheck check_mesh(const std::vector<glm::vec3>& vertices, const std::vector<Quad>& quads) {
  const auto vertex_count = static_cast<int32_t>(vertices.size());
  for (size_t f = 0; f < quads.size(); ++f) {
    for (int32_t v : quads[f]) {
      if (v < 0 || v >= vertex_count) {
        throw std::invalid_argument("quad " + std::to_string(f) + " uses vertex " +
                                    std::to_string(v) + " of " + std::to_string(vertex_count));
      }
    }
  }
  MeshCheck check;
  count_edges(quads, check);

  glm::dvec3 low(1e300), high(-1e300);
  PolyMesh mesh;
  mesh.reserve(vertices.size(), quads.size() * 2, quads.size());
  for (const glm::vec3& p : vertices) {
    low = glm::min(low, glm::dvec3(p));
    high = glm::max(high, glm::dvec3(p));
    mesh.add_vertex(PolyMesh::Point(p.x, p.y, p.z));
  }
  const glm::dvec3 extent = vertices.empty() ? glm::dvec3(0.0) : high - low;
  const double smallest_area = 1e-14 * glm::dot(extent, extent);

  // Pieces in the order of their lowest vertex.
  const std::vector<int32_t> root = pieces(vertices.size(), quads);
  std::vector<int32_t> piece_of(vertices.size(), -1);
  std::vector<uint8_t> used(vertices.size(), 0);
  for (const Quad& quad : quads) {
    for (int32_t v : quad) {
      used[v] = 1;
    }
  }
  for (int32_t v = 0; v < vertex_count; ++v) {
    if (!used[v]) {
      ++check.unused_vertices;
      continue;
    }
    if (piece_of[root[v]] < 0) {
      piece_of[root[v]] = check.components++;
      check.euler.push_back(0);
    }
    piece_of[v] = piece_of[root[v]];
  }

  std::vector<double> volumes(check.components, 0.0);
  std::vector<uint8_t> open(check.components, 0);
  for (const Quad& quad : quads) {
    const int32_t piece = piece_of[quad[0]];
    volumes[piece] += quad_volume(vertices, quad, low);
    const bool repeated = quad[0] == quad[1] || quad[1] == quad[2] || quad[2] == quad[3] ||
                          quad[3] == quad[0] || quad[0] == quad[2] || quad[1] == quad[3];
    if (repeated || 0.5 * glm::length(area_vector(vertices, quad)) <= smallest_area) {
      ++check.zero_area_faces;
    }
    if (repeated) {
      ++check.nonmanifold_faces;
      continue;
    }
    const std::vector<PolyMesh::VertexHandle> corners = {
        mesh.vertex_handle(quad[0]), mesh.vertex_handle(quad[1]), mesh.vertex_handle(quad[2]),
        mesh.vertex_handle(quad[3])};
    // OpenMesh refuses a face that would make an edge or a vertex non-manifold (it says so on
    // stderr).
    bool joins = true;
    for (int k = 0; k < 4; ++k) {
      const PolyMesh::HalfedgeHandle edge = mesh.find_halfedge(corners[k], corners[(k + 1) % 4]);
      joins = joins && mesh.is_boundary(corners[k]) && (!edge.is_valid() || mesh.is_boundary(edge));
    }
    if (!joins || !mesh.add_face(corners).is_valid()) {
      ++check.nonmanifold_faces;
    }
  }

  for (int32_t v = 0; v < vertex_count; ++v) {
    if (used[v]) {
      ++check.euler[piece_of[v]];
    }
  }
  for (auto edge = mesh.edges_begin(); edge != mesh.edges_end(); ++edge) {
    const PolyMesh::HalfedgeHandle half = mesh.halfedge_handle(*edge, 0);
    const int32_t piece = piece_of[mesh.to_vertex_handle(half).idx()];
    --check.euler[piece];
    open[piece] |= mesh.is_boundary(*edge) ? 1 : 0;
  }
  for (auto face = mesh.faces_begin(); face != mesh.faces_end(); ++face) {
    ++check.euler[piece_of[mesh.fv_begin(*face)->idx()]];
  }
  check.winding_ok = check.flipped_edges == 0;
  for (int32_t piece = 0; piece < check.components; ++piece) {
    check.volume += volumes[piece];
    check.winding_ok = check.winding_ok && (open[piece] || volumes[piece] > 0.0);
  }
  return check;
}

}  // namespace snowbough::tree
