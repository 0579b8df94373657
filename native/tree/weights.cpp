#include "tree/weights.h"

#include <algorithm>

namespace snowbough::tree {
namespace {

/// A place on a branch and the one or two bones that hold it.
struct Hold {
  int32_t first = -1;
  int32_t second = -1;
};

Hold bones_at(const LimbPath& path, int32_t first_bone, double s) {
  const int32_t segment = segment_at(path.lengths, s);
  const int32_t last = static_cast<int32_t>(path.points.size()) - 2;
  const double near = 1e-9 * path.length();
  if (segment < last && s >= path.lengths[segment + 1] - near) {
    return {first_bone + segment, first_bone + segment + 1};
  }
  return {first_bone + segment, -1};
}

void add_hold(const Hold& hold, InfluenceSum& sum) {
  if (hold.second < 0) {
    sum.add(hold.first, 1.0);
  } else {
    sum.add(hold.first, 0.5);
    sum.add(hold.second, 0.5);
  }
}

}  // namespace

void InfluenceSum::add(int32_t bone, double weight) {
  for (int i = 0; i < count_; ++i) {
    if (influences_[i].bone == bone) {
      influences_[i].weight += weight;
      return;
    }
  }
  if (count_ < static_cast<int>(influences_.size())) {
    influences_[count_++] = {bone, weight};
  }
}

void InfluenceSum::finish(int most, std::array<int32_t, 4>& indices,
                          std::array<float, 4>& weights) {
  std::sort(influences_.begin(), influences_.begin() + count_,
            [](const Influence& a, const Influence& b) {
              return a.weight != b.weight ? a.weight > b.weight : a.bone < b.bone;
            });
  const int kept = std::min(count_, most);
  double sum = 0.0;
  for (int i = 0; i < kept; ++i) {
    sum += influences_[i].weight;
  }
  indices = {};
  weights = {};
  for (int i = 0; i < kept; ++i) {
    indices[i] = influences_[i].bone;
    weights[i] = static_cast<float>(influences_[i].weight / sum);
  }
}

VertexWeights make_weights(const Surface& surface, const std::vector<LimbPath>& paths,
                           const Armature& armature, int max_influences) {
  std::vector<InfluenceSum> sums(surface.vertices.size());
  for (size_t b = 0; b < surface.limbs.size(); ++b) {
    for (const Ring& ring : surface.limbs[b].rings) {
      const Hold hold = bones_at(paths[b], armature.first_bone[b], ring.bone_length);
      for (int32_t vertex : ring.vertices) {
        add_hold(hold, sums[vertex]);
      }
    }
  }
  for (const Junction& junction : surface.junctions) {
    if (!junction.inset) {
      continue;
    }
    const Hold hold = bones_at(paths[junction.parent], armature.first_bone[junction.parent],
                               junction.parent_bone_length);
    for (int32_t vertex : surface.limbs[junction.child].rings.front().vertices) {
      add_hold(hold, sums[vertex]);
    }
  }
  VertexWeights result;
  result.indices.resize(sums.size());
  result.weights.resize(sums.size());
  for (size_t vertex = 0; vertex < sums.size(); ++vertex) {
    sums[vertex].finish(max_influences, result.indices[vertex], result.weights[vertex]);
  }
  return result;
}

}  // namespace snowbough::tree
