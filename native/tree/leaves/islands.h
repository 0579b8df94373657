#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tree/skeleton/skeleton.h"

namespace snowbough::tree {

/// An edge of a face, and the two points where it starts and ends: corners counted through all of
/// the faces.
struct FaceEdge {
  /// Its vertices, the lower one first, in the upper and the lower half; counted from the first
  /// face's first one.
  uint64_t vertices = 0;
  /// It goes from the lower to the higher vertex.
  bool forward = false;
  int32_t face = 0;
  int32_t point = 0;
  int32_t next_point = 0;

  bool shares_vertex(const FaceEdge& other) const;
};

/// How some faces hang together by edges: what does is an island. Leaves are mostly copies of one
/// another: nothing is done for faces that are numbered like those asked about before.
class FaceConnections {
 public:
  /// @param faces  of three or more corners each.
  void find(const Foliage& foliage, std::span<const int32_t> faces);

  int32_t island_count() const { return island_count_; }
  /// Of each face the first one of its island.
  const std::vector<int32_t>& island_of() const { return island_of_; }
  /// Edges that have one face.
  const std::vector<FaceEdge>& outline() const { return outline_; }
  /// Whether all other edges have two, one on either side.
  bool two_sided() const { return two_sided_; }

 private:
  void sort_edges();
  void find_outline();
  void find_islands(int32_t face_count);

  /// Of every face the number of corners and then their vertices, counted from the first face's
  /// first one: what is asked about and what was.
  std::vector<int32_t> numbering_;
  std::vector<int32_t> known_numbering_;
  /// Equal ones side by side.
  std::vector<FaceEdge> edges_;
  std::vector<FaceEdge> outline_;
  bool two_sided_ = true;
  int32_t island_count_ = 0;
  std::vector<int32_t> island_of_;
};

}  // namespace snowbough::tree
