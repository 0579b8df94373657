#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tree/skeleton/skeleton.h"

namespace snowbough::tree {

/// An edge of a face, and its start and end points: corner indices counted over all faces.
struct FaceEdge {
  /// Its vertices, the lower one in the upper half, the higher one in the lower half.
  uint64_t vertices = 0;
  /// Runs from the lower to the higher vertex.
  bool forward = false;
  int32_t face = 0;
  int32_t point = 0;
  int32_t next_point = 0;

  bool shares_vertex(const FaceEdge& other) const;
};

/// Edge-connected islands of some faces. Its vectors are reused.
class FaceConnections {
 public:
  /// @param faces  of three or more corners each.
  void find(const Foliage& foliage, std::span<const int32_t> faces);

  int32_t island_count() const { return island_count_; }
  /// Per face: the first face of its island.
  const std::vector<int32_t>& island_of() const { return island_of_; }
  /// Edges with one face.
  const std::vector<FaceEdge>& outline() const { return outline_; }
  /// Whether all other edges have two faces, one on either side.
  bool two_sided() const { return two_sided_; }

 private:
  void sort_edges(const Foliage& foliage, std::span<const int32_t> faces);
  void find_outline();
  void find_islands(int32_t face_count);

  /// Sorted: equal edges are adjacent.
  std::vector<FaceEdge> edges_;
  std::vector<FaceEdge> outline_;
  bool two_sided_ = true;
  int32_t island_count_ = 0;
  std::vector<int32_t> island_of_;
};

}  // namespace snowbough::tree
