#include "tree/leaves/islands.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "base/union_find.h"

namespace snowbough::tree {
namespace {

FaceEdge edge_between(int32_t from, int32_t to) {
  const auto low = static_cast<uint32_t>(std::min(from, to));
  const auto high = static_cast<uint32_t>(std::max(from, to));
  FaceEdge edge;
  edge.vertices = uint64_t{low} << 32U | high;
  edge.forward = from < to;
  return edge;
}

}  // namespace

bool FaceEdge::shares_vertex(const FaceEdge& other) const {
  const auto low = static_cast<uint32_t>(vertices >> 32U);
  const auto high = static_cast<uint32_t>(vertices);
  const auto other_low = static_cast<uint32_t>(other.vertices >> 32U);
  const auto other_high = static_cast<uint32_t>(other.vertices);
  return low == other_low || low == other_high || high == other_low || high == other_high;
}

void FaceConnections::sort_edges(const Foliage& foliage, std::span<const int32_t> faces) {
  edges_.clear();
  int32_t point = 0;
  for (size_t i = 0; i < faces.size(); ++i) {
    const int32_t count = foliage.face_begin[faces[i] + 1] - foliage.face_begin[faces[i]];
    const int32_t* const vertex = &foliage.corner_vertex[foliage.face_begin[faces[i]]];
    for (int32_t k = 0; k < count; ++k) {
      const int32_t next = k + 1 < count ? k + 1 : 0;
      FaceEdge& edge = edges_.emplace_back(edge_between(vertex[k], vertex[next]));
      edge.face = static_cast<int32_t>(i);
      edge.point = point + k;
      edge.next_point = point + next;
    }
    point += count;
  }
  std::sort(edges_.begin(), edges_.end(), [](const FaceEdge& a, const FaceEdge& b) {
    return a.vertices != b.vertices ? a.vertices < b.vertices : a.point < b.point;
  });
}

void FaceConnections::find_outline() {
  two_sided_ = true;
  outline_.clear();
  for (size_t i = 0; i < edges_.size();) {
    size_t end = i + 1;
    while (end < edges_.size() && edges_[end].vertices == edges_[i].vertices) {
      ++end;
    }
    if (end - i == 1) {
      outline_.push_back(edges_[i]);
    } else if (end - i > 2 || edges_[i].forward == edges_[i + 1].forward) {
      two_sided_ = false;
    }
    i = end;
  }
}

void FaceConnections::find_islands(int32_t face_count) {
  base::UnionFind islands(static_cast<size_t>(face_count));
  for (size_t i = 1; i < edges_.size(); ++i) {
    if (edges_[i].vertices == edges_[i - 1].vertices) {
      islands.join(edges_[i].face, edges_[i - 1].face);
    }
  }
  island_of_ = std::move(islands).all();
  island_count_ = 0;
  for (int32_t face = 0; face < face_count; ++face) {
    island_count_ += island_of_[face] == face ? 1 : 0;
  }
}

void FaceConnections::find(const Foliage& foliage, std::span<const int32_t> faces) {
  sort_edges(foliage, faces);
  find_outline();
  find_islands(static_cast<int32_t>(faces.size()));
}

}  // namespace snowbough::tree
