#include "tree/crossings/crossings.h"

#include <algorithm>
#include <iterator>
#include <numeric>

#include "base/group_by_key.h"
#include "tree/crossings/whole.h"

namespace snowbough::tree {
namespace {

/// Edges between a junction's knuckle and the faces near it.
constexpr int kEdges = 2;

/// Finds the junctions near a face.
class NearJunctions {
 public:
  explicit NearJunctions(const Surface& surface) : surface_(surface) {
    const auto for_corners = [&](const auto& visit) {
      for (size_t f = 0; f < surface.quads.size(); ++f) {
        for (const int32_t v : surface.quads[f]) visit(v, static_cast<int32_t>(f));
      }
    };
    base::group_by_key(surface.vertices.size(), for_corners, first_face_, faces_);
    const auto for_knuckles = [&](const auto& visit) {
      for (size_t j = 0; j < surface.junctions.size(); ++j) {
        const Junction& junction = surface.junctions[j];
        const std::vector<Ring>& rings = surface.limbs[junction.parent].rings;
        for (int k = 0; k < 4; ++k) {
          visit(rings[junction.row].vertices[k], static_cast<int32_t>(j));
          visit(rings[junction.row + 1].vertices[k], static_cast<int32_t>(j));
          visit(surface.limbs[junction.child].rings[0].vertices[k], static_cast<int32_t>(j));
        }
      }
    };
    base::group_by_key(surface.vertices.size(), for_knuckles, first_junction_, junctions_);
  }

  /// Ascending.
  std::vector<int32_t> of(int32_t face) const {
    std::vector<int32_t> vertices(surface_.quads[face].begin(), surface_.quads[face].end());
    for (int edge = 0; edge < kEdges; ++edge) {
      std::vector<int32_t> more;
      for (const int32_t v : vertices) {
        for (int32_t i = first_face_[v]; i < first_face_[v + 1]; ++i) {
          const Quad& quad = surface_.quads[faces_[i]];
          more.insert(more.end(), quad.begin(), quad.end());
        }
      }
      vertices = once(std::move(more));
    }
    std::vector<int32_t> near;
    for (const int32_t v : vertices) {
      near.insert(near.end(), junctions_.begin() + first_junction_[v],
                  junctions_.begin() + first_junction_[v + 1]);
    }
    return once(std::move(near));
  }

 private:
  static std::vector<int32_t> once(std::vector<int32_t> numbers) {
    std::sort(numbers.begin(), numbers.end());
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
    return numbers;
  }

  const Surface& surface_;
  /// The faces around every vertex, and the junctions at whose knuckle it is.
  std::vector<int32_t> first_face_, faces_, first_junction_, junctions_;
};

}  // namespace

JunctionCrossings find_crossings(const Surface& surface, const std::vector<uint8_t>& moved,
                                 int threads) {
  std::vector<int32_t> all(surface.quads.size());
  std::iota(all.begin(), all.end(), 0);
  std::vector<uint8_t> changed;
  for (size_t f = 0; f < surface.quads.size() && !moved.empty(); ++f) {
    changed.push_back(moved[surface.origins[f].branch]);
  }
  JunctionCrossings crossings(surface.junctions.size());
  const NearJunctions near(surface);
  int32_t first = -1;
  std::vector<int32_t> of_first;
  for (const auto& pair : crossing_quads(surface.vertices, surface.quads, all, changed, threads)) {
    if (pair.first != first) of_first = near.of(first = pair.first);
    if (of_first.empty()) continue;
    const std::vector<int32_t> of_second = near.of(pair.second);
    std::vector<int32_t> of_both;
    std::set_intersection(of_first.begin(), of_first.end(), of_second.begin(), of_second.end(),
                          std::back_inserter(of_both));
    for (const int32_t j : of_both) crossings[j].push_back(pair);
  }
  return crossings;
}

}  // namespace snowbough::tree
