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

/// Sums the bone influences on one vertex and keeps the strongest.
class InfluenceSum {
 public:
  void add(int32_t bone, double weight);
  /// Returns the strongest `most` influences (1 to 4), strongest first, normalised to sum 1; on a
  /// tie the lower bone comes first.
  void finish(int most, std::array<int32_t, 4>& indices, std::array<float, 4>& weights);

 private:
  struct Influence {
    int32_t bone;
    double weight;
  };
  std::array<Influence, 16> influences_;
  int count_ = 0;
};

/// Weights from the construction of the surface, not from distances: a ring at a joint takes half
/// of each of its two bones, a tip its only one, a knuckle's ring in the middle of a bone that
/// bone. Where branches share vertices the influences are summed and normalised.
///
/// Source: D. T. Reynolds, PhD thesis, University of East Anglia, 2014, section 3.3.
VertexWeights make_weights(const Surface& surface, const std::vector<LimbPath>& paths,
                           const Armature& armature, int max_influences);

}  // namespace snowbough::tree
