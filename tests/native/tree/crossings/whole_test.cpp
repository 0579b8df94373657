#include "tree/crossings/whole.h"

#include <gtest/gtest.h>

#include <numeric>
#include <random>

#include "tree/crossings/faces.h"

namespace snowbough::tree {
namespace {

using Pairs = std::vector<std::pair<int32_t, int32_t>>;

/// Quads of all sizes, none of which share a vertex.
struct Scattered {
  std::vector<glm::dvec3> vertices;
  std::vector<Quad> quads;
  std::vector<int32_t> all;

  explicit Scattered(int count) : all(count) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    const auto point = [&] { return glm::dvec3(unit(random), unit(random), 3.0 * unit(random)); };
    for (int i = 0; i < count; ++i) {
      const double size = 0.02 + 0.3 * unit(random) * unit(random) * unit(random);
      const glm::dvec3 at = point(), u = point() * size, v = point() * size;
      const auto first = static_cast<int32_t>(vertices.size());
      for (const glm::dvec3& p : {at, at + u, at + u + v, at + v}) vertices.push_back(p);
      quads.push_back({first, first + 1, first + 2, first + 3});
    }
    std::iota(all.begin(), all.end(), 0);
  }

  /// Every pair by itself.
  Pairs one_by_one() const {
    Pairs found;
    for (const int32_t f : all) {
      const CrossingFace a = make_crossing_face(vertices, quads, f);
      for (int32_t g = f + 1; g < static_cast<int32_t>(quads.size()); ++g) {
        const CrossingFace b = make_crossing_face(vertices, quads, g);
        const bool apart = a.low.x > b.high.x || a.low.y > b.high.y || a.low.z > b.high.z ||
                           b.low.x > a.high.x || b.low.y > a.high.y || b.low.z > a.high.z;
        if (!apart && faces_cross(a, b)) found.emplace_back(f, g);
      }
    }
    return found;
  }
};

TEST(CrossingQuads, AreThoseThatCrossOneByOne) {
  const Scattered scattered(1500);
  const Pairs expected = scattered.one_by_one();
  ASSERT_GT(expected.size(), 50U);
  EXPECT_EQ(crossing_quads(scattered.vertices, scattered.quads, scattered.all), expected);
}

TEST(CrossingQuads, OnlyThoseOfWhichOneHasChanged) {
  const Scattered scattered(1500);
  std::vector<uint8_t> changed(scattered.quads.size(), 0);
  for (size_t f = 0; f < changed.size(); f += 9) changed[f] = 1;
  Pairs expected = scattered.one_by_one();
  std::erase_if(expected,
                [&](const auto& pair) { return !changed[pair.first] && !changed[pair.second]; });
  ASSERT_GT(expected.size(), 10U);
  EXPECT_EQ(crossing_quads(scattered.vertices, scattered.quads, scattered.all, changed), expected);
}

}  // namespace
}  // namespace snowbough::tree
