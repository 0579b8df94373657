#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "tree/skeleton/tree_mesh.h"

namespace snowbough::tree {

/// Undirected edges of quads, numbered as they first appear in the faces.
struct Edges {
  struct Edge {
    /// Vertices, a < b.
    int32_t a, b;
    /// Faces on both sides, in face order; right is -1 at a border.
    int32_t left = -1, right = -1;
  };
  std::vector<Edge> all;
  /// Per face and corner k: the edge from corner k to k + 1.
  std::vector<std::array<int32_t, 4>> of_face;

  Edges(const std::vector<Quad>& quads, size_t vertex_count) {
    std::vector<int32_t> head(vertex_count, -1), next;
    of_face.resize(quads.size());
    all.reserve(quads.size() * 2);
    next.reserve(quads.size() * 2);
    for (size_t f = 0; f < quads.size(); ++f) {
      for (int k = 0; k < 4; ++k) {
        const int32_t a = std::min(quads[f][k], quads[f][(k + 1) % 4]);
        const int32_t b = std::max(quads[f][k], quads[f][(k + 1) % 4]);
        int32_t e = head[a];
        while (e >= 0 && all[e].b != b) {
          e = next[e];
        }
        if (e < 0) {
          e = static_cast<int32_t>(all.size());
          all.push_back({a, b, static_cast<int32_t>(f), -1});
          next.push_back(head[a]);
          head[a] = e;
        } else {
          all[e].right = static_cast<int32_t>(f);
        }
        of_face[f][k] = e;
      }
    }
  }
};

}  // namespace snowbough::tree
