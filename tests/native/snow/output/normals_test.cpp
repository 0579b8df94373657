#include "snow/output/normals.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <glm/mat2x2.hpp>

#include "native/snow/layouts.h"

namespace snowbough::snow {
namespace {

/// A square metre in the plane z = 0 whose layout is `change` applied to (x, y).
LaidOutMesh laid_out_square(const glm::mat2& change, glm::vec2 origin) {
  LaidOutMesh mesh;
  mesh.topology.resolution = 128;
  mesh.topology.vertex_count = 4;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.topology.triangles = {0, 1, 2, 0, 2, 3};
  for (const int32_t v : mesh.topology.triangles) {
    mesh.topology.corner_uv.push_back(origin + change * glm::vec2(mesh.positions[v]));
  }
  return mesh;
}

/// The normals of the height `slope . (x, y) + 1`, turned back from tangent space to the world.
std::vector<glm::vec3> world_normals(const glm::mat2& change, glm::vec2 origin, glm::vec2 slope) {
  const LaidOutMesh mesh = laid_out_square(change, origin);
  const TexelTable table = build_texel_table(mesh.topology);
  const SeamTable seams = build_seam_table(mesh.topology, table, mesh.positions);
  const glm::mat2 back = glm::inverse(change);
  std::vector<float> height;
  for (const int32_t texel : table.texel) {
    const glm::vec2 uv = glm::vec2(texel % 128 + 0.5f, texel / 128 + 0.5f) / 128.0f;
    height.push_back(3.0f + glm::dot(slope, back * (uv - origin)));
  }
  const auto normals =
      normals_on_cpu(table, seams, surface_metrics(mesh.topology, mesh.positions), height);
  // MikkTSpace: tangent = dP/du, bitangent = sign * cross(normal, tangent).
  const glm::vec3 tangent = glm::normalize(glm::vec3(back[0], 0.0f));
  const float sign = glm::determinant(change) < 0.0f ? -1.0f : 1.0f;
  const glm::vec3 bitangent = sign * glm::cross(glm::vec3(0, 0, 1), tangent);
  std::vector<glm::vec3> world;
  for (size_t i = 0; i < normals.size(); ++i) {
    if (table.coverage[i] < 1.0f) continue;
    const glm::vec3 n = normals[i];
    world.push_back(n.x * tangent + n.y * bitangent + n.z * glm::vec3(0, 0, 1));
  }
  return world;
}

void expect_all_near(const std::vector<glm::vec3>& normals, glm::vec3 expected) {
  ASSERT_GT(normals.size(), 500u);
  for (const glm::vec3 n : normals)
    ASSERT_LT(glm::length(n - expected), 2e-3f) << n.x << " " << n.y << " " << n.z;
}

const glm::vec2 kSlope(0.5f, -0.25f);

TEST(Normals, ofASlopeInAStraightLayout) {
  expect_all_near(world_normals(glm::mat2(0.8f, 0, 0, 0.8f), {0.1f, 0.1f}, kSlope),
                  glm::normalize(glm::vec3(-0.5f, 0.25f, 1)));
}

TEST(Normals, ofASlopeInATurnedLayout) {
  expect_all_near(world_normals(glm::mat2(0.0f, 0.8f, -0.8f, 0.0f), {0.9f, 0.1f}, kSlope),
                  glm::normalize(glm::vec3(-0.5f, 0.25f, 1)));
}

TEST(Normals, ofASlopeInAShearedAndStretchedLayout) {
  expect_all_near(world_normals(glm::mat2(0.4f, 0.1f, 0.3f, 0.7f), {0.1f, 0.1f}, kSlope),
                  glm::normalize(glm::vec3(-0.5f, 0.25f, 1)));
}

TEST(Normals, ofASlopeInAMirroredLayout) {
  expect_all_near(world_normals(glm::mat2(-0.8f, 0, 0, 0.8f), {0.9f, 0.1f}, kSlope),
                  glm::normalize(glm::vec3(-0.5f, 0.25f, 1)));
}

TEST(Normals, ofALevelBlanketPointOutwards) {
  expect_all_near(world_normals(glm::mat2(0.4f, 0.1f, 0.3f, 0.7f), {0.1f, 0.1f}, {0, 0}),
                  {0, 0, 1});
}

TEST(Normals, goOnAcrossASeam) {
  // Heights that rise evenly around a tube: no normal may notice the cut.
  const LaidOutMesh mesh = cylinder(48, 16, 0.5f, 2.0f, 256);
  const TexelTable table = build_texel_table(mesh.topology);
  const SeamTable seams = build_seam_table(mesh.topology, table, mesh.positions);
  std::vector<float> height;
  for (const int32_t texel : table.texel) {
    const float angle =
        6.2831853f * ((static_cast<float>(texel % 256) + 0.5f) / 256.0f - 0.1f) / 0.8f;
    height.push_back(1.0f + 0.1f * std::sin(angle));
  }
  const auto normals =
      normals_on_cpu(table, seams, surface_metrics(mesh.topology, mesh.positions), height);
  for (size_t i = 0; i < normals.size(); ++i) {
    const float angle =
        6.2831853f * ((static_cast<float>(table.texel[i] % 256) + 0.5f) / 256.0f - 0.1f) / 0.8f;
    const glm::vec3 expected = glm::normalize(glm::vec3(-0.2f * std::cos(angle), 0.0f, 1.0f));
    ASSERT_LT(glm::length(normals[i] - expected), 6e-3f) << "column " << table.texel[i] % 256;
  }
}

}  // namespace
}  // namespace snowbough::snow
