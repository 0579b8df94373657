#include "tree/crossings/neighbourhoods.h"

#include "base/group_by_key.h"

namespace snowbough::tree {

VertexFaces::VertexFaces(const Surface& surface) {
  const auto for_corners = [&](const auto& visit) {
    for (size_t f = 0; f < surface.quads.size(); ++f) {
      for (const int32_t v : surface.quads[f]) visit(v, static_cast<int32_t>(f));
    }
  };
  base::group_by_key(surface.vertices.size(), for_corners, begin_, faces_);
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
