#include "tree/mesh/weights.h"

#include <algorithm>

#include "base/group_by_key.h"

namespace snowbough::tree {
namespace {

/// A place on a branch and the one or two bones that influence it.
struct BoneInfluence {
  int32_t first = -1;
  int32_t second = -1;
};

BoneInfluence bones_at(const LimbPath& path, int32_t first_bone, double s) {
  const int32_t segment = segment_at(path.lengths, s);
  const int32_t last = static_cast<int32_t>(path.points.size()) - 2;
  const double near = 1e-9 * path.length();
  if (segment < last && s >= path.lengths[segment + 1] - near) {
    return {first_bone + segment, first_bone + segment + 1};
  }
  return {first_bone + segment, -1};
}

void add_influence(const BoneInfluence& influence, InfluenceSum& sum) {
  if (influence.second < 0) {
    sum.add(influence.first, 1.0);
  } else {
    sum.add(influence.first, 0.5);
    sum.add(influence.second, 0.5);
  }
}

/// Calls visit(vertex, influence) for every place that influences a vertex.
template <typename Visit>
void for_each_influence(const Surface& surface, const std::vector<LimbPath>& paths,
                        const Armature& armature, const Visit& visit) {
  for (size_t b = 0; b < surface.limbs.size(); ++b) {
    for (const Ring& ring : surface.limbs[b].rings) {
      const BoneInfluence influence = bones_at(paths[b], armature.first_bone[b], ring.bone_length);
      for (const int32_t vertex : ring.vertices) {
        visit(vertex, influence);
      }
    }
  }
  for (const Junction& junction : surface.junctions) {
    if (!junction.inset) {
      continue;
    }
    const BoneInfluence influence = bones_at(
        paths[junction.parent], armature.first_bone[junction.parent], junction.parent_bone_length);
    for (const int32_t vertex : surface.limbs[junction.child].rings.front().vertices) {
      visit(vertex, influence);
    }
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
  // All influences, vertex by vertex: most have one.
  std::vector<int32_t> first_influence;
  std::vector<BoneInfluence> influences;
  base::group_by_key(
      surface.vertices.size(),
      [&](const auto& visit) { for_each_influence(surface, paths, armature, visit); },
      first_influence, influences);
  VertexWeights result;
  result.indices.resize(surface.vertices.size());
  result.weights.resize(surface.vertices.size());
  for (size_t vertex = 0; vertex < surface.vertices.size(); ++vertex) {
    InfluenceSum sum;
    for (int32_t i = first_influence[vertex]; i < first_influence[vertex + 1]; ++i) {
      add_influence(influences[i], sum);
    }
    sum.finish(max_influences, result.indices[vertex], result.weights[vertex]);
  }
  return result;
}

}  // namespace snowbough::tree
