#include "tree/skeleton/skeleton.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "native/tree/skeletons.h"

namespace snowbough::tree {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(CompleteSkeleton, RejectsWhatIsNoSkeleton) {
  const auto error = [](const std::function<void(Branch&)>& spoil) -> std::string {
    Skeleton skeleton;
    skeleton.branches = {tapering("a", {{0, 0, 0}, {0, 0, 1}}, 0.1f)};
    skeleton.branches[0].level = 0;
    spoil(skeleton.branches[0]);
    try {
      complete_skeleton(skeleton);
    } catch (const std::invalid_argument& e) {
      return e.what();
    }
    return "no error";
  };
  EXPECT_EQ(error([](Branch&) {}), "no error");
  EXPECT_THAT(error([](Branch& b) { b.points.clear(); }), HasSubstr("('a') has no points"));
  EXPECT_THAT(error([](Branch& b) { b.radii.pop_back(); }), HasSubstr("as many radii"));
  EXPECT_THAT(error([](Branch& b) { b.areas.pop_back(); }), HasSubstr("as many areas"));
  EXPECT_THAT(error([](Branch& b) { b.radii[0] = -1.0f; }), HasSubstr("negative"));
  EXPECT_THAT(error([](Branch& b) { b.points[0].x = std::numeric_limits<float>::quiet_NaN(); }),
              HasSubstr("not finite"));
  EXPECT_THAT(error([](Branch& b) { b.parent = 0; }), HasSubstr("after its parent"));
  EXPECT_THAT(error([](Branch& b) { b.level = -1; }), HasSubstr("level"));
}

TEST(CompleteSkeleton, MakesNamesUnique) {
  Skeleton skeleton;
  for (const char* name : {"a", "a", "a_2", ""}) {
    skeleton.branches.push_back(tapering(name, {{0, 0, 0}, {0, 0, 1}}, 0.1f));
    skeleton.branches.back().level = 0;
  }
  complete_skeleton(skeleton);
  EXPECT_EQ(skeleton.branches[1].name, "a_3");
  EXPECT_EQ(skeleton.branches[2].name, "a_2");
  EXPECT_EQ(skeleton.branches[3].name, "branch");
}

TEST(CompleteSkeleton, NumbersEqualNamesPastThoseTaken) {
  Skeleton skeleton;
  for (const char* name : {"a", "a", "a", "a_3", "a_2", "a_2", "a"}) {
    skeleton.branches.push_back(tapering(name, {{0, 0, 0}, {0, 0, 1}}, 0.1f));
    skeleton.branches.back().level = 0;
  }
  complete_skeleton(skeleton);
  std::vector<std::string> names;
  for (const Branch& branch : skeleton.branches) names.push_back(branch.name);
  EXPECT_THAT(names, ElementsAre("a", "a_4", "a_5", "a_3", "a_2", "a_2_2", "a_6"));
}

}  // namespace
}  // namespace snowbough::tree
