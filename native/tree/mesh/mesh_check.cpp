#include "tree/mesh/mesh_check.h"

#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>
#include <algorithm>
#include <glm/geometric.hpp>
#include <stdexcept>
#include <string>
#include <utility>

#include "base/group_by_key.h"
#include "base/union_find.h"

namespace snowbough::tree {
namespace {

using PolyMesh = OpenMesh::PolyMesh_ArrayKernelT<>;

/// The edges of the quads, from both sides. Half-edge 4 f + k runs along edge k of quad f.
struct HalfEdges {
  /// The half-edge on the other side; -1 if there is none, or several.
  std::vector<int32_t> mate;
  /// One half-edge of each edge.
  std::vector<int32_t> edges;

  HalfEdges(const std::vector<Quad>& quads, size_t vertex_count, MeshCheck& check)
      : mate(quads.size() * 4, -1) {
    // Sorted by the lower vertex in one pass, then by the higher one among the few that share it.
    struct Entry {
      int32_t high, half;
    };
    const auto for_half_edges = [&](const auto& visit) {
      for (size_t f = 0; f < quads.size(); ++f) {
        for (int k = 0; k < 4; ++k) {
          const int32_t a = quads[f][k], b = quads[f][(k + 1) % 4];
          visit(std::min(a, b), Entry{std::max(a, b), static_cast<int32_t>(4 * f + k)});
        }
      }
    };
    const auto start_of = [&](const Entry& entry) { return quads[entry.half / 4][entry.half % 4]; };
    std::vector<int32_t> begin;
    std::vector<Entry> entries;
    base::group_by_key(vertex_count, for_half_edges, begin, entries);
    edges.reserve(quads.size() * 2);
    for (size_t v = 0; v < vertex_count; ++v) {
      std::sort(entries.begin() + begin[v], entries.begin() + begin[v + 1],
                [](const Entry& a, const Entry& b) {
                  return a.high != b.high ? a.high < b.high : a.half < b.half;
                });
      for (int32_t i = begin[v]; i < begin[v + 1];) {
        int32_t end = i + 1;
        while (end < begin[v + 1] && entries[end].high == entries[i].high) {
          ++end;
        }
        edges.push_back(entries[i].half);
        check.boundary_edges += end - i == 1;
        check.nonmanifold_edges += end - i > 2;
        if (end - i == 2) {
          check.flipped_edges += start_of(entries[i]) == start_of(entries[i + 1]);
          mate[entries[i].half] = entries[i + 1].half;
          mate[entries[i + 1].half] = entries[i].half;
        }
        i = end;
      }
    }
  }

  /// Whether the faces around every vertex form a single fan, closed or up to the border on both
  /// sides. Only if every edge has one face, or two in opposite directions.
  bool single_fans(const std::vector<Quad>& quads, size_t vertex_count) const {
    std::vector<int32_t> faces(vertex_count, 0), first(vertex_count, -1);
    for (size_t f = 0; f < quads.size(); ++f) {
      for (int k = 0; k < 4; ++k) {
        ++faces[quads[f][k]];
        first[quads[f][k]] = static_cast<int32_t>(4 * f + k);
      }
    }
    // The half-edge before one that leaves a vertex, in the same face, arrives at it.
    const auto before = [](int32_t half) { return (half & ~3) | ((half + 3) & 3); };
    const auto after = [](int32_t half) { return (half & ~3) | ((half + 1) & 3); };
    for (size_t v = 0; v < vertex_count; ++v) {
      if (first[v] < 0) {
        continue;
      }
      int32_t met = 1;
      int32_t half = mate[before(first[v])];
      for (; half >= 0 && half != first[v]; half = mate[before(half)]) {
        ++met;
      }
      if (half < 0) {
        for (half = mate[first[v]]; half >= 0; half = mate[after(half)]) {
          ++met;
        }
      }
      if (met != faces[v]) {
        return false;
      }
    }
    return true;
  }
};

/// Twice the area of each quad as a vector: the cross product of its diagonals.
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

/// The smallest vertex of each vertex's component.
std::vector<int32_t> pieces(size_t vertex_count, const std::vector<Quad>& quads) {
  base::UnionFind sets(vertex_count);
  for (const Quad& quad : quads) {
    int32_t first = quad[0];
    for (int k = 1; k < 4; ++k) {
      first = sets.join(first, quad[k]);
    }
  }
  return std::move(sets).all();
}

bool has_repeated_corner(const Quad& quad) {
  return quad[0] == quad[1] || quad[1] == quad[2] || quad[2] == quad[3] || quad[3] == quad[0] ||
         quad[0] == quad[2] || quad[1] == quad[3];
}

/// Adds non-manifold surfaces face by face to OpenMesh and counts the faces added.
/// @param open receives 1 for components with a border.
void join_faces(const std::vector<glm::vec3>& vertices, const std::vector<Quad>& quads,
                const std::vector<int32_t>& piece_of, MeshCheck& check,
                std::vector<uint8_t>& open) {
  PolyMesh mesh;
  mesh.reserve(vertices.size(), quads.size() * 2, quads.size());
  for (const glm::vec3& p : vertices) {
    mesh.add_vertex(PolyMesh::Point(p.x, p.y, p.z));
  }
  for (const Quad& quad : quads) {
    if (has_repeated_corner(quad)) {
      ++check.nonmanifold_faces;
      continue;
    }
    const std::vector<PolyMesh::VertexHandle> corners = {
        mesh.vertex_handle(quad[0]), mesh.vertex_handle(quad[1]), mesh.vertex_handle(quad[2]),
        mesh.vertex_handle(quad[3])};
    // OpenMesh refuses a face that would make an edge or a vertex non-manifold (and reports it on
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
  for (auto edge = mesh.edges_begin(); edge != mesh.edges_end(); ++edge) {
    const PolyMesh::HalfedgeHandle half = mesh.halfedge_handle(*edge, 0);
    const int32_t piece = piece_of[mesh.to_vertex_handle(half).idx()];
    --check.euler[piece];
    open[piece] |= mesh.is_boundary(*edge) ? 1 : 0;
  }
  for (auto face = mesh.faces_begin(); face != mesh.faces_end(); ++face) {
    ++check.euler[piece_of[mesh.fv_begin(*face)->idx()]];
  }
}

}  // namespace

void require_corners(const std::vector<Quad>& quads, size_t vertex_count) {
  for (size_t f = 0; f < quads.size(); ++f) {
    for (const int32_t v : quads[f]) {
      if (v < 0 || static_cast<size_t>(v) >= vertex_count) {
        throw std::invalid_argument("quad " + std::to_string(f) + " uses vertex " +
                                    std::to_string(v) + " of " + std::to_string(vertex_count));
      }
    }
  }
}

MeshCheck check_mesh(const std::vector<glm::vec3>& vertices, const std::vector<Quad>& quads) {
  const auto vertex_count = static_cast<int32_t>(vertices.size());
  require_corners(quads, vertices.size());
  MeshCheck check;
  const HalfEdges halves(quads, vertices.size(), check);

  glm::dvec3 low(1e300), high(-1e300);
  for (const glm::vec3& p : vertices) {
    low = glm::min(low, glm::dvec3(p));
    high = glm::max(high, glm::dvec3(p));
  }
  const glm::dvec3 extent = vertices.empty() ? glm::dvec3(0.0) : high - low;
  const double smallest_area = 1e-14 * glm::dot(extent, extent);

  // Components in the order of their lowest vertex.
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
    ++check.euler[piece_of[v]];
  }

  std::vector<double> volumes(check.components, 0.0);
  bool repeated = false;
  for (const Quad& quad : quads) {
    volumes[piece_of[quad[0]]] += quad_volume(vertices, quad, low);
    const bool repeats = has_repeated_corner(quad);
    repeated = repeated || repeats;
    if (repeats || 0.5 * glm::length(area_vector(vertices, quad)) <= smallest_area) {
      ++check.zero_area_faces;
    }
  }

  std::vector<uint8_t> open(check.components, 0);
  if (repeated || check.nonmanifold_edges > 0 || check.flipped_edges > 0 ||
      !halves.single_fans(quads, vertices.size())) {
    join_faces(vertices, quads, piece_of, check, open);
  } else {
    for (const int32_t half : halves.edges) {
      const int32_t piece = piece_of[quads[half / 4][half % 4]];
      --check.euler[piece];
      open[piece] |= halves.mate[half] < 0 ? 1 : 0;
    }
    for (const Quad& quad : quads) {
      ++check.euler[piece_of[quad[0]]];
    }
  }
  check.winding_ok = check.flipped_edges == 0;
  for (int32_t piece = 0; piece < check.components; ++piece) {
    check.volume += volumes[piece];
    check.winding_ok = check.winding_ok && (open[piece] || volumes[piece] > 0.0);
  }
  return check;
}

}  // namespace snowbough::tree
