#include "tree/crossings/neighbourhoods.h"

namespace snowbough::tree {

VertexFaces::VertexFaces(const Surface& surface) : begin_(surface.vertices.size() + 1, 0) {
  for (const Quad& quad : surface.quads) {
    for (int32_t v : quad) {
      ++begin_[v + 1];
    }
  }
  for (size_t v = 0; v + 1 < begin_.size(); ++v) {
    begin_[v + 1] += begin_[v];
  }
  faces_.resize(begin_.back());
  std::vector<int32_t> next(begin_.begin(), begin_.end() - 1);
  for (size_t f = 0; f < surface.quads.size(); ++f) {
    for (int32_t v : surface.quads[f]) {
      faces_[next[v]++] = static_cast<int32_t>(f);
    }
  }
}

Neighbourhoods::Neighbourhoods(const Surface& surface, const VertexFaces& around)
    : surface_(surface),
      around_(around),
      face_stamp_(surface.quads.size(), -1),
      vertex_stamp_(surface.vertices.size(), -1) {}

const std::vector<int32_t>& Neighbourhoods::at(const Junction& junction) {
  ++stamp_;
  vertices_.clear();
  faces_.clear();
  known_.clear();
  const auto reach = [&](int32_t v) {
    if (vertex_stamp_[v] != stamp_) {
      vertex_stamp_[v] = stamp_;
      vertices_.push_back(v);
    }
  };
  const LimbSurface& limb = surface_.limbs[junction.parent];
  for (int k = 0; k < 4; ++k) {
    reach(limb.rings[junction.row].vertices[k]);
    reach(limb.rings[junction.row + 1].vertices[k]);
    reach(surface_.limbs[junction.child].rings[0].vertices[k]);
  }
  size_t vertex = 0, face = 0;
  for (int step = 0; step < 3; ++step) {
    for (const size_t end = vertices_.size(); vertex < end; ++vertex) {
      for (const int32_t f : around_.at(vertices_[vertex])) {
        if (face_stamp_[f] != stamp_) {
          known_.push_back(face_stamp_[f] == stamp_ - 1 ? 1 : 0);
          face_stamp_[f] = stamp_;
          faces_.push_back(f);
        }
      }
    }
    expanded_ = vertex;
    // The last faces' vertices are not needed.
    for (; step < 2 && face < faces_.size(); ++face) {
      for (int32_t v : surface_.quads[faces_[face]]) {
        reach(v);
      }
    }
  }
  return faces_;
}

}  // namespace snowbough::tree
