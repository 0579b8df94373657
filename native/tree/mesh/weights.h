#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "tree/mesh/bones.h"
#include "tree/surface/surface.h"

namespace snowbough::tree {

struct VertexWeights {
  std::vector<std::array<int32_t, 4>> indices;
  std::vector<std::array<float, 4>> weights;
};

/// Adds up influences on one vertex and keeps the strongest few of them.
class InfluenceSum {
 public:
  void add(int32_t bone, double weight);
  /// The strongest `most` influences (1 to 4), strongest first, scaled to sum 1; of equals the
  /// lower bone.
  void finish(int most, std::array<int32_t, 4>& indices, std::array<float, 4>& weights);

 private:
  struct Influence {
    int32_t bone;
    double weight;
  };
  std::array<Influence, 16> influences_;
  int count_ = 0;
};

/// Weights as they follow from how the surface was built, never guessed from distance: a ring at a
/// joint takes half of each of its two bones, a tip all of its one, a knuckle's ring in the middle
/// of a bone that bone; where branches share vertices the influences add up and are scaled to
/// sum 1.
///
/// Source: D. T. Reynolds, PhD thesis, University of East Anglia, 2014, section 3.3.
VertexWeights make_weights(const Surface& surface, const std::vector<LimbPath>& paths,
                           const Armature& armature, int max_influences);

}  // namespace snowbough::tree
