#include "tree/tubes/patch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <glm/vec2.hpp>
#include <map>
#include <stdexcept>
#include <utility>
#include <vector>

namespace snowbough::tree {
namespace {

using Place = PatchVertex::Place;
using testing::SizeIs;

/// A vertex as one number, the same for a corner whichever edge names it.
int key(const PatchVertex& vertex, const PatchCuts& cuts) {
  const int i = vertex.index;
  switch (vertex.place) {
    case Place::kLow:
      return i == 0 ? 1 : i == cuts.low ? 2 : 100 + i;
    case Place::kRight:
      return i == 0 ? 2 : i == cuts.right ? 3 : 200 + i;
    case Place::kHigh:
      return i == cuts.high ? 3 : i == 0 ? 4 : 300 + i;
    case Place::kLeft:
      return i == 0 ? 1 : i == cuts.left ? 4 : 400 + i;
    default:
      return 1000 + i;
  }
}

glm::dvec2 place(const PatchVertex& vertex, const PatchCuts& cuts, const Patch& patch) {
  const double i = vertex.index;
  switch (vertex.place) {
    case Place::kLow:
      return {i / cuts.low, 0.0};
    case Place::kRight:
      return {1.0, i / cuts.right};
    case Place::kHigh:
      return {i / cuts.high, 1.0};
    case Place::kLeft:
      return {0.0, i / cuts.left};
    default: {
      const Patch::Inside& inside = patch.inside[vertex.index];
      return {static_cast<double>(inside.step) / inside.steps,
              static_cast<double>(inside.line) / cuts.strips()};
    }
  }
}

/// All patches that the levels of detail may ask for, and more.
std::vector<PatchCuts> all_cuts() {
  std::vector<PatchCuts> all;
  for (const int low : {1, 2, 4, 8}) {
    for (const int high : {1, 2, 4, 8}) {
      for (int strips = std::max(1, halvings(low, high)); strips < 6; ++strips) {
        const int more = strips + (is_odd(low, high) ? 1 : 0);
        for (int plain = 0; plain == 0 || plain + halvings(low, high) <= strips; ++plain) {
          all.push_back({low, more, high, strips, plain});
          all.push_back({low, strips, high, more, plain});
        }
      }
    }
  }
  return all;
}

TEST(Patch, EveryPieceOfItsEdgesBelongsToOneQuadAndEveryEdgeInsideToTwo) {
  for (const PatchCuts& cuts : all_cuts()) {
    Patch patch;
    cut_patch(cuts, patch);
    std::map<std::pair<int, int>, int> edges;
    for (const auto& quad : patch.quads) {
      for (int k = 0; k < 4; ++k) {
        ++edges[{key(quad[k], cuts), key(quad[(k + 1) % 4], cuts)}];
      }
    }
    int border = 0;
    for (const auto& [edge, count] : edges) {
      EXPECT_EQ(count, 1) << "two quads run along an edge in one direction";
      border += edges.count({edge.second, edge.first}) == 0;
    }
    EXPECT_EQ(border, cuts.low + cuts.right + cuts.high + cuts.left);
    // Of a disc: corners - edges + faces = 1.
    const auto vertices = static_cast<int>(patch.inside.size()) + border;
    const auto both = (static_cast<int>(edges.size()) + border) / 2;
    EXPECT_EQ(vertices - both + static_cast<int>(patch.quads.size()), 1);
  }
}

TEST(Patch, EveryQuadHasAnAreaAndBothItsTrianglesToo) {
  for (const PatchCuts& cuts : all_cuts()) {
    Patch patch;
    cut_patch(cuts, patch);
    double sum = 0.0;
    for (const auto& quad : patch.quads) {
      std::array<glm::dvec2, 4> p;
      for (int k = 0; k < 4; ++k) p[k] = place(quad[k], cuts, patch);
      const auto area = [&](int a, int b, int c) {
        const glm::dvec2 u = p[b] - p[a], v = p[c] - p[a];
        return 0.5 * (u.x * v.y - u.y * v.x);
      };
      EXPECT_GT(area(0, 1, 2), 1e-6);
      EXPECT_GT(area(0, 2, 3), 1e-6);
      sum += area(0, 1, 2) + area(0, 2, 3);
    }
    EXPECT_NEAR(sum, 1.0, 1e-9);
  }
}

TEST(Patch, QuadsAreCountedWithoutBeingMade) {
  for (const PatchCuts& cuts : all_cuts()) {
    Patch patch;
    cut_patch(cuts, patch);
    EXPECT_THAT(patch.quads, SizeIs(count_quads(cuts)));
  }
}

TEST(Patch, SidesChangeTheirNumberAfterPlainStrips) {
  const auto across = [](const PatchCuts& cuts) {
    std::vector<int> all;
    for (int level = 0; level <= cuts.strips(); ++level) all.push_back(quads_across(cuts, level));
    return all;
  };
  EXPECT_THAT(across({4, 5, 1, 5, 0}), testing::ElementsAre(4, 4, 4, 4, 2, 1));
  EXPECT_THAT(across({4, 5, 1, 5, 2}), testing::ElementsAre(4, 4, 2, 1, 1, 1));
  EXPECT_THAT(across({1, 5, 4, 5, 1}), testing::ElementsAre(1, 1, 2, 4, 4, 4));
  Patch patch;
  EXPECT_THROW(cut_patch({4, 3, 2, 3, 3}, patch), std::invalid_argument);
}

TEST(Patch, EdgesThatDoNotFitAreRefused) {
  Patch patch;
  EXPECT_THROW(cut_patch({1, 1, 2, 1}, patch), std::invalid_argument);
  EXPECT_THROW(cut_patch({8, 1, 2, 1}, patch), std::invalid_argument);
  EXPECT_THROW(cut_patch({3, 1, 3, 1}, patch), std::invalid_argument);
  EXPECT_THROW(cut_patch({2, 2, 2, 1}, patch), std::invalid_argument);
}

}  // namespace
}  // namespace snowbough::tree
