#include "tree/surface/crotch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>

#include "native/tree/built_surface.h"
#include "tree/build_tree_mesh.h"

namespace snowbough::tree {
namespace {

constexpr double kDegrees = M_PI / 180.0;

/// A stem of 4 m that leaves a trunk at 5 m, `angle` degrees from it, turned around it.
Branch stem(float radius, double angle, double around = 0.0) {
  const double sine = std::sin(angle * kDegrees);
  const glm::dvec3 way(sine * std::cos(around * kDegrees), sine * std::sin(around * kDegrees),
                       std::cos(angle * kDegrees));
  std::vector<glm::vec3> points;
  for (int i = 0; i <= 8; ++i) points.emplace_back(glm::dvec3(0.0, 0.0, 5.0) + way * (0.5 * i));
  return make_branch(0, 1, points, std::vector<float>(points.size(), radius));
}

std::optional<Crotch> crotch_of(const Branch& child) {
  const Skeleton skeleton = make_skeleton({trunk(0.2f), child});
  const LengthLimits scale = length_limits(skeleton);
  const std::vector<LimbPath> paths = limb_paths(skeleton, limb_widths(skeleton, {}), scale);
  return find_crotch(PathSearch(paths[0]), 5.0, paths[1], scale);
}

/// Area of a mesh in the plane through `centre`, of all that is nearer to it than `reach`.
double section_area(const TreeMesh& mesh, const glm::dvec3& centre, const glm::dvec3& normal,
                    double reach) {
  glm::dvec3 area(0.0);
  for (const Quad& quad : mesh.quads) {
    for (const std::array<int, 3>& corners : {std::array{0, 1, 2}, std::array{0, 2, 3}}) {
      glm::dvec3 enters(0.0), leaves(0.0);
      bool crosses = false;
      for (int k = 0; k < 3; ++k) {
        const glm::dvec3 a(mesh.vertices[quad[corners[k]]]);
        const glm::dvec3 b(mesh.vertices[quad[corners[(k + 1) % 3]]]);
        const double below = glm::dot(a - centre, normal), above = glm::dot(b - centre, normal);
        if ((below < 0.0) == (above < 0.0)) continue;
        (below < 0.0 ? enters : leaves) = a + (b - a) * (below / (below - above));
        crosses = true;
      }
      if (!crosses || glm::distance(0.5 * (enters + leaves), centre) > reach) continue;
      area += 0.5 * glm::cross(enters - centre, leaves - centre);
    }
  }
  return std::abs(glm::dot(area, normal));
}

/// Area that a trunk and its stem cover together in the plane `s` metres above their fork.
double covered_area(double radius, double child_radius, double angle, double s) {
  const double cosine = std::cos(angle * kDegrees);
  const double aside = s * std::tan(angle * kDegrees);
  constexpr int kCells = 400;
  const double cell = 4.0 * (radius + child_radius + aside) / kCells;
  int covered = 0;
  for (int i = 0; i < kCells; ++i) {
    for (int j = 0; j < kCells; ++j) {
      const double x = (i - kCells / 2) * cell, y = (j - kCells / 2) * cell;
      const double across = (x - aside) * cosine;
      const bool in_trunk = x * x + y * y < radius * radius;
      // The stem's own beginning is inside the trunk.
      const bool in_stem = across * across + y * y < child_radius * child_radius && s > 0.0;
      covered += in_trunk || in_stem ? 1 : 0;
    }
  }
  return covered * cell * cell;
}

/// Smallest area of a fork relative to that of its two limbs (of the trunk alone for the four-sided
/// base, whose faces run straight from heel to stem): in planes across the trunk from half a metre
/// below on, and across each limb from where the fillet between them ends.
double neck(const TreeMesh& mesh, double radius, double child_radius, double angle, bool is_round) {
  const glm::dvec3 up(0.0, 0.0, 1.0), fork(0.0, 0.0, 5.0);
  const glm::dvec3 way(std::sin(angle * kDegrees), 0.0, std::cos(angle * kDegrees));
  double least = 1e300;
  for (double s = -0.5; s < 3.0; s += 0.05) {
    const double both = section_area(mesh, fork + up * s, up, 1e300);
    least = std::min(least, both / (is_round ? covered_area(radius, child_radius, angle, s)
                                             : M_PI * radius * radius));
    const double apart = s * std::sin(angle * kDegrees);
    if (apart < radius + 2.0 * child_radius) continue;
    const double trunk_area = section_area(mesh, fork + up * s, up, apart - child_radius);
    const double stem_area = section_area(mesh, fork + way * s, way, apart - radius);
    least = std::min({least, trunk_area / (M_PI * radius * radius),
                      stem_area / (M_PI * child_radius * child_radius)});
  }
  return least;
}

/// Places along a stem, of `radius` at `angle` from a trunk of 0.2 m, at which its outer (-1) or
/// inner (1) side passes the trunk's surface; and the height there.
double passes(double radius, double angle, double side) {
  return (0.2 + side * radius * std::cos(angle * kDegrees)) / std::sin(angle * kDegrees);
}

double height(double radius, double angle, double side) {
  return 5.0 + passes(radius, angle, side) * std::cos(angle * kDegrees) +
         side * radius * std::sin(angle * kDegrees);
}

TEST(Crotch, GoesFromTheChildsOuterSideToItsInnerSide) {
  const std::optional<Crotch> crotch = crotch_of(stem(0.16f, 25.0));
  ASSERT_TRUE(crotch);
  EXPECT_NEAR(crotch->child_heel, passes(0.16, 25.0, -1.0), 2e-3);
  EXPECT_NEAR(crotch->parent_heel, height(0.16, 25.0, -1.0), 2e-3);
  EXPECT_NEAR(crotch->child_end, passes(0.16, 25.0, 1.0), 2e-3);
  EXPECT_NEAR(crotch->parent_end, height(0.16, 25.0, 1.0), 2e-3);
}

TEST(Crotch, OfStemsSideBySideBeginsLate) {
  const std::optional<Crotch> crotch = crotch_of(stem(0.2f, 7.0));
  ASSERT_TRUE(crotch);
  EXPECT_NEAR(crotch->parent_end, height(0.2, 7.0, 1.0), 5e-3);
  EXPECT_GT(crotch->parent_heel, 6.5);
}

TEST(Crotch, UpToTheHeelALimbHasTheAreaOfTheStemBesideIt) {
  const Skeleton skeleton = make_skeleton({trunk(0.2f), stem(0.2f, 7.0)});
  const LengthLimits scale = length_limits(skeleton);
  const std::vector<LimbPath> paths = limb_paths(skeleton, limb_widths(skeleton, {}), scale);
  const LimbPath joined = join_stems(skeleton, paths, scale)[0];
  const std::optional<Crotch> crotch = crotch_of(skeleton.branches[1]);
  ASSERT_TRUE(crotch);
  const double corner = corner_at(joined, nearest_length(joined, {0.1, 0.0, crotch->parent_heel}));
  const double both = covered_area(0.2, 0.2, 7.0, crotch->parent_heel - 5.0);
  EXPECT_GT(both, 1.4 * M_PI * 0.2 * 0.2);
  EXPECT_NEAR(2.0 * corner * corner, both, 0.05 * both);
  // Bones stay on the limb's own centreline.
  EXPECT_NEAR(joined.bone_lengths.back(), 10.0, 1e-6);
  EXPECT_NEAR(corner_at(joined, 4.0), corner_at(paths[0], 4.0), 1e-6);
}

TEST(Crotch, IsNotOfTwigsAndOfBranchesThatLeaveAtWideAngles) {
  EXPECT_FALSE(crotch_of(stem(0.05f, 25.0)));
  EXPECT_FALSE(crotch_of(stem(0.2f, 50.0)));
}

TEST(Crotch, IsNotOfAChildThatStaysInsideItsParent) {
  EXPECT_FALSE(
      crotch_of(make_branch(0, 1, {{0, 0, 5}, {0.1f, 0, 6}, {0.1f, 0, 8}}, {0.15f, 0.15f, 0.15f})));
}

TEST(Crotch, OfThreeStemsTheNearestTwoSeparateLast) {
  const Skeleton skeleton = make_skeleton({trunk(0.2f), stem(0.18f, 20.0), stem(0.18f, 20.0, 40.0),
                                           stem(0.18f, 20.0, 180.0), stem(0.05f, 20.0, 30.0)});
  const LengthLimits scale = length_limits(skeleton);
  const std::vector<LimbPath> paths = limb_paths(skeleton, limb_widths(skeleton, {}), scale);
  EXPECT_EQ(surface_parents(skeleton, paths, scale), (std::vector<int32_t>{-1, 0, 1, 0, 0}));
}

TEST(Crotch, KeepsBothLimbsWidthAtAllLevels) {
  for (const double angle : {15.0, 25.0, 40.0}) {
    for (const float radius : {0.14f, 0.17f, 0.2f}) {
      const Skeleton skeleton = make_skeleton({trunk(0.2f), stem(radius, angle)});
      for (const std::optional<Detail>& detail :
           {std::optional<Detail>(), std::optional(Detail::kGame),
            std::optional(Detail::kDefault)}) {
        TreeMeshOptions options;
        options.detail = detail;
        const TreeMesh mesh = build_tree_mesh(skeleton, options);
        EXPECT_GE(neck(mesh, 0.2, radius, angle, detail.has_value()), 0.9)
            << angle << " degrees, " << radius << " m, level " << (detail ? int(*detail) : -1);
        EXPECT_TRUE(mesh.warnings.empty());
        const MeshCheck check = check_mesh(mesh.vertices, mesh.quads);
        EXPECT_TRUE(check.closed());
        EXPECT_EQ(check.euler, std::vector<int32_t>{2});
        for (const std::array<float, 4>& weights : mesh.bone_weights) {
          EXPECT_NEAR(std::accumulate(weights.begin(), weights.end(), 0.0), 1.0, 1e-6);
        }
      }
    }
  }
}

TEST(Crotch, OfThreeEqualStemsIsSharedByAll) {
  // Seen from the trunk, which leans away, the other two are 60 degrees apart.
  Branch leaning = trunk(0.2f);
  const glm::dvec3 way(std::sin(14.0 * kDegrees), 0.0, std::cos(14.0 * kDegrees));
  for (glm::vec3& p : leaning.points) {
    if (p.z > 5.0f) p = glm::vec3(glm::dvec3(0.0, 0.0, 5.0) + way * (p.z - 5.0));
  }
  const Skeleton skeleton =
      make_skeleton({leaning, stem(0.19f, 14.0, 120.0), stem(0.19f, 14.0, 240.0)});
  const Built built = build(skeleton);
  ASSERT_EQ(built.surface.junctions.size(), 2u);
  EXPECT_EQ(built.surface.junctions[0].row, built.surface.junctions[1].row);
  TreeMeshOptions options;
  options.detail = Detail::kDefault;
  const TreeMesh mesh = build_tree_mesh(skeleton, options);
  EXPECT_TRUE(mesh.warnings.empty());
  const MeshCheck check = check_mesh(mesh.vertices, mesh.quads);
  EXPECT_TRUE(check.closed());
  EXPECT_EQ(check.euler, std::vector<int32_t>{2});
  const glm::dvec3 up(0.0, 0.0, 1.0);
  for (double s = -0.5; s < 0.2; s += 0.05) {
    // Where three stems hardly separate they are together no thicker than one by a fifth.
    const double area = section_area(mesh, glm::dvec3(0.0, 0.0, 5.0) + up * s, up, 1e300);
    EXPECT_LT(area, 1.2 * 1.2 * M_PI * 0.2 * 0.2) << s;
    EXPECT_GT(area, 0.9 * M_PI * 0.2 * 0.2) << s;
  }
}

TEST(Crotch, NarrowsNoStemAsThickAsItsParent) {
  Branch tapering = trunk(0.2f);
  for (size_t i = 0; i < tapering.points.size(); ++i) {
    tapering.radii[i] = 0.2f - 0.015f * static_cast<float>(i);
    tapering.areas[i] = static_cast<float>(M_PI) * tapering.radii[i] * tapering.radii[i];
  }
  const TreeMesh mesh = build_tree_mesh(make_skeleton({tapering, stem(0.13f, 30.0)}));
  EXPECT_TRUE(mesh.warnings.empty());
}

TEST(Knuckle, WidensToAChildThickerThanItsParent) {
  // At a right angle: not a second stem.
  const Skeleton skeleton = make_skeleton(
      {trunk(0.2f), make_branch(0, 1, {{0, 0, 5}, {1, 0, 5}, {3, 0, 5}}, {0.25f, 0.25f, 0.25f})});
  const TreeMesh mesh = build_tree_mesh(skeleton);
  EXPECT_TRUE(mesh.warnings.empty());
}

}  // namespace
}  // namespace snowbough::tree
