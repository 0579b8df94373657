#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tree/surface/surface.h"

namespace snowbough::tree {

/// The faces around every vertex of a surface.
class VertexFaces {
 public:
  explicit VertexFaces(const Surface& surface);

  /// Ascending.
  std::span<const int32_t> at(int32_t vertex) const {
    return {faces_.data() + begin_[vertex], faces_.data() + begin_[vertex + 1]};
  }

 private:
  std::vector<int32_t> begin_;
  std::vector<int32_t> faces_;
};

/// Finds the faces near junctions, one after the other. One object per thread.
class Neighbourhoods {
 public:
  /// Both must outlive this object.
  Neighbourhoods(const Surface& surface, const VertexFaces& around);

  /// The faces within two edges of the junction: those at the knuckle, their neighbours, and the
  /// neighbours of those; neighbours share a vertex. Valid until the next call.
  const std::vector<int32_t>& at(const Junction& junction);

  /// After at(): the vertices all of whose faces were added.
  std::span<const int32_t> expanded() const { return {vertices_.data(), expanded_}; }

  /// After at(): per face, whether the previous junction had it as well.
  const std::vector<uint8_t>& known() const { return known_; }

  /// Whether the last at() found the face.
  bool has(int32_t face) const { return face_stamp_[face] == stamp_; }

 private:
  const Surface& surface_;
  const VertexFaces& around_;
  /// Number of the last junction that visited the face or the vertex.
  std::vector<int32_t> face_stamp_, vertex_stamp_;
  int32_t stamp_ = 0;
  std::vector<int32_t> vertices_, faces_;
  std::vector<uint8_t> known_;
  size_t expanded_ = 0;
};

}  // namespace snowbough::tree
