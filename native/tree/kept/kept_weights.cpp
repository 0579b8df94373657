#include "tree/kept/kept_weights.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "tree/skeleton/centreline.h"

namespace snowbough::tree {
namespace {

/// Distance from the parent's surface over which the surface passes from the parent to the branch,
/// in the branch's radii; and the largest share of the branch on which it may end.
constexpr double kPassage = 2.0;
constexpr double kLongestPassage = 0.6;
/// Smallest ratio of the lengths at which the passage ends and begins.
constexpr double kLever = 2.5;
/// Steps in which a branch is searched for both.
constexpr int kSteps = 48;
/// A share below this passes no further down the tree, and none further than this many branches.
constexpr double kMinShare = 1e-3;
constexpr int kDeepest = 6;

/// The bones of one branch, in a row.
struct Chain {
  int32_t first = -1;
  int32_t count = 0;
  /// Length up to each bone's head.
  std::vector<double> begin;
  double length = 0.0;
  /// Where it leaves its parent: lengths at which the passage begins and ends.
  double from = 0.0, to = 0.0;
};

struct ChainPlace {
  int32_t bone = 0;
  /// 0..1 along the bone.
  double t = 0.0;
  double length = 0.0;
};

class KeptWeights {
 public:
  KeptWeights(const Skeleton& skeleton, const Bones& bones)
      : skeleton_(skeleton), bones_(bones), chains_(skeleton.branches.size()) {
    for (size_t bone = 0; bone < bones.branches.size(); ++bone) {
      const int32_t branch = bones.branches[bone];
      if (branch < 0 || static_cast<size_t>(branch) >= chains_.size()) {
        throw std::invalid_argument("the bones are those of another skeleton");
      }
      Chain& chain = chains_[branch];
      if (chain.count++ == 0) chain.first = static_cast<int32_t>(bone);
      chain.begin.push_back(chain.length);
      chain.length += glm::distance(glm::dvec3(bones.heads[bone]), glm::dvec3(bones.tails[bone]));
    }
    first_child_.assign(chains_.size(), std::numeric_limits<double>::infinity());
    for (const Branch& branch : skeleton.branches) {
      if (branch.parent < 0) continue;
      double& first = first_child_[branch.parent];
      first = std::min(first, nearest(chains_[branch.parent], branch.attach_point).length);
    }
    for (size_t b = 0; b < chains_.size(); ++b) {
      if (chains_[b].count > 0) set_passage(static_cast<int32_t>(b));
    }
  }

  /// Adds the influences at a place of a branch.
  void add(int32_t branch, glm::vec3 place, InfluenceSum& sum) const {
    double share = 1.0;
    for (int deep = 0; deep <= kDeepest && share > kMinShare; ++deep) {
      const Chain& chain = chains_[branch];
      if (chain.count == 0) {
        throw std::invalid_argument("the branch '" + skeleton_.branches[branch].name +
                                    "' has no bones: give the mesh with all bones");
      }
      const ChainPlace at = nearest(chain, place);
      const double own = deep == kDeepest ? share : share * passed(chain, at.length);
      if (own > 0.0) add_bones(chain, at, own, sum);
      share -= own;
      if (skeleton_.branches[branch].parent < 0) return;
      branch = skeleton_.branches[branch].parent;
      place = nearest_place(skeleton_.branches[branch], place).point;
    }
  }

 private:
  void set_passage(int32_t b) {
    const Branch& branch = skeleton_.branches[b];
    if (branch.parent < 0) return;
    const Branch& parent = skeleton_.branches[branch.parent];
    Chain& chain = chains_[b];
    const double last = kLongestPassage * chain.length;
    chain.from = chain.to = last;
    // An acute branch stays near its parent for longer.
    for (int step = 0; step <= kSteps; ++step) {
      const double length = last * step / kSteps;
      const glm::vec3 point = point_at(chain, length);
      const CentrelinePlace place = nearest_place(parent, point);
      const double away = glm::distance(point, place.point) - radius_at(parent, place);
      const double own = radius_at(branch, nearest_place(branch, point));
      if (away >= 0.0) chain.from = std::min(chain.from, length);
      if (away >= kPassage * own) {
        chain.to = length;
        break;
      }
    }
    // Its bone turns about a place deep inside the parent, so what is far from it moves far.
    // But branches of its own move with the bone, and must find the surface there.
    const double room = std::max(chain.to, std::min(first_child_[b], last));
    chain.to = std::min(std::max(chain.to, kLever * chain.from), room);
    chain.from = std::min(chain.from, 0.5 * chain.to);
  }

  glm::vec3 point_at(const Chain& chain, double length) const {
    const auto after = std::upper_bound(chain.begin.begin(), chain.begin.end(), length);
    const auto i = static_cast<int32_t>(after - chain.begin.begin()) - 1;
    const glm::dvec3 head(bones_.heads[chain.first + i]), tail(bones_.tails[chain.first + i]);
    const double whole = glm::distance(head, tail);
    const double t = whole > 0.0 ? std::min((length - chain.begin[i]) / whole, 1.0) : 0.0;
    return glm::vec3(head + t * (tail - head));
  }

  /// Fraction of a place's weight that is the branch's own.
  static double passed(const Chain& chain, double length) {
    if (chain.to <= 0.0) return 1.0;
    const double t = std::clamp((length - chain.from) / (chain.to - chain.from), 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
  }

  ChainPlace nearest(const Chain& chain, const glm::vec3& point) const {
    ChainPlace best;
    double least = std::numeric_limits<double>::infinity();
    for (int32_t i = 0; i < chain.count; ++i) {
      const glm::dvec3 head(bones_.heads[chain.first + i]);
      const glm::dvec3 along = glm::dvec3(bones_.tails[chain.first + i]) - head;
      const double square = glm::dot(along, along);
      const double t =
          square > 0.0 ? std::clamp(glm::dot(glm::dvec3(point) - head, along) / square, 0.0, 1.0)
                       : 0.0;
      const glm::dvec3 away = glm::dvec3(point) - head - t * along;
      if (glm::dot(away, away) < least) {
        least = glm::dot(away, away);
        best = {i, t, chain.begin[i] + t * std::sqrt(square)};
      }
    }
    return best;
  }

  static void add_bones(const Chain& chain, const ChainPlace& at, double share, InfluenceSum& sum) {
    const int32_t next = at.t < 0.5 ? at.bone - 1 : at.bone + 1;
    const double other = next < 0 || next >= chain.count ? 0.0 : std::abs(at.t - 0.5);
    sum.add(chain.first + at.bone, share * (1.0 - other));
    if (other > 0.0) sum.add(chain.first + next, share * other);
  }

  const Skeleton& skeleton_;
  const Bones& bones_;
  std::vector<Chain> chains_;
  /// Per branch: length at which the first branch leaves it.
  std::vector<double> first_child_;
};

}  // namespace

VertexWeights kept_weights(const Skeleton& skeleton, const Bones& bones, int max_influences) {
  const KeptSurface& kept = skeleton.kept;
  const KeptWeights weights(skeleton, bones);
  VertexWeights result;
  result.indices.resize(kept.vertices.size());
  result.weights.resize(kept.vertices.size());
  for (size_t v = 0; v < kept.vertices.size(); ++v) {
    InfluenceSum sum;
    weights.add(kept.vertex_branch[v], kept.vertex_place[v], sum);
    sum.finish(max_influences, result.indices[v], result.weights[v]);
  }
  return result;
}

}  // namespace snowbough::tree
