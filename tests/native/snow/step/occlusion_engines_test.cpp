// Occlusion on the processor and in OpenGL gives the same result.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "gpu/gl_context.h"
#include "gpu/gpu_thread.h"
#include "native/snow/bench.h"
#include "native/snow/step/cpu/seen.h"

namespace snowbough::snow {
namespace {

/// A sphere around the origin whose vertices are moved at random by up to `jitter`.
SceneObject sphere(int32_t around, float radius, float jitter, uint32_t seed) {
  SceneObject object;
  object.description.name = "sphere";
  object.description.receive = false;
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> shift(-jitter, jitter);
  const int32_t rings = around / 2;
  for (int32_t ring = 0; ring <= rings; ++ring) {
    for (int32_t i = 0; i < around; ++i) {
      const float turn = 6.2831853f * static_cast<float>(i) / static_cast<float>(around);
      const float rise = 3.1415927f * static_cast<float>(ring) / static_cast<float>(rings);
      object.positions.push_back(radius * glm::vec3(std::sin(rise) * std::cos(turn),
                                                    std::sin(rise) * std::sin(turn),
                                                    std::cos(rise)) +
                                 glm::vec3(shift(random), shift(random), shift(random)));
    }
  }
  for (int32_t ring = 0; ring < rings; ++ring) {
    for (int32_t i = 0; i < around; ++i) {
      const int32_t a = ring * around + i;
      const int32_t b = ring * around + (i + 1) % around;
      object.description.topology.triangles.insert(object.description.topology.triangles.end(),
                                                   {a, a + around, b, b, a + around, b + around});
    }
  }
  for (const glm::vec3& position : object.positions) object.bounds.include(glm::dvec3(position));
  object.description.topology.vertex_count = static_cast<int32_t>(object.positions.size());
  return object;
}

/// Triangles of all sizes and directions in a box of 2 m, each with corners of its own.
SceneObject litter(int32_t count, uint32_t seed) {
  SceneObject object;
  object.description.name = "litter";
  object.description.receive = false;
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> place(-1.0f, 1.0f);
  for (int32_t i = 0; i < count; ++i) {
    const glm::vec3 middle(place(random), place(random), place(random));
    const float size = 0.01f + 0.4f * std::pow(std::abs(place(random)), 12.0f);
    for (int32_t k = 0; k < 3; ++k) {
      object.description.topology.triangles.push_back(3 * i + k);
      object.positions.push_back(middle +
                                 size * glm::vec3(place(random), place(random), place(random)));
      object.bounds.include(glm::dvec3(object.positions.back()));
    }
  }
  object.description.topology.vertex_count = 3 * count;
  return object;
}

TrianglesSetUp set_up_bench(const Bench& bench) {
  std::vector<glm::vec3> positions;
  for (const SceneObject& object : bench.objects) {
    positions.insert(positions.end(), object.positions.begin(), object.positions.end());
  }
  return set_up(positions, bench.scene.triangles.read_all<shared::SceneTriangle>(), bench.frame);
}

/// Fraction of the pixels of the bench's tile in which the engines differ: another triangle, or a
/// depth that differs by more than 1e-5 of its range.
double share_of_others(const Bench& bench, const Seen& by_gl, const Seen& by_cpu) {
  EXPECT_EQ(by_gl.size(), by_cpu.size());
  size_t shown = 0;
  size_t others = 0;
  for (size_t i = 0; i < by_gl.size(); ++i) {
    shown += by_cpu[i].triangle != 0;
    others +=
        by_gl[i].triangle != by_cpu[i].triangle ||
        std::abs(by_gl[i].depth - by_cpu[i].depth) * shared::one_over_depth(bench.frame) > 1e-5f;
  }
  EXPECT_GT(shown, by_gl.size() / 10);
  return static_cast<double>(others) / static_cast<double>(by_gl.size());
}

TEST(CpuOcclusion, IsWhatThePassesInOpenGLFind) {
  gpu::GpuThread::shared()->run([] {
    for (const bool is_litter : {false, true}) {
      for (const double pixel_size : {0.03, 0.004, 0.0015}) {
        const Bench bench(objects_of(is_litter ? litter(20000, 1) : sphere(200, 0.8f, 0.01f, 2),
                                     square("ground", 2.0f, -1.0f, 64, false)),
                          falling({0.3, -0.2, -1.0}, pixel_size));
        const TrianglesSetUp made = set_up_bench(bench);
        const auto corners = bench.scene.triangle_corners.read_all<glm::vec4>();
        const auto surface = bench.scene.triangle_surface.read_all<glm::vec4>();
        // A graphics card need not round divisions correctly: 1.6 times the limits of a software
        // renderer on an NVIDIA H100.
        const float rounding = gpu::renders_in_software() ? 1.0f : 3.0f;
        for (size_t i = 0; i < corners.size(); ++i) {
          ASSERT_NEAR(made.corners[i].x, corners[i].x, 1e-3f) << i;
          ASSERT_NEAR(made.corners[i].y, corners[i].y, 1e-3f) << i;
          ASSERT_NEAR(made.corners[i].z, corners[i].z, 1e-6f) << i;
          ASSERT_NEAR(made.corners[i].w, corners[i].w,
                      rounding * 1e-4f * (0.1f + std::abs(corners[i].w)))
              << i;
        }
        for (size_t i = 0; i < surface.size(); ++i) {
          ASSERT_NEAR(made.surface[i].x, surface[i].x, 1e-5f) << i;
          ASSERT_NEAR(made.surface[i].y, surface[i].y, rounding * 1e-5f * surface[i].y) << i;
          ASSERT_NEAR(made.surface[i].z, surface[i].z, 1e-5f) << i;
        }
        const PixelRect pixels = bench.tiles.front().pixels;
        EXPECT_LE(share_of_others(bench, bench.visible(), seen_of(made.corners, pixels)), 1e-4)
            << pixel_size;
        // The corners are equal, so only OpenGL's rounding of depths differs.
        EXPECT_LE(share_of_others(bench, bench.visible(), seen_of(corners, pixels)), 1e-5)
            << pixel_size;
      }
    }
  });
}

TEST(CpuOcclusion, CutsTheHolesThatThePassInOpenGLCuts) {
  gpu::GpuThread::shared()->run([] {
    SceneObject object = litter(3000, 4);
    std::mt19937 random(9);
    std::uniform_real_distribution<float> unit(-1.5f, 2.5f);
    ObjectAlpha& alpha = object.description.alpha;
    for (const uint32_t extension :
         {shared::kAlphaRepeat, shared::kAlphaMirror, shared::kAlphaExtend, shared::kAlphaClip}) {
      std::vector<uint8_t> image(7 * 11);
      for (uint8_t& texel : image) texel = static_cast<uint8_t>(random() & 255);
      alpha.masks.push_back(
          std::make_shared<const AlphaMask>(make_alpha_mask(7, 11, extension, image)));
    }
    for (int32_t i = 0; i < 3000; ++i) {
      alpha.mask.push_back(i % 5 - 1);
      for (int k = 0; k < 3; ++k) alpha.corner_uv.emplace_back(unit(random), unit(random));
    }
    Bench bench(objects_of(std::move(object), square("ground", 2.0f, -1.0f, 64, false)),
                falling({0.1, 0.2, -1.0}, 0.004));
    const std::vector<TriangleRange> ranges = {{0, 3000, true, 0}, {3000, 2}};
    OcclusionPass().run(bench.scene, bench.projection, bench.tiles.front(), ranges, bench.target);
    const auto triangles = bench.scene.alpha_triangles.read_all<shared::AlphaTriangle>();
    const auto masks = bench.scene.alpha_headers.read_all<shared::AlphaMaskHeader>();
    const auto bits = bench.scene.alpha_bits.read_all<uint32_t>();
    const Seen by_cpu = seen_of(set_up_bench(bench).corners, bench.tiles.front().pixels, ranges,
                                {triangles, masks, bits});
    EXPECT_LE(share_of_others(bench, bench.visible(), by_cpu), 1e-4);
    EXPECT_FALSE(
        same_bits(by_cpu, seen_of(set_up_bench(bench).corners, bench.tiles.front().pixels)));
  });
}

TEST(CpuOcclusion, CoversThePixelsThatOpenGLCoversWhereSidesMeetCentres) {
  gpu::GpuThread::shared()->run([] {
    Bench bench(objects_of(litter(400, 1)), falling({0, 0, -1}, 0.01));
    const PixelRect pixels = bench.tiles.front().pixels;
    std::mt19937 random(5);
    Corners corners;
    for (int i = 0; i < 1200; ++i) {
      const auto half = [&](int32_t low) {
        return static_cast<float>(low) + 0.5f * static_cast<float>(random() % 400);
      };
      const float x = half(pixels.low.x);
      corners.push_back(at(x, half(pixels.low.y), 0.002f * static_cast<float>(i / 3)));
    }
    bench.scene.triangle_corners.write(0, static_cast<int64_t>(corners.size() * 16),
                                       corners.data());
    OcclusionPass().run(bench.scene, bench.projection, bench.tiles.front(), {{0, 400}},
                        bench.target);
    const Seen by_gl = bench.visible();
    const Seen by_cpu = seen_of(corners, pixels);
    for (size_t i = 0; i < by_gl.size(); ++i) {
      ASSERT_EQ(by_gl[i].triangle, by_cpu[i].triangle) << "pixel " << i;
    }
  });
}

}  // namespace
}  // namespace snowbough::snow
