#include "tree/detail/clear_limbs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "native/tree/collars/built_tubes.h"
#include "tree/build_tree_mesh.h"
#include "tree/collars/places.h"
#include "tree/crossings/whole.h"
#include "tree/tubes/fine_mesh.h"

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

/// A trunk along Z and limbs off it along X, some of whose vertices are misplaced.
struct Dented {
  BuiltTubes built;
  FineMesh fine;
  std::vector<glm::dvec3> points;

  explicit Dented(const Skeleton& skeleton)
      : built(skeleton),
        fine(cut_quads(built.built.surface.quads, built.built.surface.vertices.size(),
                       Edges(built.built.surface.quads, built.built.surface.vertices.size()),
                       built.cuts)),
        points(limb_positions(built.built.surface, built.tubes, built.forks, fine, 1)) {}

  const Surface& surface() const { return built.built.surface; }

  /// Draws the limb's vertex nearest to x into the trunk's middle, and out on its other side.
  void draw_through_trunk(int32_t limb, double x) {
    int32_t nearest = -1;
    for (size_t f = 0; f < fine.quads.size(); ++f) {
      if (surface().origins[fine.face[f]].branch != limb) continue;
      for (const int32_t v : fine.quads[f]) {
        const auto off = [&](int32_t w) { return std::abs(points[w].x - x); };
        if (nearest < 0 || off(v) < off(nearest)) nearest = v;
      }
    }
    points[nearest].x = -0.5;
    points[nearest].y = 0.0;
  }

  void clear() {
    std::vector<int32_t> parents(surface().limbs.size(), 0);
    parents[0] = -1;
    clear_limbs(surface(), built.built.paths, parents, limb_chains(surface(), parents), fine, {},
                points);
  }

  size_t crossings() const {
    std::vector<int32_t> all(fine.quads.size());
    std::iota(all.begin(), all.end(), 0);
    return crossing_quads(points, fine.quads, all).size();
  }
};

/// A straight limb off the trunk, with a joint every quarter of a metre.
Branch limb_along_x(float height, float radius) {
  std::vector<glm::vec3> points;
  for (int i = 0; i <= 16; ++i) points.emplace_back(0.25f * static_cast<float>(i), 0.0f, height);
  return make_branch(0, 1, points, std::vector<float>(points.size(), radius));
}

TEST(ClearLimbs, WhatLiesFarFromACrossingOfParentAndChildStays) {
  Dented tree(make_skeleton({trunk(), limb_along_x(5.5f, 0.1f)}));
  ASSERT_EQ(tree.crossings(), 0U);
  // Off the base, where only undoing the move brings them back.
  for (glm::dvec3& p : tree.points) p.z += p.x > 2.0 ? 0.01 * (p.x - 2.0) : 0.0;
  const std::vector<glm::dvec3> before(tree.points);
  tree.draw_through_trunk(1, 0.5);
  ASSERT_GT(tree.crossings(), 0U);
  tree.clear();
  EXPECT_EQ(tree.crossings(), 0U);
  for (size_t v = 0; v < before.size(); ++v) {
    if (before[v].x > 2.0 || before[v].z < 4.0) {
      EXPECT_EQ(tree.points[v], before[v]);
    }
  }
}

TEST(ClearLimbs, HowFarGoesBackDependsOnWhatCrossesThere) {
  Dented tree(make_skeleton({trunk(), limb_along_x(5.5f, 0.1f), limb_along_x(2.5f, 0.004f)}));
  for (glm::dvec3& p : tree.points) p.z += p.z < 3.0 && p.x > 0.6 ? 0.001 * p.x : 0.0;
  const std::vector<glm::dvec3> before(tree.points);
  tree.draw_through_trunk(1, 0.5);
  tree.draw_through_trunk(2, 0.22);
  tree.clear();
  EXPECT_EQ(tree.crossings(), 0U);
  for (size_t v = 0; v < before.size(); ++v) {
    if (before[v].z < 3.0 && before[v].x > 0.6) {
      EXPECT_EQ(tree.points[v], before[v]) << "the thick limb's reach is not the thin one's";
    }
  }
}

TEST(ClearLimbs, LimbsAsThinAsAnyMayBeAreRepairedAsWell) {
  Dented tree(make_skeleton({trunk(), limb_along_x(5.5f, 0.0f), limb_along_x(2.5f, 0.1f)}));
  ASSERT_EQ(tree.crossings(), 0U);
  tree.draw_through_trunk(1, 0.3);
  ASSERT_GT(tree.crossings(), 0U);
  tree.clear();
  EXPECT_EQ(tree.crossings(), 0U);
}

}  // namespace
}  // namespace snowbough::tree
