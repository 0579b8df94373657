#include "tree/crossings/crossings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "native/tree/built_surface.h"
#include "tree/crossings/triangles.h"
#include "tree/crossings/uncrossed_surface.h"
#include "tree/mesh/mesh_check.h"
#include "tree/skeleton/width.h"
#include "tree/surface/limb_path.h"

namespace snowbough::tree {
namespace {

using Pairs = std::vector<std::pair<int32_t, int32_t>>;

constexpr uint32_t kSeeds = 60;

/// Input of surfaces.
struct Plan {
  explicit Plan(const Skeleton& tree)
      : skeleton(tree),
        scale(length_limits(tree)),
        paths(limb_paths(tree, limb_widths(tree, {}), scale)) {}

  Surface build() const {
    return build_surface(skeleton, paths, scale, {}, std::vector<uint8_t>(paths.size(), 0));
  }

  Skeleton skeleton;
  LengthLimits scale;
  std::vector<LimbPath> paths;
};

/// The faces that have a vertex of `vertices`.
std::set<int32_t> faces_at(const Surface& surface, const std::set<int32_t>& vertices) {
  std::set<int32_t> faces;
  for (size_t f = 0; f < surface.quads.size(); ++f) {
    for (const int32_t v : surface.quads[f]) {
      if (vertices.contains(v)) {
        faces.insert(static_cast<int32_t>(f));
      }
    }
  }
  return faces;
}

bool cross_exactly(const Surface& surface, int32_t f, int32_t g) {
  constexpr int kCorners[2][3] = {{0, 1, 2}, {0, 2, 3}};
  const auto triangle = [&](int32_t face, const int* corners) {
    Triangle t;
    for (int k = 0; k < 3; ++k) {
      t[k] = glm::dvec3(glm::vec3(surface.vertices[surface.quads[face][corners[k]]]));
    }
    return t;
  };
  for (const auto& i : kCorners) {
    for (const auto& j : kCorners) {
      std::array<int, 3> shared = {-1, -1, -1};
      for (int k = 0; k < 3; ++k) {
        for (int l = 0; l < 3; ++l) {
          if (surface.quads[f][i[k]] == surface.quads[g][j[l]]) {
            shared[k] = l;
          }
        }
      }
      if (triangles_cross(triangle(f, i), triangle(g, j), shared)) {
        return true;
      }
    }
  }
  return false;
}

/// All pairs near a junction by the exact test alone.
Pairs crossings_by_force(const Surface& surface, const Junction& junction) {
  std::set<int32_t> vertices, faces;
  for (int k = 0; k < 4; ++k) {
    vertices.insert(surface.limbs[junction.parent].rings[junction.row].vertices[k]);
    vertices.insert(surface.limbs[junction.parent].rings[junction.row + 1].vertices[k]);
    vertices.insert(surface.limbs[junction.child].rings[0].vertices[k]);
  }
  for (int step = 0; step < 3; ++step) {
    faces = faces_at(surface, vertices);
    for (const int32_t f : faces) {
      vertices.insert(surface.quads[f].begin(), surface.quads[f].end());
    }
  }
  Pairs pairs;
  for (const int32_t f : faces) {
    for (const int32_t g : faces) {
      if (f < g && cross_exactly(surface, f, g)) {
        pairs.emplace_back(f, g);
      }
    }
  }
  return pairs;
}

TEST(Crossings, AreThoseThatTheExactTestFindsAmongAllPairs) {
  size_t found = 0;
  for (uint32_t seed = 0; seed < 12; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const Surface surface = Plan(RandomSkeleton(seed).make()).build();
    const JunctionCrossings crossings = find_crossings(surface);
    for (size_t j = 0; j < crossings.size(); ++j) {
      ASSERT_EQ(crossings[j], crossings_by_force(surface, surface.junctions[j]))
          << "junction " << j;
      found += crossings[j].size();
    }
  }
  EXPECT_GT(found, 50u);
}

TEST(Crossings, DoNotDependOnTheNumberOfThreads) {
  for (uint32_t seed = 0; seed < kSeeds; ++seed) {
    const Surface surface = Plan(RandomSkeleton(seed).make()).build();
    EXPECT_EQ(find_crossings(surface, {}, 1), find_crossings(surface, {}, 7));
  }
}

TEST(UncrossedSurface, LeavesTheSurfaceClosedAndWhatIsSaidToCrossCrosses) {
  size_t narrowed = 0;
  for (uint32_t seed = 0; seed < kSeeds; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const Plan plan(RandomSkeleton(seed).make());
    const UncrossedSurface uncrossed =
        build_uncrossed_surface(plan.skeleton, plan.paths, plan.scale, {});
    const Surface& surface = uncrossed.surface;
    const MeshCheck check =
        check_mesh({surface.vertices.begin(), surface.vertices.end()}, surface.quads);
    EXPECT_TRUE(check.closed());
    EXPECT_THAT(check.euler, testing::Each(2));
    EXPECT_EQ(check.zero_area_faces, 0);
    const JunctionCrossings crossings = find_crossings(surface);
    for (size_t j = 0; j < crossings.size(); ++j) {
      const int32_t child = uncrossed.surface.junctions[j].child;
      const bool said = std::find(uncrossed.crossing.begin(), uncrossed.crossing.end(), child) !=
                        uncrossed.crossing.end();
      EXPECT_TRUE(!said || !crossings[j].empty()) << "branch " << child;
    }
    narrowed += uncrossed.narrowed.size();
  }
  EXPECT_GT(narrowed, 0u);
}

TEST(UncrossedSurface, TakesNarrowingBackThatAvoidsNothing) {
  size_t crossing = 0, narrowed = 0;
  for (uint32_t seed = 0; seed < kSeeds; ++seed) {
    const Plan plan(RandomSkeleton(seed).make());
    const UncrossedSurface uncrossed =
        build_uncrossed_surface(plan.skeleton, plan.paths, plan.scale, {});
    const std::set<int32_t> thin(uncrossed.narrowed.begin(), uncrossed.narrowed.end());
    for (const int32_t child : uncrossed.crossing) {
      ++crossing;
      narrowed += thin.count(child);
    }
  }
  // Of random trees, whose limbs are crowded; two of three without taking narrowing back.
  EXPECT_LT(static_cast<double>(narrowed), 0.6 * static_cast<double>(crossing));
}

TEST(UncrossedSurface, StopsWhenAsked) {
  const Plan plan(RandomSkeleton(3).make());
  int calls = 0;
  const base::Execution stop_at_third{0, [&](float) { return ++calls < 3; }};
  EXPECT_THROW(build_uncrossed_surface(plan.skeleton, plan.paths, plan.scale, {}, stop_at_third),
               base::Cancelled);
  EXPECT_EQ(calls, 3);
}

}  // namespace
}  // namespace snowbough::tree
