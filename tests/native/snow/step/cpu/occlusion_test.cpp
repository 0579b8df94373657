// Occlusion on the processor: the pixels that a triangle covers, and the triangles that hide
// others.
#include "snow/step/cpu/occlusion/occlusion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/ext/vector_int2_sized.hpp>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>

#include "native/snow/step/cpu/seen.h"
#include "shaders/lib/occlusion_pixel.h"
#include "snow/scene/alpha_mask.h"

namespace snowbough::snow {
namespace {

/// Rows from the top: one letter per triangle in drawing order, lower case where its back is seen.
std::string picture(const Seen& seen, int32_t width) {
  std::string text;
  const auto rows = static_cast<int32_t>(seen.size()) / width;
  for (int32_t y = rows - 1; y >= 0; --y) {
    for (int32_t x = 0; x < width; ++x) {
      const uint32_t triangle = seen[static_cast<size_t>(y * width + x)].triangle;
      const char first = (triangle & shared::kBackFace) != 0 ? 'a' : 'A';
      text +=
          triangle == 0 ? '.' : static_cast<char>(first + static_cast<char>((triangle & 0xFF) - 1));
    }
    text += '\n';
  }
  return text;
}

/// Triangles of all sizes up to `largest` pixels around a square of `width`, depths 0 to 1.
Corners random_triangles(int32_t count, float width, float largest, uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  Corners corners;
  for (int32_t i = 0; i < count; ++i) {
    const float size = largest * std::pow(unit(random), 4.0f);
    const glm::vec2 middle(width * (1.2f * unit(random) - 0.1f),
                           width * (1.2f * unit(random) - 0.1f));
    for (int k = 0; k < 3; ++k) {
      corners.push_back(at(middle.x + size * (unit(random) - 0.5f),
                           middle.y + size * (unit(random) - 0.5f), unit(random)));
    }
  }
  return corners;
}

TEST(CpuOcclusion, ATriangleCoversThePixelsWhoseCentresLieInIt) {
  EXPECT_EQ(picture(seen_of({at(1, 1), at(6, 1), at(1, 6)}, square_of(7)), 7),
            ".......\n"
            ".......\n"
            ".A.....\n"
            ".AA....\n"
            ".AAA...\n"
            ".AAAA..\n"
            ".......\n");
}

TEST(CpuOcclusion, ACentreOnASideBelongsToTheTriangleAtItsRightOrAboveIt) {
  // A square from centre to centre, in two triangles.
  const Corners corners = {at(1.5f, 1.5f), at(4.5f, 1.5f), at(4.5f, 4.5f),
                           at(1.5f, 1.5f), at(4.5f, 4.5f), at(1.5f, 4.5f)};
  EXPECT_EQ(picture(seen_of(corners, square_of(6)), 6),
            "......\n"
            "......\n"
            ".BBA..\n"
            ".BAA..\n"
            ".AAA..\n"
            "......\n");
}

TEST(CpuOcclusion, CornersLieOnStepsOfA256thPixel) {
  // 0.4 / 256 pixel beyond the centre is on it, 0.6 is the next step.
  const auto covered = [](float x) {
    const Corners corners = {at(x, 0), at(3, 0), at(x, 3)};
    return seen_of(corners, square_of(3))[0].triangle != 0;
  };
  EXPECT_TRUE(covered(0.5f + 0.4f / 256.0f));
  EXPECT_FALSE(covered(0.5f + 0.6f / 256.0f));
}

TEST(CpuOcclusion, DepthFollowsThePlaneAndStaysBetweenThoseOfTheCorners) {
  const Seen seen = seen_of({at(0, 0, 1.0f), at(8, 0, 9.0f), at(0, 8, 17.0f)}, square_of(8));
  EXPECT_EQ(seen[0].depth, 1.0f + 0.5f + 1.0f);
  EXPECT_EQ(seen[3].depth, 1.0f + 3.5f + 1.0f);
  EXPECT_EQ(seen[8 * 3].depth, 1.0f + 0.5f + 7.0f);
  for (const shared::SeenPixel& pixel :
       seen_of({at(0, 0, 1.0f), at(700, 1, 2.0f), at(0, 1.3f, 3.0f)}, square_of(64))) {
    if (pixel.triangle == 0) continue;
    EXPECT_GE(pixel.depth, 1.0f);
    EXPECT_LE(pixel.depth, 3.0f);
  }
}

TEST(CpuOcclusion, TheNearerTriangleHidesTheOtherInAnyOrder) {
  const auto level = [](float depth) {
    return Corners{at(0, 0, depth), at(4, 0, depth), at(0, 4, depth)};
  };
  for (const bool near_first : {true, false}) {
    Corners corners = level(near_first ? 1.0f : 2.0f);
    for (const glm::vec4& corner : level(near_first ? 2.0f : 1.0f)) corners.push_back(corner);
    const Seen seen = seen_of(corners, square_of(2));
    EXPECT_EQ(seen[0].triangle, near_first ? 1u : 2u);
    EXPECT_EQ(seen[0].depth, 1.0f);
  }
}

TEST(CpuOcclusion, OfTwoAtTheSameDepthTheFirstDrawnShows) {
  const Corners one = {at(0, 0, 1), at(4, 0, 1), at(0, 4, 1)};
  Corners corners = one;
  corners.insert(corners.end(), one.begin(), one.end());
  EXPECT_EQ(seen_of(corners, square_of(2))[0].triangle, 1u);
  // By the ranges' order, not by number.
  EXPECT_EQ(seen_of(corners, square_of(2), {{1, 1}, {0, 1}})[0].triangle, 2u);
}

TEST(CpuOcclusion, BackFacesOccludeAndAreMarked) {
  const Corners corners = {at(0, 0, 1), at(0, 4, 1), at(4, 0, 1),
                           at(0, 0, 2), at(9, 0, 2), at(0, 9, 2)};
  EXPECT_EQ(picture(seen_of(corners, square_of(6)), 6),
            "BBB...\n"
            "BBBB..\n"
            "BBBBB.\n"
            "aBBBBB\n"
            "aaBBBB\n"
            "aaaBBB\n");
}

TEST(CpuOcclusion, AMaskCutsHoles) {
  // Two texels side by side, the right one a hole; the second triangle is opaque.
  const std::vector<shared::AlphaTriangle> triangles = {{{0, 0}, {1, 0}, {0, 1}, 1, 0},
                                                        {{0, 0}, {1, 0}, {0, 1}, 0, 0}};
  const std::vector<shared::AlphaMaskHeader> masks = {{1, 2, 1, shared::kAlphaRepeat}};
  const std::vector<uint32_t> bits = {0xFFFFFFFFu, 0x1u};
  Corners corners = {at(0, 0, 1), at(6, 0, 1), at(0, 6, 1),   // not drawn
                     at(0, 0, 1), at(6, 0, 1), at(0, 6, 1),   // with holes
                     at(3, 1, 2), at(6, 1, 2), at(3, 4, 2)};  // opaque
  EXPECT_EQ(
      picture(seen_of(corners, square_of(6), {{1, 2, true, -1}}, {triangles, masks, bits}), 6),
      "......\n"
      "B.....\n"
      "BB....\n"
      "BBBC..\n"
      "BBBCC.\n"
      "BBB...\n");
}

TEST(CpuOcclusion, ATriangleFarLargerThanTheTileFillsIt) {
  for (const float reach : {100.0f, 1e4f, 1e6f, 1e7f, 1e12f, 1e30f}) {
    const Seen seen =
        seen_of({at(-reach, -reach, 5), at(3 * reach, -reach, 5), at(-reach, 3 * reach, 5)},
                {{-70, -5}, {70, 60}});
    EXPECT_TRUE(std::all_of(seen.begin(), seen.end(), [](const shared::SeenPixel& pixel) {
      return pixel.triangle == 1 && pixel.depth == 5.0f;
    })) << reach;
  }
}

TEST(CpuOcclusion, HugeAdjacentTrianglesCoverEachPixelOnce) {
  for (const float reach : {1e4f, 1e6f, 1e7f, 1e10f}) {
    const glm::vec4 low = at(-reach, -0.7f * reach);
    const glm::vec4 high = at(1.1f * reach, 0.9f * reach);
    const Corners left = {low, high, at(-reach, 2 * reach)};
    const Corners right = {low, at(reach, -2 * reach), high};
    const PixelRect pixels{{-100, -100}, {100, 100}};
    const Seen a = seen_of(left, pixels);
    const Seen b = seen_of(right, pixels);
    for (size_t i = 0; i < a.size(); ++i) {
      ASSERT_NE(a[i].triangle == 0, b[i].triangle == 0) << reach << " pixel " << i;
    }
  }
}

TEST(CpuOcclusion, AdjacentTrianglesCoverEachPixelOnce) {
  for (const float radius : {3.0f, 30.0f, 100.0f, 3000.0f}) {
    for (uint32_t seed = 0; seed < 8; ++seed) {
      std::mt19937 random(seed);
      std::uniform_real_distribution<float> unit(0.0f, 1.0f);
      // A fan whose rim is a square that the tile lies in or is.
      const float centre = 50.0f + 20.0f * unit(random);
      const glm::vec4 hub = at(centre + radius * 0.3f * unit(random), centre);
      std::vector<glm::vec4> rim;
      for (int side = 0; side < 4; ++side) {
        const glm::vec2 from(side == 0 || side == 3 ? -1.0f : 1.0f, side < 2 ? -1.0f : 1.0f);
        const glm::vec2 way(side == 0   ? 2.0f
                            : side == 2 ? -2.0f
                                        : 0.0f,
                            side == 1   ? 2.0f
                            : side == 3 ? -2.0f
                                        : 0.0f);
        for (float t = 0.0f; t < 1.0f; t += 0.02f + 0.3f * unit(random)) {
          const glm::vec2 p = glm::vec2(centre) + radius * (from + way * t);
          rim.push_back(at(p.x, p.y));
        }
      }
      const PixelRect pixels = square_of(120);
      std::vector<int32_t> times(120 * 120, 0);
      Corners all;
      for (size_t i = 0; i < rim.size(); ++i) {
        const Corners one = {hub, rim[i], rim[(i + 1) % rim.size()]};
        all.insert(all.end(), one.begin(), one.end());
        const Seen seen = seen_of(one, pixels);
        for (size_t k = 0; k < seen.size(); ++k) times[k] += seen[k].triangle != 0;
      }
      const Seen together = seen_of(all, pixels);
      for (size_t k = 0; k < times.size(); ++k) {
        ASSERT_LE(times[k], 1) << "seed " << seed << ", radius " << radius << ", pixel " << k;
        ASSERT_EQ(together[k].triangle != 0, times[k] == 1) << "seed " << seed;
        const float x = static_cast<float>(k % 120) + 0.5f - centre;
        const float y = static_cast<float>(k / 120) + 0.5f - centre;
        if (std::max(std::abs(x), std::abs(y)) < radius - 0.01f) {
          ASSERT_EQ(times[k], 1) << "seed " << seed << ", radius " << radius << ", pixel " << k;
        }
      }
    }
  }
}

/// The same by brute force: tests every triangle at every pixel, with its three sides in 64 bits.
Seen by_brute_force(const Corners& corners, const PixelRect& pixels) {
  const glm::ivec2 size = pixels.size();
  Seen seen(static_cast<size_t>(size.x) * static_cast<size_t>(size.y), {0, shared::kOpenSky});
  for (size_t t = 0; 3 * t < corners.size(); ++t) {
    const glm::vec4* c = &corners[3 * t];
    glm::i64vec2 p[3];
    for (int k = 0; k < 3; ++k) {
      p[k] = {std::llround(std::floor(double{c[k].x} * 256 + 0.5)),
              std::llround(std::floor(double{c[k].y} * 256 + 0.5))};
    }
    const auto cross = [](glm::i64vec2 a, glm::i64vec2 b) { return a.x * b.y - a.y * b.x; };
    const int64_t area = cross(p[1] - p[0], p[2] - p[0]);
    if (area == 0) continue;
    const auto index = static_cast<uint32_t>(t);
    const shared::DepthPlane plane = shared::depth_plane(
        shared::snapped(c[0]), shared::snapped(c[1]), shared::snapped(c[2]), index);
    if (area < 0) std::swap(p[1], p[2]);
    for (int32_t y = pixels.low.y; y < pixels.high.y; ++y) {
      for (int32_t x = pixels.low.x; x < pixels.high.x; ++x) {
        bool inside = true;
        for (int k = 0; k < 3; ++k) {
          const glm::i64vec2 way = p[(k + 1) % 3] - p[k];
          const int64_t side = cross(way, glm::i64vec2(256 * x + 128, 256 * y + 128) - p[k]);
          const bool holds_line = way.y < 0 || (way.y == 0 && way.x > 0);
          inside = inside && (side > 0 || (side == 0 && holds_line));
        }
        if (!inside) continue;
        const float depth = shared::depth_at(static_cast<float>(x) + 0.5f - plane.corner_gradient.x,
                                             static_cast<float>(y) + 0.5f - plane.corner_gradient.y,
                                             plane.corner_gradient, plane.range);
        shared::SeenPixel& pixel =
            seen[static_cast<size_t>(y - pixels.low.y) * static_cast<size_t>(size.x) +
                 static_cast<size_t>(x - pixels.low.x)];
        if (pixel.triangle == 0 || depth < pixel.depth) pixel = {plane.seen, depth};
      }
    }
  }
  return seen;
}

TEST(CpuOcclusion, EqualsTestingEveryTriangleAtEveryPixel) {
  for (uint32_t seed = 0; seed < 6; ++seed) {
    for (const float largest : {4.0f, 40.0f, 400.0f, 30000.0f}) {
      const Corners corners = random_triangles(300, 150.0f, largest, seed);
      const PixelRect pixels{{-13, 5}, {137, 140}};
      EXPECT_TRUE(same_bits(seen_of(corners, pixels), by_brute_force(corners, pixels)))
          << "seed " << seed << ", up to " << largest << " pixels";
    }
  }
}

TEST(CpuOcclusion, IsTheSameFarFromTheGridsOriginAndOnHalfPixels) {
  // Corners on half pixels: every other side meets centres.
  std::mt19937 random(5);
  for (const int32_t origin : {0, 20000, -32768}) {
    Corners corners;
    for (int i = 0; i < 900; ++i) {
      corners.push_back(at(static_cast<float>(origin) + 0.5f * static_cast<float>(random() % 200),
                           static_cast<float>(origin) + 0.5f * static_cast<float>(random() % 200),
                           static_cast<float>(random() % 4)));
    }
    const PixelRect pixels{{origin, origin}, {origin + 100, origin + 100}};
    EXPECT_TRUE(same_bits(seen_of(corners, pixels), by_brute_force(corners, pixels))) << origin;
  }
}

TEST(CpuOcclusion, WhatLiesOutsideOrHasNoAreaShowsNothing) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const Corners corners = {at(-9, 0),      at(-1, 0),        at(-1, 9),   // beside it
                           at(70, 70),     at(90, 70),       at(70, 90),  // beyond it
                           at(1, 1),       at(30, 30),       at(60, 60),  // a line
                           at(5.5f, 5.5f), at(5.5f, 5.5f),   at(5.5f, 5.5f), at(0, 7.5f),
                           at(64, 7.5f),   at(32, 7.5f),  // a level one through centres
                           at(2.6f, 2.6f), at(2.9f, 2.6f),   at(2.6f, 2.9f),  // between centres
                           at(0, 0),       at(kNan, 0),      at(0, 64),      at(0, 0),
                           at(64, 0),      at(0, kInfinity), at(0, 0, kNan), at(64, 0),
                           at(0, 64)};
  for (const shared::SeenPixel& pixel : seen_of(corners, square_of(64))) {
    EXPECT_EQ(pixel.triangle, 0u);
    EXPECT_EQ(pixel.depth, shared::kOpenSky);
  }
}

TEST(CpuOcclusion, APartOfARectangleHasTheBitsOfTheWhole) {
  const Corners corners = random_triangles(3000, 500.0f, 600.0f, 11);
  const PixelRect whole{{-20, -30}, {517, 490}};
  const Seen all = seen_of(corners, whole);
  for (const PixelRect& part : {PixelRect{{100, 50}, {101, 51}}, PixelRect{{-20, -30}, {77, 99}},
                                PixelRect{{33, 11}, {410, 213}}, PixelRect{{400, 0}, {517, 490}}}) {
    const Seen own = seen_of(corners, part);
    const glm::ivec2 size = part.size();
    for (int32_t y = 0; y < size.y; ++y) {
      const auto* row = &all[static_cast<size_t>((part.low.y + y - whole.low.y) * whole.size().x +
                                                 part.low.x - whole.low.x)];
      ASSERT_EQ(0, std::memcmp(row, &own[static_cast<size_t>(y * size.x)],
                               static_cast<size_t>(size.x) * sizeof *row))
          << "row " << y << " of " << size.x << " x " << size.y;
    }
  }
}

TEST(CpuOcclusion, ThreadsAndRoomForBinsChangeNoBit) {
  const Corners corners = random_triangles(4000, 300.0f, 400.0f, 3);
  // Ranges that are not in the order of numbers, one of them empty.
  const std::vector<TriangleRange> ranges = {{3000, 1000}, {0, 0}, {1000, 2000}, {0, 1000}};
  const Seen one = seen_of(corners, square_of(300), ranges, {}, {1});
  for (const int32_t threads : {2, 3, 7, 16}) {
    EXPECT_TRUE(same_bits(one, seen_of(corners, square_of(300), ranges, {}, {threads}))) << threads;
  }
  for (const int64_t most_entries : {1, 50, 3000}) {
    EXPECT_TRUE(same_bits(one, seen_of(corners, square_of(300), ranges, {}, {2, most_entries})))
        << most_entries;
  }
}

TEST(CpuOcclusion, APassIsUsedAgainForOtherRectangles) {
  const Corners corners = random_triangles(500, 300.0f, 100.0f, 3);
  const std::vector<TriangleRange> ranges = {{0, 500}};
  cpu::OcclusionPass pass;
  for (const int32_t size : {300, 20, 150}) {
    Seen seen(static_cast<size_t>(size) * static_cast<size_t>(size), {9u, 9.0f});
    pass.run({corners, ranges, {}}, square_of(size), seen);
    EXPECT_TRUE(same_bits(seen, seen_of(corners, square_of(size)))) << size;
  }
}

TEST(CpuOcclusion, RefusesABufferOfTheWrongSize) {
  Seen seen(99);
  EXPECT_THROW(cpu::OcclusionPass().run({}, square_of(10), seen), std::invalid_argument);
  EXPECT_THROW(cpu::OcclusionPass().run({}, {}, {}), std::invalid_argument);
  seen.resize(20000);
  EXPECT_THROW(cpu::OcclusionPass().run({}, {{0, 0}, {20000, 1}}, seen), std::invalid_argument);
  EXPECT_NO_THROW(cpu::OcclusionPass().run({}, {{0, 0}, {100, 200}}, seen));
  EXPECT_EQ(seen[7].triangle, 0u);
}

}  // namespace
}  // namespace snowbough::snow
