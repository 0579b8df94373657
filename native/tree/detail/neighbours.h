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
  /// Per entry of `all`: the vertex before it in the face that contributed the entry.
  std::vector<int32_t> before;

  Neighbours(const std::vector<Quad>& quads, size_t count) : begin(count + 1, 0) {
    // Every edge appears in both its faces, once in either direction.
    for (const Quad& quad : quads) {
      for (const int32_t v : quad) ++begin[v + 1];
    }
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    all.resize(begin.back());
    before.resize(begin.back());
    std::vector<int32_t> next(begin.begin(), begin.end() - 1);
    for (const Quad& quad : quads) {
      for (int k = 0; k < 4; ++k) {
        before[next[quad[k]]] = quad[(k + 3) % 4];
        all[next[quad[k]]++] = quad[(k + 1) % 4];
      }
    }
  }
  std::span<const int32_t> of(int32_t v) const {
    return {all.data() + begin[v], all.data() + begin[v + 1]};
  }
};

}  // namespace snowbough::tree
