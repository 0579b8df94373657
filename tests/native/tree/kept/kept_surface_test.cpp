#include "tree/kept/kept_surface.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <numeric>
#include <set>
#include <sstream>

#include "native/tree/tree_text.h"
#include "tree/build_tree_mesh.h"
#include "tree/kept/charts.h"
#include "tree/kept/kept_uvs.h"
#include "tree/kept/kept_weights.h"
#include "tree/kept/upright.h"

namespace snowbough::tree {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

class KeptTree : public ReadTree {
 protected:
  Skeleton read_kept(const std::string& text, double height = 0.0) {
    ReadTreeOptions options;
    options.keep_surface = true;
    options.height = height;
    return read(text, options);
  }

  static std::string tubes() {
    TreeText text;
    text.tree(false, numbered);
    return text.text();
  }
};

/// Sum of the weights of the bones of a branch at a vertex.
double weight_of(const VertexWeights& weights, const Bones& bones, size_t vertex, int32_t branch) {
  double sum = 0.0;
  for (int k = 0; k < 4; ++k) {
    if (weights.weights[vertex][k] > 0.0f && bones.branches[weights.indices[vertex][k]] == branch) {
      sum += static_cast<double>(weights.weights[vertex][k]);
    }
  }
  return sum;
}

TEST_F(KeptTree, ItsPolygonsAreThoseOfTheFile) {
  const Skeleton skeleton = read_kept(tubes());
  const KeptSurface& kept = skeleton.kept;
  EXPECT_EQ(kept.vertices.size(), 4u * (9 + 4 * 6 + 4 * 4));
  EXPECT_EQ(kept.face_material.size(), 4u * (8 + 4 * 5 + 4 * 3));
  EXPECT_EQ(kept.vertices[0], glm::vec3(0, 0.5f, 0));
  EXPECT_FALSE(kept.textured);
}

TEST_F(KeptTree, WithoutTheOptionNothingIsKept) {
  EXPECT_THAT(read(tubes()).kept.vertices, IsEmpty());
}

TEST_F(KeptTree, EveryVertexBelongsToTheLimbThatWasTracedThere) {
  const Skeleton skeleton = read_kept(tubes(), 16.0);
  const KeptSurface& kept = skeleton.kept;
  // In the file's order: trunk, four limbs, four twigs; the skeleton has them in the same order.
  const int rings[] = {9, 6, 6, 6, 6, 4, 4, 4, 4};
  size_t vertex = 0;
  for (int32_t branch = 0; branch < 9; ++branch) {
    for (int i = 0; i < 4 * rings[branch]; ++i, ++vertex) {
      ASSERT_EQ(kept.vertex_branch[vertex], branch) << vertex;
    }
  }
  EXPECT_LT(glm::distance(kept.vertex_place[4 * 4], glm::vec3(0, 0, 8)), 1e-5f);  // twice as high
}

/// Sum over a tube's quads of the part of their area vector that points away from the Z axis.
double outward_area(const KeptSurface& kept, size_t faces) {
  double sum = 0.0;
  for (size_t f = 0; f < faces; ++f) {
    const auto place = [&](int c) {
      return kept.vertices[kept.corner_vertex[kept.face_begin[f] + c]];
    };
    const glm::vec3 area = glm::cross(place(2) - place(0), place(3) - place(1));
    sum += double(glm::dot(area, glm::vec3(place(0).x, place(0).y, 0)));
  }
  return sum;
}

TEST_F(KeptTree, TubesThatAreInsideOutAreTurned) {
  const std::string text = tubes();
  std::string turned;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string key, a, b, c, d;
    words >> key >> a >> b >> c >> d;
    turned += key == "f" ? "f " + d + " " + c + " " + b + " " + a + "\n" : line + "\n";
  }
  const double one = outward_area(read_kept(text).kept, 32);
  const double other = outward_area(read_kept(turned).kept, 32);
  EXPECT_GT(one, 0.0);
  EXPECT_NEAR(one, other, 1e-3 * one);
}

TEST_F(KeptTree, NormalsThatContradictThePolygonsAreDropped) {
  std::string text = "vn 0 0 1\nvn 1 0 0\n";
  std::istringstream lines(tubes());
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string key, corner;
    words >> key;
    text += key == "f" ? "f" : line;
    while (key == "f" && words >> corner) text += " " + corner + "//2";
    text += "\n";
  }
  const Skeleton skeleton = read_kept(text);
  EXPECT_THAT(skeleton.kept.corner_normal, IsEmpty());
  EXPECT_THAT(skeleton.report.warnings, testing::Contains(HasSubstr("shaded smooth")));
}

TEST_F(KeptTree, PlanesAcrossLimbsAreNoSurface) {
  TreeText text;
  text.tree(true, numbered);
  ReadTreeOptions options;
  options.keep_surface = true;
  EXPECT_THAT(error_of(text.text(), options), HasSubstr("without Keep Original Surface"));
}

TEST_F(KeptTree, WeightsChangeFromTheParentToTheBranchAndSumToOne) {
  const Skeleton skeleton = read_kept(tubes());
  const Bones bones = build_tree_mesh(skeleton).bones;
  const VertexWeights weights = kept_weights(skeleton, bones, 4);
  for (const auto& row : weights.weights) {
    EXPECT_NEAR(std::accumulate(row.begin(), row.end(), 0.0f), 1.0f, 1e-6f);
  }
  const size_t limb = 4 * 9;
  // The base ring lies in the trunk, of which it has all weights; the tip has none of it.
  for (size_t v = limb; v < limb + 4; ++v) EXPECT_NEAR(weight_of(weights, bones, v, 0), 1.0, 1e-6);
  double before = 0.0;
  for (size_t ring = 0; ring < 6; ++ring) {
    const double own = weight_of(weights, bones, limb + 4 * ring, 1);
    EXPECT_GE(own, before);
    before = own;
  }
  EXPECT_NEAR(before, 1.0, 1e-6);
}

TEST_F(KeptTree, AtAJointHalfOfEachBone) {
  const Skeleton skeleton = read_kept(tubes());
  const Bones bones = build_tree_mesh(skeleton).bones;
  const VertexWeights weights = kept_weights(skeleton, bones, 4);
  // Ring 3 of the trunk, and the bone whose tail is there.
  const size_t vertex = 4 * 3;
  EXPECT_NEAR(weights.weights[vertex][0], 0.5f, 1e-4f);
  EXPECT_NEAR(weights.weights[vertex][1], 0.5f, 1e-4f);
  EXPECT_NEAR(bones.tails[std::min(weights.indices[vertex][0], weights.indices[vertex][1])].z, 3.0f,
              1e-4f);
}

TEST_F(KeptTree, SnowMapCoversEveryPolygonOnce) {
  const Skeleton skeleton = read_kept(tubes());
  const KeptUvs uvs = layout_kept_uvs(skeleton, 512);
  EXPECT_EQ(uvs.resolution, 512);
  const KeptSurface& kept = skeleton.kept;
  // Each texel's centre lies in one polygon at most.
  std::set<std::pair<int, int>> taken;
  double stretch_low = 1e30, stretch_high = 0.0;
  for (size_t f = 0; f < kept.face_material.size(); ++f) {
    const glm::vec2* uv = uvs.snow.data() + kept.face_begin[f];
    double area = 0.0;
    for (int c = 0; c < 4; ++c) {
      const glm::vec2 a = uv[c], b = uv[(c + 1) % 4];
      area += 0.5 * (double(a.x) * b.y - double(b.x) * a.y);
      ASSERT_TRUE(a.x > 0 && a.x < 1 && a.y > 0 && a.y < 1);
    }
    ASSERT_GT(area, 0.0) << f;
    const auto place = [&](int c) {
      return kept.vertices[kept.corner_vertex[kept.face_begin[f] + c]];
    };
    const double real = 0.5 * (glm::length(glm::cross(place(1) - place(0), place(2) - place(0))) +
                               glm::length(glm::cross(place(2) - place(0), place(3) - place(0))));
    stretch_low = std::min(stretch_low, area / real);
    stretch_high = std::max(stretch_high, area / real);
    for (int y = 0; y < 512; ++y) {
      for (int x = 0; x < 512; ++x) {
        const glm::vec2 p((x + 0.5f) / 512, (y + 0.5f) / 512);
        bool inside = true;
        for (int c = 0; c < 4 && inside; ++c) {
          const glm::vec2 a = uv[c], b = uv[(c + 1) % 4];
          inside = (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x) > 0;
        }
        const bool twice = inside && !taken.emplace(x, y).second;
        ASSERT_FALSE(twice) << f;
      }
    }
  }
  EXPECT_LT(stretch_high, 2.0 * stretch_low);
  EXPECT_LE(uvs.chart_count, 2 * 9 * 4);
}

TEST_F(KeptTree, BarkGoesOnceAroundTheLimb) {
  const Skeleton skeleton = read_kept(tubes());
  const KeptUvs uvs = layout_kept_uvs(skeleton, 256);
  const KeptSurface& kept = skeleton.kept;
  double around = 0.0;
  for (size_t f = 0; f < 4; ++f) {  // the trunk's first belt
    const glm::vec2* uv = uvs.bark.data() + kept.face_begin[f];
    around += double(uv[1].x - uv[0].x);
    EXPECT_NEAR(uv[0].y, 0.0, 1e-6);
    EXPECT_NEAR(uv[3].y, 1.0 / (2.0 * M_PI * 0.478), 0.02);
  }
  EXPECT_NEAR(std::abs(around), 1.0, 1e-5);
}

/// Two quads that share the edge from (1, 0) to (1, 1); the second one stands up by `angle`. And a
/// large one far away.
KeptSurface folded(double angle) {
  KeptSurface kept;
  const auto x = static_cast<float>(1.0 + std::cos(angle)), z = static_cast<float>(std::sin(angle));
  kept.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {x, 0, z}, {x, 1, z}};
  for (const auto& [u, v] : {std::pair(0.0f, 0.0f), {5.0f, 0.0f}, {5.0f, 5.0f}, {0.0f, 5.0f}}) {
    kept.vertices.emplace_back(9 + u, v, 0);
  }
  kept.face_begin = {0, 4, 8, 12};
  kept.corner_vertex = {0, 1, 2, 3, 1, 4, 5, 2, 6, 7, 8, 9};
  kept.vertex_branch.assign(10, 0);
  return kept;
}

TEST(KeptCharts, EndWhereTheSurfaceTurnsAway) {
  EXPECT_THAT(grow_charts(folded(0.6)), testing::ElementsAre(0, 0, 1));
  EXPECT_THAT(grow_charts(folded(1.2)), testing::ElementsAre(0, 1, 2));
}

TEST(KeptCharts, EndAtTheNextBranch) {
  KeptSurface kept = folded(0.0);
  kept.vertex_branch[1] = 1;
  EXPECT_THAT(grow_charts(kept), testing::ElementsAre(0, 1, 2));
}

TEST(KeptCharts, HaveAFewPolygonsOfAFineMesh) {
  constexpr int kSide = 20;
  // The large polygon lets charts reach far.
  KeptSurface kept;
  kept.vertices = {{900, 0, 0}, {999, 0, 0}, {999, 99, 0}, {900, 99, 0}};
  kept.face_begin = {0, 4};
  kept.corner_vertex = {0, 1, 2, 3};
  for (int i = 0; i < (kSide + 1) * (kSide + 1); ++i) {
    kept.vertices.emplace_back(i % (kSide + 1), i / (kSide + 1), 0);
  }
  for (int i = 0; i < kSide * kSide; ++i) {
    const int first = 4 + i / kSide * (kSide + 1) + i % kSide;
    for (const int v : {first, first + 1, first + kSide + 2, first + kSide + 1}) {
      kept.corner_vertex.push_back(v);
    }
    kept.face_begin.push_back(static_cast<int32_t>(kept.corner_vertex.size()));
  }
  kept.vertex_branch.assign(kept.vertices.size(), 0);
  std::map<int32_t, int> polygons;
  for (const int32_t chart : grow_charts(kept)) ++polygons[chart];
  for (const auto& [chart, count] : polygons) EXPECT_LE(count, 180) << chart;
  EXPECT_LE(polygons.size(), 9u);
}

/// Two limbs 5 m apart, and a row of polygons without a limb from one to the other.
Skeleton row_between_limbs(int count) {
  Skeleton skeleton;
  for (const float x : {0.0f, 5.0f}) {
    Branch limb;
    limb.points = {{x, 0, 0}, {x, 0, 1}};
    limb.radii = {0.1f, 0.1f};
    limb.piece = static_cast<int32_t>(skeleton.branches.size());
    skeleton.branches.push_back(limb);
  }
  KeptSurface& kept = skeleton.kept;
  for (int i = 0; i <= count; ++i) {
    const float x = 5.0f * static_cast<float>(i) / static_cast<float>(count);
    kept.vertices.insert(kept.vertices.end(), {{x, 0.3f, 0.2f}, {x, 0.3f, 0.8f}});
  }
  kept.face_begin = {0};
  for (int i = 0; i < count; ++i) {
    kept.corner_vertex.insert(kept.corner_vertex.end(), {2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1});
    kept.face_begin.push_back(4 * (i + 1));
  }
  kept.face_material.assign(static_cast<size_t>(count), 0);
  kept.face_part.assign(static_cast<size_t>(count), 2);
  kept.vertex_piece.assign(kept.vertices.size(), -1);
  kept.vertex_limb.assign(kept.vertices.size(), 0);
  attach_kept(skeleton);
  return skeleton;
}

TEST(KeptWood, WithoutALimbMovesAsOneIfItIsSmall) {
  const Skeleton small = row_between_limbs(24);
  EXPECT_EQ(small.kept.vertex_branch.front(), small.kept.vertex_branch.back());
  const Skeleton large = row_between_limbs(25);
  EXPECT_EQ(large.kept.vertex_branch.front(), 0);
  EXPECT_EQ(large.kept.vertex_branch.back(), 1);
}

TEST(KeptWood, WithoutALimbStandsUprightWithItsRadius) {
  // Rings that are higher on one side than on the other.
  std::vector<glm::vec3> points;
  for (int ring = 0; ring <= 8; ++ring) {
    for (const float side : {-1.0f, 1.0f}) points.emplace_back(0.1f * side, 0, ring + 0.4f * side);
  }
  const Branch limb = upright_limb(points, std::vector<char>(points.size(), 1), 2);
  ASSERT_EQ(limb.points.size(), 5u);
  EXPECT_NEAR(limb.points.back().z - limb.points.front().z, 8.8f, 1e-5f);
  for (const float radius : limb.radii) EXPECT_NEAR(radius, 0.1f, 0.05f);
}

}  // namespace
}  // namespace snowbough::tree
