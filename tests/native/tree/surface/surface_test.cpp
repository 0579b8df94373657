#include "tree/surface/surface.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "native/tree/built_surface.h"
#include "tree/build_tree_mesh.h"
#include "tree/crossings/crossings.h"
#include "tree/crossings/uncrossed_surface.h"
#include "tree/mesh/bones_reduce.h"
#include "tree/surface/limb_path.h"

namespace snowbough::tree {
namespace {

using testing::Contains;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

int count_part(const Surface& surface, FacePart part) {
  return static_cast<int>(
      std::count_if(surface.origins.begin(), surface.origins.end(),
                    [&](const FaceOrigin& origin) { return origin.part == part; }));
}

TEST(Surface, AStraightTrunkIsAPrismWithARingAtEveryJoint) {
  const Built built = build(make_skeleton({trunk()}));
  EXPECT_THAT(built.surface.limbs[0].rings, SizeIs(11));
  EXPECT_THAT(built.surface.quads, SizeIs(10 * 4 + 2));
  // Corners at sqrt(area / 2): the square prism holds as much wood as the round limb.
  EXPECT_NEAR(check(built.surface).volume, M_PI * 0.2 * 0.2 * 10.0, 1e-4);
}

TEST(Surface, ARingsCornersLieAtTheRootOfHalfItsArea) {
  const Built built = build(make_skeleton({trunk()}));
  const Ring& ring = built.surface.limbs[0].rings[5];
  for (int32_t v : ring.vertices) {
    EXPECT_NEAR(glm::distance(built.surface.vertices[v], glm::dvec3(0.0, 0.0, 5.0)),
                std::sqrt(0.5 * M_PI * 0.2 * 0.2), 1e-6);
  }
}

TEST(Surface, AChildAsThickAsItsParentTakesTheKnucklesSide) {
  const Built built = build(make_skeleton({trunk(), side_branch(5.5f, 0.2f)}));
  ASSERT_THAT(built.surface.junctions, SizeIs(1));
  EXPECT_FALSE(built.surface.junctions[0].inset);
  EXPECT_EQ(count_part(built.surface, FacePart::kInset), 0);
  const Ring& low = built.surface.limbs[0].rings[built.surface.junctions[0].row];
  EXPECT_EQ(built.surface.limbs[1].rings[0].vertices[0],
            low.vertices[built.surface.junctions[0].side]);
}

TEST(Surface, AThinChildGetsAnInsetWithItsOwnWidth) {
  const Built built = build(make_skeleton({trunk(), side_branch(5.5f, 0.05f)}));
  ASSERT_THAT(built.surface.junctions, SizeIs(1));
  EXPECT_TRUE(built.surface.junctions[0].inset);
  EXPECT_EQ(count_part(built.surface, FacePart::kInset), 4);
  const auto& hole = built.surface.limbs[1].rings[0].vertices;
  const double side = std::sqrt(M_PI * 0.05 * 0.05);
  EXPECT_NEAR(glm::distance(built.surface.vertices[hole[0]], built.surface.vertices[hole[1]]), side,
              1e-3);
  EXPECT_NEAR(glm::distance(built.surface.vertices[hole[1]], built.surface.vertices[hole[2]]), side,
              1e-3);
}

TEST(Surface, AChildThickerThanItsParentIsNarrowedToItAndReported) {
  const Skeleton skeleton = make_skeleton({trunk(0.1f), side_branch(5.5f, 0.3f)});
  const TreeMesh mesh = build_tree_mesh(skeleton);
  EXPECT_THAT(mesh.warnings, testing::Contains(HasSubstr("thicker than their parent")));
  EXPECT_THAT(build(skeleton).surface.clamped, ElementsAre(1));
}

TEST(Surface, TheSideThatFacesTheChildStaysOpen) {
  for (const glm::vec3 direction : {glm::vec3(1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(-1, 0, 0)}) {
    const Built built = build(make_skeleton({trunk(), side_branch(5.5f, 0.1f, direction)}));
    const auto& hole = built.surface.limbs[1].rings[0];
    EXPECT_GT(glm::dot(glm::normalize(hole.normal), glm::dvec3(direction)), 0.99);
  }
}

TEST(Surface, FourChildrenAtOnePlaceShareAKnuckleAndEightTakeTwo) {
  for (int count : {4, 8}) {
    const Built built = build(whorl(count));
    std::set<int32_t> knuckles;
    for (const Junction& junction : built.surface.junctions) {
      knuckles.insert(junction.row);
    }
    EXPECT_THAT(knuckles, SizeIs(count / 4));
    EXPECT_THAT(check(built.surface).euler, ElementsAre(2));
    EXPECT_THAT(find_crossings(built.surface), Each(IsEmpty()));
  }
}

TEST(Surface, OfTwoChildrenAtTheEndTheStraighterContinuesFromTheEndRing) {
  const glm::vec3 top(0.0f, 0.0f, 10.0f);
  const Branch straight = make_branch(0, 1, {top, top + glm::vec3(0.1f, 0.0f, 1.0f)}, {0.1f, 0.1f});
  const Branch bent = make_branch(0, 1, {top, top + glm::vec3(1.0f, 0.0f, 0.2f)}, {0.1f, 0.1f});
  const Built built = build(make_skeleton({trunk(), bent, straight}));
  EXPECT_FALSE(built.surface.limbs[1].continues_parent);
  EXPECT_TRUE(built.surface.limbs[2].continues_parent);
  EXPECT_EQ(built.surface.limbs[2].rings[0].vertices, built.surface.limbs[0].rings.back().vertices);
}

TEST(Surface, JointsInsideAKnuckleLoseTheirRing) {
  const Built built = build(make_skeleton({trunk(), side_branch(5.0f, 0.2f)}));
  for (const Ring& ring : built.surface.limbs[0].rings) {
    EXPECT_GT(std::abs(ring.centre.z - 5.0), 0.05);
  }
}

TEST(Surface, OpenRootAndTipsLeaveTheirRingsOpen) {
  TreeMeshOptions options;
  options.close_root = false;
  options.close_tips = false;
  BuildReport report;
  build_tree_mesh(make_skeleton({trunk(), side_branch(5.5f, 0.1f)}), options, &report);
  EXPECT_EQ(report.check.boundary_edges, 3 * 4);
}

TEST(Surface, NoWidthVanishesWhereTheTreeHasNone) {
  std::vector<Branch> branches = {trunk(), side_branch(5.5f, 0.0f)};
  branches[0].radii.back() = branches[0].areas.back() = 0.0f;
  const TreeMesh mesh = build_tree_mesh(make_skeleton(branches));
  for (const Quad& quad : mesh.quads) {
    for (int k = 0; k < 4; ++k) {
      EXPECT_GT(glm::distance(mesh.vertices[quad[k]], mesh.vertices[quad[(k + 1) % 4]]),
                2e-5f * 10.0f);
    }
  }
}

TEST(Surface, TwoHundredRandomSkeletonsAreClosedAndConsistentlyWound) {
  for (uint32_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Skeleton skeleton = RandomSkeleton(seed).make();
    const auto roots = std::count_if(skeleton.branches.begin(), skeleton.branches.end(),
                                     [](const Branch& branch) { return branch.parent < 0; });
    const Built built = build(skeleton);
    const MeshCheck result = check(built.surface);
    EXPECT_TRUE(result.closed());
    EXPECT_EQ(result.components, roots);
    EXPECT_THAT(result.euler, Each(2));
    EXPECT_EQ(result.flipped_edges, 0);
    EXPECT_EQ(result.zero_area_faces, 0);
    EXPECT_EQ(result.unused_vertices, 0);
  }
}

TEST(Surface, NeighbouringRingsPairTheirCornersWithTheSmallestRotation) {
  for (uint32_t seed = 1; seed <= 50; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Surface surface = build(RandomSkeleton(seed).make()).surface;
    for (const LimbSurface& limb : surface.limbs) {
      for (size_t r = 0; r + 1 < limb.rings.size(); ++r) {
        const Ring &a = limb.rings[r], &b = limb.rings[r + 1];
        if (glm::dot(a.normal, b.normal) < -0.99) {
          continue;  // At an exact reversal all pairings turn by the same amount.
        }
        std::array<double, 4> sums{};
        for (int shift = 0; shift < 4; ++shift) {
          for (int k = 0; k < 4; ++k) {
            const glm::dvec3 offset = (surface.vertices[a.vertices[k]] - a.centre) -
                                      (surface.vertices[b.vertices[(k + shift) % 4]] - b.centre);
            sums[shift] += glm::dot(offset, offset);
          }
        }
        EXPECT_LE(sums[0], *std::min_element(sums.begin(), sums.end()) * (1.0 + 1e-6));
      }
    }
  }
}

TEST(Surface, SameSkeletonSameBytes) {
  const Skeleton skeleton = RandomSkeleton(7).make();
  const TreeMesh a = build_tree_mesh(skeleton), b = build_tree_mesh(skeleton);
  EXPECT_EQ(a.vertices, b.vertices);
  EXPECT_EQ(a.quads, b.quads);
  EXPECT_EQ(a.bone_weights, b.bone_weights);
  EXPECT_EQ(a.uv_snow, b.uv_snow);
}

TEST(Origins, CornersOfAWallAreItsRowsAndSides) {
  const Surface surface = build(RandomSkeleton(3).make()).surface;
  for (size_t f = 0; f < surface.quads.size(); ++f) {
    const FaceOrigin& origin = surface.origins[f];
    if (origin.part == FacePart::kWall) {
      const LimbSurface& limb = surface.limbs[origin.branch];
      const auto& low = limb.rings[origin.row].vertices;
      const auto& high = limb.rings[origin.row + 1].vertices;
      const int side = origin.side, after = (origin.side + 1) % 4;
      EXPECT_EQ(surface.quads[f], (Quad{low[side], low[after], high[after], high[side]}));
    }
  }
}

TEST(Crossings, AnOverlapAtAJunctionIsFound) {
  // A child bent back through its own trunk crosses it two rows above the knuckle.
  const Skeleton clean = make_skeleton({trunk(), side_branch(5.5f, 0.1f)});
  EXPECT_THAT(find_crossings(build(clean).surface), Each(IsEmpty()));
  const Branch hooked =
      make_branch(0, 1, {{0, 0, 5.5f}, {0.6f, 0, 5.5f}, {-0.6f, 0, 6.2f}}, {0.1f, 0.1f, 0.1f});
  EXPECT_THAT(find_crossings(build(make_skeleton({trunk(), hooked})).surface),
              Contains(Not(IsEmpty())).Times(1));
}

TEST(Options, OutOfRangeIsAnErrorWithTheRange) {
  const Skeleton skeleton = make_skeleton({trunk()});
  TreeMeshOptions options;
  options.snow_resolution = 9;
  EXPECT_THROW(build_tree_mesh(skeleton, options), std::invalid_argument);
  EXPECT_THROW(reduce_bones({}, {-1, 0}), std::invalid_argument);
  EXPECT_THROW(check_mesh({}, {{0, 1, 2, 3}}), std::invalid_argument);
}

}  // namespace
}  // namespace snowbough::tree
