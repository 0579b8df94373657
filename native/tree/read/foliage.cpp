#include "tree/read/foliage.h"

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <utility>

#include "tree/obj/polygons.h"
#include "tree/skeleton/segment_tree.h"

namespace snowbough::tree {
namespace {

/// Shapes with fewer leaves than this do not determine their base.
constexpr size_t kFewLeaves = 16;
/// Sampled leaves per shape to find its base.
constexpr size_t kSampleSize = 256;
/// Fraction of the sample in which one vertex must be nearest to wood to be the base; and fraction
/// of the best vertex's count at which another one belongs to the base (leaf cards stand on an
/// edge).
constexpr double kBaseShare = 0.35;
constexpr double kSecondShare = 0.6;
/// Sampled leaves per shape to find its petiole, and search steps for its length: first up to this
/// many times the base's median distance, then around the best.
constexpr size_t kPetioleSample = 96;
constexpr size_t kPetioleSteps = 12;
constexpr double kLongestPetiole = 2.0;
/// Required gain in distance to wood for accepting a petiole.
constexpr double kPetioleGain = 0.5;
/// Leaves per thread at a time, of the sample and of all.
constexpr size_t kSampleBlock = 32;
constexpr size_t kLeafBlock = 1024;

/// Faces and vertices of one leaf, as ranges of the foliage.
struct Leaf {
  int32_t first_face = 0, last_face = 0;
  int32_t first_vertex = 0, last_vertex = 0;

  int32_t vertex_count() const { return last_vertex - first_vertex; }
};

std::vector<Leaf> leaves_of(const Foliage& foliage) {
  std::vector<Leaf> leaves;
  for (size_t f = 0; f < foliage.face_leaf.size(); ++f) {
    const auto [low, high] =
        std::minmax_element(foliage.corner_vertex.begin() + foliage.face_begin[f],
                            foliage.corner_vertex.begin() + foliage.face_begin[f + 1]);
    if (static_cast<size_t>(foliage.face_leaf[f]) == leaves.size()) {
      leaves.push_back({static_cast<int32_t>(f), static_cast<int32_t>(f), *low, *high + 1});
    }
    Leaf& leaf = leaves.back();
    leaf.last_face = static_cast<int32_t>(f) + 1;
    leaf.first_vertex = std::min(leaf.first_vertex, *low);
    leaf.last_vertex = std::max(leaf.last_vertex, *high + 1);
  }
  return leaves;
}

/// Equal for leaves with the same polygons over their vertices.
void shape_key(const Foliage& foliage, const Leaf& leaf, std::vector<int32_t>& key) {
  key.assign(1, leaf.vertex_count());
  for (int32_t f = leaf.first_face; f < leaf.last_face; ++f) {
    key.push_back(-1);
    for (int32_t c = foliage.face_begin[f]; c < foliage.face_begin[f + 1]; ++c) {
      key.push_back(foliage.corner_vertex[c] - leaf.first_vertex);
    }
  }
}

/// The leaves by shape, ascending.
std::map<std::vector<int32_t>, std::vector<int32_t>> leaves_by_shape(
    const Foliage& foliage, const std::vector<Leaf>& leaves) {
  std::map<std::vector<int32_t>, std::vector<int32_t>> shapes;
  auto shape = shapes.end();
  std::vector<int32_t> key;
  for (size_t i = 0; i < leaves.size(); ++i) {
    shape_key(foliage, leaves[i], key);
    // Usually the same as for the previous leaf.
    if (shape == shapes.end() || shape->first != key) shape = shapes.try_emplace(key).first;
    shape->second.push_back(static_cast<int32_t>(i));
  }
  return shapes;
}

/// Base of the leaves of one shape on their petioles.
struct LeafBase {
  /// Vertices, counted within the leaf, whose mean is the base; empty: no common base.
  std::vector<int32_t> vertices;
  double petiole = 0.0;
};

/// The base extended by `petiole` metres away from the leaf's centre.
glm::vec3 foot_of(const Foliage& foliage, const Leaf& leaf, const LeafBase& base, double petiole) {
  glm::dvec3 centre(0.0);
  for (int32_t v = leaf.first_vertex; v < leaf.last_vertex; ++v) {
    centre += glm::dvec3(foliage.vertices[v]);
  }
  centre /= static_cast<double>(leaf.vertex_count());
  glm::dvec3 foot(0.0);
  for (const int32_t v : base.vertices) foot += glm::dvec3(foliage.vertices[leaf.first_vertex + v]);
  foot /= static_cast<double>(base.vertices.size());
  const glm::dvec3 away = foot - centre;
  const double length = glm::length(away);
  if (length > 0.0) foot += away * (petiole / length);
  return glm::vec3(foot);
}

/// The leaf's own vertex nearest to wood; `vertex` receives its index within the leaf.
NearestSegment nearest_vertex(const SegmentTree& segments, const Foliage& foliage, const Leaf& leaf,
                              int32_t& vertex) {
  NearestSegment best;
  best.cost = std::numeric_limits<double>::infinity();
  for (int32_t v = leaf.first_vertex; v < leaf.last_vertex; ++v) {
    // The result so far limits the search for the next vertex.
    const NearestSegment found =
        segments.nearest(foliage.vertices[v], 1, Measure::kSurface, nullptr, best.cost);
    if (found.branch >= 0) {
      best = found;
      vertex = v - leaf.first_vertex;
    }
  }
  return best;
}

/// The limb nearest to `foot`; `last` is where the previous leaf is attached, usually nearby: its
/// distance limits the search.
NearestSegment nearest_from(const SegmentTree& segments, const glm::vec3& foot,
                            const NearestSegment& last) {
  if (last.branch >= 0) {
    const double limit = 1.06 * glm::distance(glm::dvec3(foot), glm::dvec3(last.point));
    const NearestSegment found = segments.nearest(foot, 1, Measure::kSurface, nullptr, limit);
    if (found.branch >= 0) return found;
  }
  return segments.nearest(foot, 1, Measure::kSurface);
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

LeafBase find_base(const SegmentTree& segments, const Foliage& foliage,
                   const std::vector<Leaf>& leaves, const std::vector<int32_t>& members,
                   int threads) {
  LeafBase base;
  if (members.size() < kFewLeaves) return base;
  std::vector<Leaf> sample;
  const size_t count = std::min(members.size(), kSampleSize);
  for (size_t i = 0; i < count; ++i) sample.push_back(leaves[members[i * members.size() / count]]);

  std::vector<int32_t> nearest(sample.size(), 0);
  base::parallel_for(sample.size(), kSampleBlock, {threads, {}}, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      nearest_vertex(segments, foliage, sample[i], nearest[i]);
    }
  });
  std::vector<double> votes(sample.front().vertex_count(), 0.0);
  for (const int32_t vertex : nearest) votes[vertex] += 1.0;
  const double most = *std::max_element(votes.begin(), votes.end());
  double together = 0.0;
  for (size_t v = 0; v < votes.size(); ++v) {
    if (votes[v] < kSecondShare * most) continue;
    base.vertices.push_back(static_cast<int32_t>(v));
    together += votes[v];
  }
  if (base.vertices.size() > 2 || together < kBaseShare * static_cast<double>(count)) {
    base.vertices.clear();
    return base;
  }

  const auto distance_with = [&](double petiole) {
    std::vector<double> distances(sample.size());
    for (size_t i = 0; i < sample.size(); ++i) {
      const glm::vec3 foot = foot_of(foliage, sample[i], base, petiole);
      distances[i] = segments.nearest(foot, 1, Measure::kSurface).cost;
    }
    return median(std::move(distances));
  };
  // Spread over the tree like the larger sample.
  const size_t fewer = std::min(sample.size(), kPetioleSample);
  for (size_t i = 0; i < fewer; ++i) sample[i] = sample[i * sample.size() / fewer];
  sample.resize(fewer);
  const double without = distance_with(0.0);
  double best = kPetioleGain * without;
  double centre = 0.5 * kLongestPetiole * without;
  double reach = centre;
  for (int round = 0; round < 3; ++round) {
    const double from = centre - reach;
    const auto petiole_of = [&](size_t step) {
      return from +
             2.0 * reach * static_cast<double>(step + 1) / static_cast<double>(kPetioleSteps);
    };
    std::array<double, kPetioleSteps> with{};
    base::parallel_for(kPetioleSteps, 1, {threads, {}},
                       [&](size_t step, size_t) { with[step] = distance_with(petiole_of(step)); });
    for (size_t step = 0; step < kPetioleSteps; ++step) {
      if (with[step] < best) {
        best = with[step];
        base.petiole = petiole_of(step);
      }
    }
    if (base.petiole == 0.0) break;
    centre = base.petiole;
    reach *= 2.0 / static_cast<double>(kPetioleSteps);
  }
  return base;
}

}  // namespace

Foliage gather_foliage(const ObjScene& scene, const Parts& parts,
                       const ClassifiedParts& classified) {
  Foliage foliage;
  PolygonGatherer gatherer(scene, parts, foliage);
  int32_t leaf = 0;
  for (int32_t p = 0; p < parts.count(); ++p) {
    if (classified.role[p] != PartRole::kFoliage) continue;
    gatherer.add(p);
    foliage.face_leaf.resize(foliage.face_material.size(), leaf++);
  }
  gatherer.finish();
  return foliage;
}

void attach_leaves(const std::vector<Branch>& branches, Foliage& foliage,
                   const base::Execution& execution) {
  const std::vector<Leaf> leaves = leaves_of(foliage);
  if (leaves.empty()) {
    foliage.leaf_branch.clear();
    foliage.leaf_attach_point.clear();
    base::report_progress(execution.progress, 1.0f);
    return;
  }
  const SegmentTree segments(branches, std::vector<int32_t>(branches.size(), 0), 0.0f);
  foliage.leaf_branch.assign(leaves.size(), -1);
  foliage.leaf_attach_point.assign(leaves.size(), glm::vec3(0.0f));

  const auto share = [&](size_t done) {
    return static_cast<float>(done) / static_cast<float>(std::max<size_t>(leaves.size(), 1));
  };
  size_t done = 0;
  for (const auto& [key, members] : leaves_by_shape(foliage, leaves)) {
    base::report_progress(execution.progress, share(done));
    const LeafBase base = find_base(segments, foliage, leaves, members, execution.threads);
    const auto attach = [&, &of = members](size_t begin, size_t end) {
      NearestSegment found{};
      for (size_t m = begin; m < end; ++m) {
        const int32_t i = of[m];
        int32_t vertex = 0;
        found =
            base.vertices.empty()
                ? nearest_vertex(segments, foliage, leaves[i], vertex)
                : nearest_from(segments, foot_of(foliage, leaves[i], base, base.petiole), found);
        foliage.leaf_branch[i] = found.branch;
        foliage.leaf_attach_point[i] = found.point;
      }
    };
    base::parallel_for(members.size(), kLeafBlock,
                       execution.part(share(done), share(done + members.size())), attach);
    done += members.size();
  }
  base::report_progress(execution.progress, 1.0f);
}

}  // namespace snowbough::tree
