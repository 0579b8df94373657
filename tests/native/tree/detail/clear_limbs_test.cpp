#include "tree/detail/clear_limbs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "native/tree/built_surface.h"
#include "tree/build_tree_mesh.h"
#include "tree/crossings/whole.h"

namespace snowbough::tree {
namespace {

constexpr float kRadius = 0.005f;

/// Twigs of four sides that leave two trunks and pass each other, their middle lines so far apart:
/// along X, and across it slanting down, so that the corners of the first point at the second.
Skeleton passing(float apart) {
  const auto twig = [](int32_t parent, const glm::vec3& from, const glm::vec3& to) {
    return make_branch(parent, 1, {from, 0.5f * (from + to), to}, {kRadius, kRadius, kRadius});
  };
  Branch beside = trunk();
  for (glm::vec3& p : beside.points) p += glm::vec3(1.5f, -1.5f, 0.0f);
  beside.attach_point = beside.points.front();
  const float off = apart * std::sqrt(0.5f);
  const glm::vec3 start(1.5f, -1.5f, 6.5f + 2.0f * off);
  return make_skeleton({trunk(), twig(0, {0, 0, 5}, {3, 0, 5}), beside,
                        twig(2, start, start + glm::vec3(0.0f, 3.0f, -3.0f))});
}

int crossing_twigs(const Skeleton& skeleton, std::optional<Detail> detail) {
  TreeMeshOptions options;
  options.detail = detail;
  const TreeMesh mesh = build_tree_mesh(skeleton, options);
  const std::vector<glm::dvec3> points(mesh.vertices.begin(), mesh.vertices.end());
  std::vector<int32_t> all(mesh.quads.size());
  std::iota(all.begin(), all.end(), 0);
  int count = 0;
  for (const auto& [f, g] : crossing_quads(points, mesh.quads, all)) {
    const auto [a, b] = std::minmax(mesh.origins[f].branch, mesh.origins[g].branch);
    count += a == 1 && b == 3 ? 1 : 0;
  }
  return count;
}

TEST(ClearLimbs, TwigsWhoseTubesAreApartDoNotCross) {
  int crossing_bases = 0;
  for (const float apart : {2.03f, 2.06f, 2.09f, 2.12f}) {
    const Skeleton skeleton = passing(apart * kRadius);
    crossing_bases += crossing_twigs(skeleton, {}) > 0 ? 1 : 0;
    for (const Detail detail : {Detail::kGame, Detail::kDefault}) {
      EXPECT_EQ(crossing_twigs(skeleton, detail), 0) << apart;
    }
  }
  EXPECT_GT(crossing_bases, 0) << "their corners reach farther than their tubes";
}

TEST(ClearLimbs, TwigsThatCrossInTheExportStay) {
  EXPECT_GT(crossing_twigs(passing(0.2f * kRadius), Detail::kDefault), 0);
}

}  // namespace
}  // namespace snowbough::tree
