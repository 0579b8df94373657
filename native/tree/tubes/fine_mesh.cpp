#include "tree/tubes/fine_mesh.h"

#include <cmath>
#include <glm/geometric.hpp>

#include "tree/tubes/patch.h"

namespace snowbough::tree {
namespace {

/// Tolerance across a limb for corners in line along it, as a fraction of the base's face.
constexpr double kAside = 1e-9;

/// Whether a face's corner lies between its two neighbours on a line along the limb: cut_patch puts
/// such a vertex at corner 0 or 2, and others between two across the limb.
bool is_between(const std::array<glm::dvec2, 4>& corners, int k) {
  const glm::dvec2 a = corners[k] - corners[(k + 3) % 4], b = corners[(k + 1) % 4] - corners[k];
  return std::abs(a.x) <= kAside && std::abs(b.x) <= kAside;
}

/// A point of edge k of a face, at fraction `t` from corner k to the next.
FinePlace on_edge(int32_t face, int k, double t) {
  switch (k) {
    case 0:
      return {face, t, 0.0};
    case 1:
      return {face, 1.0, t};
    case 2:
      return {face, 1.0 - t, 1.0};
    default:
      return {face, 0.0, 1.0 - t};
  }
}

class Cut {
 public:
  Cut(const std::vector<Quad>& quads, size_t vertex_count, const Edges& edges, const BaseCuts& cuts)
      : quads_(quads), edges_(edges), cuts_(cuts) {
    fine_.vertices.resize(vertex_count);
    for (size_t f = 0; f < quads.size(); ++f) {
      for (int k = 0; k < 4; ++k) {
        FinePlace& place = fine_.vertices[quads[f][k]];
        if (place.face < 0) place = on_edge(static_cast<int32_t>(f), k, 0.0);
      }
    }
    for (size_t e = 0; e < edges.all.size(); ++e) {
      first_on_edge_.push_back(static_cast<int32_t>(fine_.vertices.size()));
      const int32_t f = edges.all[e].left;
      int k = 0;
      while (edges.of_face[f][k] != static_cast<int32_t>(e)) ++k;
      const bool from_a = quads[f][k] == edges.all[e].a;
      const std::vector<double>& at = cuts.edges[e];
      for (size_t i = 1; i + 1 < at.size(); ++i) {
        fine_.vertices.push_back(on_edge(f, k, from_a ? at[i] : 1.0 - at[i]));
      }
    }
  }

  FineMesh cut() {
    fine_.quads.reserve(cuts_.quads);
    fine_.face.reserve(cuts_.quads);
    fine_.corners.reserve(cuts_.quads);
    for (size_t f = 0; f < quads_.size(); ++f) {
      add_patch(f);
    }
    return std::move(fine_);
  }

 private:
  /// Vertex `index` of edge k of a face, counted from the face's corner k.
  int32_t edge_vertex(size_t face, int k, int32_t index) const {
    const int32_t e = edges_.of_face[face][k];
    const auto last = static_cast<int32_t>(cuts_.edges[e].size()) - 1;
    if (index == 0) return quads_[face][k];
    if (index == last) return quads_[face][(k + 1) % 4];
    const bool from_a = quads_[face][k] == edges_.all[e].a;
    return first_on_edge_[e] + (from_a ? index : last - index) - 1;
  }

  /// Fraction of edge k of a face at `index`, counted from the face's corner k.
  double edge_share(size_t face, int k, int32_t index) const {
    const int32_t e = edges_.of_face[face][k];
    const std::vector<double>& at = cuts_.edges[e];
    const bool from_a = quads_[face][k] == edges_.all[e].a;
    return from_a ? at[index] : 1.0 - at[at.size() - 1 - index];
  }

  void add_patch(size_t f) {
    const PatchCuts cuts = patch_cuts(cuts_, edges_, f);
    cut_patch(cuts, patch_);
    const auto face = static_cast<int32_t>(f);
    const int strips = cuts.strips();
    const auto first_inside = static_cast<int32_t>(fine_.vertices.size());
    for (const Patch::Inside& inside : patch_.inside) {
      const double v = cuts.left == strips ? 1.0 - edge_share(f, 3, strips - inside.line)
                                           : edge_share(f, 1, inside.line);
      fine_.vertices.push_back({face, static_cast<double>(inside.step) / inside.steps, v});
    }
    for (const auto& quad : patch_.quads) {
      Quad vertices{};
      std::array<glm::dvec2, 4> corners{};
      for (int k = 0; k < 4; ++k) {
        const auto [place, index] = quad[k];
        FinePlace at;
        switch (place) {
          case PatchVertex::Place::kLow:
            vertices[k] = edge_vertex(f, 0, index);
            at = on_edge(face, 0, edge_share(f, 0, index));
            break;
          case PatchVertex::Place::kRight:
            vertices[k] = edge_vertex(f, 1, index);
            at = on_edge(face, 1, edge_share(f, 1, index));
            break;
          case PatchVertex::Place::kHigh:
            vertices[k] = edge_vertex(f, 2, cuts.high - index);
            at = on_edge(face, 2, edge_share(f, 2, cuts.high - index));
            break;
          case PatchVertex::Place::kLeft:
            vertices[k] = edge_vertex(f, 3, cuts.left - index);
            at = on_edge(face, 3, edge_share(f, 3, cuts.left - index));
            break;
          case PatchVertex::Place::kInside:
            vertices[k] = first_inside + index;
            at = fine_.vertices[vertices[k]];
            break;
        }
        corners[k] = {at.u, at.v};
      }
      fine_.quads.push_back(vertices);
      fine_.face.push_back(face);
      fine_.corners.push_back(corners);
    }
  }

  const std::vector<Quad>& quads_;
  const Edges& edges_;
  const BaseCuts& cuts_;
  FineMesh fine_;
  /// Per edge: its first inner vertex.
  std::vector<int32_t> first_on_edge_;
  Patch patch_;
};

}  // namespace

FineMesh cut_quads(const std::vector<Quad>& quads, size_t vertex_count, const Edges& edges,
                   const BaseCuts& cuts) {
  return Cut(quads, vertex_count, edges, cuts).cut();
}

std::vector<uint8_t> between_others(const FineMesh& fine) {
  std::vector<uint8_t> between(fine.vertices.size(), 0);
  for (size_t f = 0; f < fine.quads.size(); ++f) {
    for (const int k : {0, 2}) {
      if (is_between(fine.corners[f], k)) between[fine.quads[f][k]] = 1;
    }
  }
  return between;
}

void straighten(const FineMesh& fine, std::span<const uint8_t> faces,
                std::vector<glm::dvec3>& points) {
  for (size_t f = 0; f < fine.quads.size(); ++f) {
    if (faces[f] == 0) continue;
    const auto& at = fine.corners[f];
    for (const int k : {0, 2}) {
      if (!is_between(at, k)) continue;
      const int before = (k + 3) % 4, after = (k + 1) % 4;
      const double low = glm::distance(at[before], at[k]), high = glm::distance(at[k], at[after]);
      const Quad& quad = fine.quads[f];
      points[quad[k]] = (points[quad[before]] * high + points[quad[after]] * low) / (low + high);
    }
  }
}

}  // namespace snowbough::tree
