#include "snow/surface/refine.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "native/snow/surface/shapes.h"

namespace snowbough::snow {
namespace {

constexpr float kDepth = 0.12f;

/// The refined mesh of a receiver under that map.
SurfaceMesh refined(const SurfaceSource& source, const std::vector<float>& map,
                    int32_t most_points = 200000, float scale = 1.0f) {
  const RimmedMesh receiver(source, 1.15f * rim_zone(kDepth), far_zone(kDepth), rim_strip(kDepth));
  const RimZones zones(receiver.mesh, receiver.rims, kDepth);
  return refined_surface(receiver.mesh, receiver.rims, zones,
                         {map.data(), map.data(), nullptr, kResolution},
                         {kDepth, scale, most_points})
      .mesh;
}

SurfaceMesh snowy_slab(int32_t most_points = 200000) {
  const SurfaceSource source = slab(1.0f, 0.3f);
  return refined(source, on_tops(source, kDepth), most_points);
}

TEST(RefinedSurface, HasAtMostTwoFacesAtAnEdge) {
  for (const int32_t count : faces_at_edges(surface_edges(snowy_slab().triangle)))
    EXPECT_LE(count, 2);
}

TEST(RefinedSurface, HasNoFacesWithoutArea) {
  const SurfaceMesh mesh = snowy_slab();
  for (size_t t = 0; t < mesh.triangle.size(); ++t) {
    float longest = 0.0f;
    for (size_t k = 0; k < 3; ++k) {
      longest = std::max(longest, glm::distance(mesh.position[mesh.triangle[t][k]],
                                                mesh.position[mesh.triangle[t][(k + 1) % 3]]));
    }
    EXPECT_GT(glm::length(triangle_cross(mesh, t)), 1e-3f * longest * longest);
  }
}

TEST(RefinedSurface, FacesAtUvSeamsSharePoints) {
  const SurfaceMesh mesh = snowy_slab();
  std::map<int32_t, std::set<int32_t>> charts;  // of each point
  for (size_t t = 0; t < mesh.triangle.size(); ++t) {
    for (const int32_t p : mesh.triangle[t]) charts[p].insert(mesh.base[t] / 2);
  }
  int at_rim = 0;
  for (const auto& [p, own] : charts) {
    const glm::vec3& at = mesh.position[p];
    if (at.z < -1e-6f || std::max(std::abs(at.x), std::abs(at.y)) < 0.5f) continue;
    ++at_rim;
    EXPECT_GE(own.size(), 2u);
  }
  EXPECT_GT(at_rim, 40);
  std::set<std::array<float, 3>> places;
  for (const glm::vec3& at : mesh.position) EXPECT_TRUE(places.insert({at.x, at.y, at.z}).second);
}

TEST(RefinedSurface, CutsRunParallelToAStraightRim) {
  const SurfaceMesh mesh = snowy_slab();
  // Points on top near the middle of the rim at x = 0.5, by their distance in hundredths of a
  // millimetre.
  std::map<int, int> rows;
  for (const glm::vec3& at : mesh.position) {
    const float distance = 0.5f - at.x;
    if (std::abs(at.y) > 0.2f || at.z < -1e-6f || distance > 0.9f * rim_zone(kDepth)) continue;
    ++rows[static_cast<int>(std::lround(distance * 1e5f))];
  }
  int in_rows = 0, all = 0;
  for (const auto& [distance, count] : rows) {
    all += count;
    if (count >= 8) in_rows += count;
  }
  EXPECT_GT(all, 200);
  EXPECT_GT(in_rows, 0.95 * all);
}

TEST(RefinedSurface, IsCoarseOnOpenGround) {
  const SurfaceSource source = card(8.0f, 8.0f);
  const SurfaceMesh mesh = refined(source, map_of(source, {kDepth}));
  for (size_t t = 0; t < mesh.triangle.size(); ++t) {
    const glm::vec3 middle =
        (mesh.position[mesh.triangle[t][0]] + mesh.position[mesh.triangle[t][1]] +
         mesh.position[mesh.triangle[t][2]]) /
        3.0f;
    if (std::max(std::abs(middle.x), std::abs(middle.y)) > 3.0f) continue;
    EXPECT_GT(0.5f * glm::length(triangle_cross(mesh, t)), 0.02f * kDepth * kDepth);
  }
  EXPECT_NEAR(area_of(mesh), 64.0f, 1e-3f);
}

TEST(RefinedSurface, IsFineWhereSnowEndsOnGround) {
  const SurfaceSource source = card(8.0f, 8.0f);
  std::vector<float> map(kResolution * kResolution, 0.0f);
  for (size_t i = 0; i < map.size(); ++i)
    map[i] = i % kResolution < kResolution / 2 ? kDepth : 0.0f;
  const SurfaceMesh mesh = refined(source, map);
  float least_at_border = 1.0f, least_in_the_open = 1.0f;
  for (size_t t = 0; t < mesh.triangle.size(); ++t) {
    const glm::vec3& at = mesh.position[mesh.triangle[t][0]];
    if (std::abs(at.y) > 3.0f || at.x < -3.0f) continue;
    float& least = at.x > -0.2f ? least_at_border : least_in_the_open;
    least = std::min(least, glm::length(triangle_cross(mesh, t)));
  }
  EXPECT_LT(4.0f * least_at_border, least_in_the_open);
}

TEST(RefinedSurface, CutsLongNarrowFacesAcross) {
  constexpr int32_t kSides = 12;
  std::vector<glm::vec3> positions;
  std::vector<std::array<int32_t, 4>> faces;
  for (int32_t i = 0; i < kSides; ++i) {
    const float turn = 6.2831853f * static_cast<float>(i) / kSides;
    for (const float x : {-0.6f, 0.6f}) {
      positions.emplace_back(x, 0.01f * std::cos(turn), 0.01f * std::sin(turn));
    }
    const int32_t next = (i + 1) % kSides;
    faces.push_back({2 * i, 2 * next, 2 * next + 1, 2 * i + 1});
  }
  const SurfaceSource rod = quads(positions, faces);
  // Halves of 1.2 m down to 9.4 mm make 129 rings; halves of diagonals would make ten times as many
  // points.
  const SurfaceMesh mesh = refined(rod, map_of(rod, std::vector<float>(kSides, kDepth)));
  EXPECT_LE(mesh.position.size(), kSides * 129u * 5u / 4u);
  EXPECT_GE(mesh.position.size(), kSides * 33u);
}

TEST(RefinedSurface, LeavesOutWhatIsNeverCovered) {
  const SurfaceSource source = card(8.0f, 8.0f);
  std::vector<float> map(kResolution * kResolution, 0.0f);
  for (size_t i = 0; i < map.size(); ++i)
    map[i] = i % kResolution < kResolution / 4 ? kDepth : 0.0f;
  for (const glm::vec3& at : refined(source, map).position) EXPECT_LT(at.x, 0.5f);
}

/// Longest side of the triangles that touch the rims of a slab of that size.
float longest_at_rim(const SurfaceMesh& mesh, float size) {
  const auto is_at_rim = [&](int32_t p) {
    const glm::vec3& at = mesh.position[p];
    return at.z > -1e-6f && std::max(std::abs(at.x), std::abs(at.y)) > 0.5f * size - 1e-6f;
  };
  float longest = 0.0f;
  for (const auto& triangle : mesh.triangle) {
    for (size_t k = 0; k < 3; ++k) {
      const int32_t p = triangle[k], q = triangle[(k + 1) % 3];
      if (is_at_rim(p) && is_at_rim(q))
        longest = std::max(longest, glm::distance(mesh.position[p], mesh.position[q]));
    }
  }
  return longest;
}

TEST(RefinedSurface, HasNoLongEdgeAtAHemHoweverFewPointsLevelGroundGets) {
  const SurfaceSource source = slab(6.0f, 0.3f);
  const std::vector<float> map = on_tops(source, kDepth);
  const SurfaceMesh plenty = refined(source, map);
  const auto most = static_cast<int32_t>(plenty.position.size() * 4 / 5);
  const SurfaceMesh few = refined(source, map, most);
  EXPECT_LE(longest_at_rim(plenty, 6.0f), 0.15f * kDepth);
  EXPECT_LE(longest_at_rim(few, 6.0f), 0.15f * kDepth);
  EXPECT_LE(few.position.size(), static_cast<size_t>(most));
}

TEST(RefinedSurface, SaysHowMuchCoarserItsHemsAre) {
  const SurfaceSource source = slab(1.0f, 0.3f);
  const std::vector<float> map = on_tops(source, kDepth);
  const RimmedMesh receiver(source, 1.15f * rim_zone(kDepth), far_zone(kDepth), rim_strip(kDepth));
  const RimZones zones(receiver.mesh, receiver.rims, kDepth);
  const auto coarsened = [&](int32_t most_points) {
    return refined_surface(receiver.mesh, receiver.rims, zones,
                           {map.data(), map.data(), nullptr, kResolution},
                           {kDepth, 1.0f, most_points})
        .coarsened;
  };
  EXPECT_EQ(coarsened(200000), 1.0f);
  EXPECT_GT(coarsened(1000), 1.3f);
}

TEST(WantedPoints, AreFewForAWiperAndManyForARoof) {
  const auto sum = [](const PointCounts& counts) { return counts.hems + counts.level; };
  const double wiper = sum(wanted_points(boxes({{{0, 0, 0}, {0.5f, 0.02f, 0.01f}}}), kDepth));
  const double roof = sum(wanted_points(slab(4.0f, 0.3f), kDepth));
  EXPECT_LT(wiper, 3000.0);
  EXPECT_GT(roof, 10.0 * wiper);
}

/// What a receiver takes under a full cover, as a share of what it is estimated to want.
double taken_of_wanted(const SurfaceSource& source) {
  const PointCounts wanted = wanted_points(source, kDepth);
  const std::vector<float> map = on_tops(source, kDepth);
  const auto taken = static_cast<double>(refined(source, map, 1000000).position.size());
  return taken / (wanted.hems + wanted.level);
}

TEST(WantedPoints, AreNearlyThoseThatACoverTakes) {
  std::vector<Box> slats, stones;
  for (int i = 0; i < 9; ++i) {
    const float y = 0.11f * static_cast<float>(i);
    slats.push_back({{0, y, 0}, {1.5f, y + 0.095f, 0.03f}});
  }
  for (int i = 0; i < 16; ++i) {
    const float x = 0.61f * static_cast<float>(i % 4);
    const float y = 0.61f * static_cast<float>(i / 4);
    stones.push_back({{x, y, 0}, {x + 0.6f, y + 0.6f, 0.04f}});
  }
  EXPECT_NEAR(taken_of_wanted(boxes({{{0, 0, 0}, {0.5f, 0.02f, 0.01f}}})), 1.0, 0.4);
  EXPECT_NEAR(taken_of_wanted(boxes(slats)), 1.0, 0.4);
  EXPECT_NEAR(taken_of_wanted(boxes(stones)), 1.0, 0.4);
  EXPECT_NEAR(taken_of_wanted(slab(1.0f, 0.3f)), 1.0, 0.4);
}

TEST(WantedPoints, OfASheetDoNotDependOnItsSide) {
  SurfaceSource sheet = card(2.0f, 2.0f);
  const PointCounts positive = wanted_points(sheet, kDepth);
  std::vector<int32_t>& corner = sheet.topology.triangles;
  for (size_t i = 0; i < corner.size(); i += 3) std::swap(corner[i], corner[i + 1]);
  const PointCounts back = wanted_points(sheet, kDepth);
  EXPECT_GT(back.hems, 0.0);
  EXPECT_NEAR(back.hems / positive.hems, 1.0, 0.1);
}

TEST(WantedPoints, AreMostlyLevelOnGround) {
  const PointCounts counts = wanted_points(card(8.0f, 8.0f), kDepth);
  EXPECT_GT(counts.level, 2.0 * counts.hems);
  // Halved edges are shorter than wanted: two points for each square of that size. Those with edges
  // of two depths count among the hems.
  const double square = kDepth * kDepth;
  EXPECT_NEAR(counts.level, 2.0 * 64.0 / square * (1.0 / (0.45 * 0.45) - 0.25), 1.0);
}

}  // namespace
}  // namespace snowbough::snow
