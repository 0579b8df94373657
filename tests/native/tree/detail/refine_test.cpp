
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numeric>
#include <string>

#include "native/tree/built_surface.h"
#include "support/chart_measure.h"
#include "tree/build_tree_mesh.h"
#include "tree/crossings/whole.h"

namespace snowbough::tree {
namespace {

using testing::Each;
using testing::SizeIs;

constexpr Detail kAll[] = {Detail::kDraft, Detail::kGame, Detail::kDefault, Detail::kFilm};

TreeMesh build_at(const Skeleton& skeleton, Detail detail, int threads = 0) {
  TreeMeshOptions options;
  options.detail = detail;
  options.threads = threads;
  return build_tree_mesh(skeleton, options);
}

Skeleton bent_chain() {
  std::vector<glm::vec3> points;
  std::vector<float> radii;
  for (int i = 0; i <= 12; ++i) {
    const float angle = 0.2f * static_cast<float>(i);
    points.emplace_back(3.0f - 3.0f * std::cos(angle), 0.0f, 3.0f * std::sin(angle));
    radii.push_back(0.3f - 0.02f * static_cast<float>(i));
  }
  return make_skeleton({make_branch(-1, 0, points, radii)});
}

Skeleton thick_child() {
  return make_skeleton({trunk(0.1f), side_branch(5.5f, 0.3f, {0.7f, 0.0f, 0.7f})});
}

Skeleton without_thickness() {
  Branch stem = trunk(0.0f);
  return make_skeleton({stem, side_branch(5.5f, 0.0f), side_branch(5.5f, 0.0f, {-1, 0, 0})});
}

/// Trees that are hard to refine.
std::map<std::string, Skeleton> odd_trees() {
  return {{"chain", bent_chain()},
          {"fork", make_skeleton({trunk(), side_branch(5.5f, 0.1f)})},
          {"slanted fork", make_skeleton({trunk(), side_branch(5.5f, 0.1f, {0.4f, 0.0f, 0.9f})})},
          {"as wide as its parent", make_skeleton({trunk(), side_branch(5.5f, 0.2f)})},
          {"whorl of four", whorl(4)},
          {"whorl of eight", whorl(8)},
          {"thicker than its parent", thick_child()},
          {"no thickness", without_thickness()}};
}

void expect_closed(const Skeleton& skeleton, Detail detail, const std::string& name) {
  const TreeMesh mesh = build_at(skeleton, detail);
  const MeshCheck check = check_mesh(mesh.vertices, mesh.quads);
  int roots = 0;
  for (const Branch& branch : skeleton.branches) roots += branch.parent < 0;
  EXPECT_TRUE(check.closed() && check.winding_ok) << name;
  EXPECT_THAT(check.euler, SizeIs(roots)) << name;
  EXPECT_THAT(check.euler, Each(2)) << name;
  EXPECT_EQ(check.unused_vertices, 0) << name;
  for (const glm::vec3& p : mesh.vertices) {
    ASSERT_TRUE(std::isfinite(p.x + p.y + p.z)) << name;
  }
}

TEST(Refine, ClosedAtEveryLevelOfDetail) {
  for (const auto& [name, skeleton] : odd_trees()) {
    for (const Detail detail : kAll) expect_closed(skeleton, detail, name);
  }
}

TEST(Refine, ClosedWhateverTheSkeletonLooksLike) {
  for (uint32_t seed = 1; seed <= 9; ++seed) {
    const Skeleton skeleton = RandomSkeleton(seed).make();
    expect_closed(skeleton, kAll[seed % 3], "seed " + std::to_string(seed));
  }
}

TEST(Refine, WeightsSumToOne) {
  for (const auto& [name, skeleton] : odd_trees()) {
    const TreeMesh mesh = build_at(skeleton, Detail::kDefault);
    ASSERT_THAT(mesh.bone_weights, SizeIs(mesh.vertices.size()));
    for (const auto& w : mesh.bone_weights) {
      ASSERT_NEAR(w[0] + w[1] + w[2] + w[3], 1.0f, 1e-6f) << name;
    }
  }
}

TEST(Refine, SnowUvsStayApartAndEveryFaceHasAnArea) {
  for (const auto& [name, skeleton] : odd_trees()) {
    for (const Detail detail : kAll) {
      const TreeMesh mesh = build_at(skeleton, detail);
      UvSurface surface;
      surface.vertices = mesh.vertices;
      for (size_t f = 0; f < mesh.quads.size(); ++f) {
        for (int k = 0; k < 4; ++k) {
          surface.corner_vertex.push_back(mesh.quads[f][k]);
          surface.corner_uv.push_back(mesh.uv_snow[f][k]);
        }
      }
      const UvLayoutMeasure layout = measure_uv_layout(surface, 1024);
      EXPECT_EQ(layout.overlap_texels, 0) << name;
      EXPECT_EQ(layout.outside_faces, 0) << name;
      EXPECT_GT(layout.min_face_area, 0.0) << name;
    }
  }
}

TEST(Refine, TheSameBitsTwiceAndWithAnyThreads) {
  const Skeleton skeleton = RandomSkeleton(7).make();
  const TreeMesh one = build_at(skeleton, Detail::kDefault, 1);
  for (const int threads : {1, 3}) {
    const TreeMesh other = build_at(skeleton, Detail::kDefault, threads);
    EXPECT_EQ(one.vertices, other.vertices);
    EXPECT_EQ(one.quads, other.quads);
    EXPECT_EQ(one.uv_snow, other.uv_snow);
    EXPECT_EQ(one.bone_weights, other.bone_weights);
  }
}

TEST(Refine, SidesFollowThickness) {
  const Skeleton skeleton = make_skeleton({trunk(), side_branch(5.5f, 0.002f)});
  const TreeMesh mesh = build_at(skeleton, Detail::kDefault);
  const auto cap = [&](int32_t branch, FacePart part) {
    return std::count_if(mesh.origins.begin(), mesh.origins.end(), [&](const FaceOrigin& origin) {
      return origin.branch == branch && origin.part == part;
    });
  };
  // A cap of n sides along each of its four edges has n x n faces.
  EXPECT_EQ(cap(0, FacePart::kRootCap), 16);
  EXPECT_EQ(cap(1, FacePart::kTipCap), 1);
}

TEST(Refine, ForksOfLimbsWithFourSidesCutTheirParentNoFiner) {
  // Both are thin, so that Draft gives them four sides; the child is a third as thick, so that one
  // of its sides is a third as long as the row that it leaves from.
  const Skeleton skeleton = make_skeleton({trunk(0.001f), side_branch(5.5f, 0.0003f)});
  const TreeMesh base = build_tree_mesh(skeleton);
  const TreeMesh draft = build_at(skeleton, Detail::kDraft);
  EXPECT_EQ(draft.quads.size(), base.quads.size());
}

/// Unit normals of the faces, across their diagonals.
std::vector<glm::dvec3> normals(const TreeMesh& mesh) {
  std::vector<glm::dvec3> result;
  for (const Quad& quad : mesh.quads) {
    const auto p = [&](int k) { return glm::dvec3(mesh.vertices[quad[k]]); };
    result.push_back(glm::normalize(glm::cross(p(2) - p(0), p(3) - p(1))));
  }
  return result;
}

/// The largest angle in degrees between two faces over the edges from corner k of face f on that
/// counts(f, k) accepts, and the number of pairs of faces.
template <typename Counts>
std::pair<double, size_t> most_turned(const TreeMesh& mesh, const Counts& counts) {
  const std::vector<glm::dvec3> normal = normals(mesh);
  std::map<std::pair<int32_t, int32_t>, size_t> edges;
  double most = 0.0;
  size_t pairs = 0;
  for (size_t f = 0; f < mesh.quads.size(); ++f) {
    for (int k = 0; k < 4; ++k) {
      if (!counts(f, k)) continue;
      const auto edge = std::minmax(mesh.quads[f][k], mesh.quads[f][(k + 1) % 4]);
      const auto [other, first] = edges.emplace(edge, f);
      if (first) continue;
      most = std::max(most, std::acos(std::min(1.0, glm::dot(normal[f], normal[other->second]))));
      ++pairs;
    }
  }
  return {most * 180.0 / M_PI, pairs};
}

TEST(Refine, ALimbThatBendsSmoothlyTurnsByLessThan25DegreesFromFaceToFace) {
  const TreeMesh mesh = build_at(bent_chain(), Detail::kDefault);
  const auto [degrees, pairs] = most_turned(mesh, [&](size_t f, int k) {
    // Edges across the limb: bark's v does not change.
    return mesh.origins[f].part == FacePart::kWall &&
           std::abs(mesh.uv_bark[f][k].y - mesh.uv_bark[f][(k + 1) % 4].y) <= 1e-5f;
  });
  EXPECT_GT(pairs, 100u);
  EXPECT_LT(degrees, 25.0);
}

TEST(Refine, AForkHasNoSharpCrease) {
  const Skeleton skeleton = make_skeleton({trunk(), side_branch(5.5f, 0.1f)});
  const TreeMesh mesh = build_at(skeleton, Detail::kFilm);
  const auto [degrees, pairs] = most_turned(mesh, [&](size_t f, int) {
    const FacePart part = mesh.origins[f].part;
    return part != FacePart::kTipCap && part != FacePart::kRootCap;
  });
  EXPECT_GT(pairs, 100u);
  // Without a fillet it is a right angle.
  EXPECT_LT(degrees, 45.0);
}

TEST(Refine, TheFilletIsAsWideAsTheThinnerLimb) {
  const Skeleton skeleton = make_skeleton({trunk(), side_branch(5.5f, 0.1f)});
  const TreeMesh mesh = build_at(skeleton, Detail::kFilm);
  // Above the child, on its middle plane: where the trunk's side begins to lean outwards.
  double begin = 0.0, off = 0.0;
  for (const glm::vec3& p : mesh.vertices) {
    if (p.x < 0.19f || std::abs(p.y) > 0.03f || p.z < 5.5f) continue;
    const double from_trunk = std::hypot(p.x, p.y) - 0.2;
    const double from_child = std::hypot(p.y, p.z - 5.5) - 0.1;
    if (from_trunk > 0.002) begin = std::max(begin, from_child);
    off = std::max(off, std::min(from_trunk, from_child));
  }
  EXPECT_GT(begin, 0.05);
  EXPECT_LT(begin, 0.11);
  // In the corner between both the surface stands clear of either.
  EXPECT_GT(off, 0.015);
}

TEST(Refine, AForkDoesNotCrossItself) {
  for (const glm::vec3 direction :
       {glm::vec3(1, 0, 0), glm::vec3(0.8f, 0, 0.6f), glm::vec3(0.45f, 0, 0.9f)}) {
    const Skeleton skeleton = make_skeleton({trunk(), side_branch(5.5f, 0.1f, direction)});
    for (const Detail detail : kAll) {
      const TreeMesh mesh = build_at(skeleton, detail);
      Surface surface;
      surface.vertices.assign(mesh.vertices.begin(), mesh.vertices.end());
      surface.quads = mesh.quads;
      std::vector<int32_t> all(mesh.quads.size());
      std::iota(all.begin(), all.end(), 0);
      EXPECT_THAT(crossing_quads(surface.vertices, surface.quads, all), SizeIs(0));
    }
  }
}

TEST(Refine, StopsWhereverItIsAskedTo) {
  const Skeleton skeleton = make_skeleton({trunk(), side_branch(5.5f, 0.02f)});
  size_t places = 0;
  TreeMeshOptions options;
  options.threads = 1;
  options.detail = Detail::kDefault;
  options.progress = [&](float) { return ++places > 0; };
  build_tree_mesh(skeleton, options);
  for (size_t place = 0; place < places; ++place) {
    size_t calls = 0;
    options.progress = [&](float) { return calls++ < place; };
    EXPECT_THROW(build_tree_mesh(skeleton, options), base::Cancelled) << "place " << place;
    EXPECT_EQ(calls, place + 1) << "it went on after the answer";
  }
}

}  // namespace
}  // namespace snowbough::tree
