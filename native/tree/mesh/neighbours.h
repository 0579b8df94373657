#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "tree/skeleton/tree_mesh.h"

namespace snowbough::tree {

/// The vertices around every vertex, in flat arrays.
struct Neighbours {
  std::vector<int32_t> begin, all;
  /// Per entry of `all`: the face that contributed it, and the vertex before it in that face.
  std::vector<int32_t> face, before;

  Neighbours(const std::vector<Quad>& quads, size_t count) : begin(count + 1, 0) {
    // Every edge appears in both its faces, once in either direction.
    for (const Quad& quad : quads) {
      for (const int32_t v : quad) ++begin[v + 1];
    }
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    all.resize(begin.back());
    face.resize(begin.back());
    before.resize(begin.back());
    std::vector<int32_t> next(begin.begin(), begin.end() - 1);
    for (size_t f = 0; f < quads.size(); ++f) {
      for (int k = 0; k < 4; ++k) {
        const int32_t at = next[quads[f][k]]++;
        all[at] = quads[f][(k + 1) % 4];
        face[at] = static_cast<int32_t>(f);
        before[at] = quads[f][(k + 3) % 4];
      }
    }
  }
  std::span<const int32_t> of(int32_t v) const {
    return {all.data() + begin[v], all.data() + begin[v + 1]};
  }
  std::span<const int32_t> faces_of(int32_t v) const {
    return {face.data() + begin[v], face.data() + begin[v + 1]};
  }
};

}  // namespace snowbough::tree
