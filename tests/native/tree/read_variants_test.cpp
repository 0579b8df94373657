#include <functional>

#include "native/tree/tree_text.h"

namespace snowbough::tree {
namespace {

/// The lines of a text, each through `change`.
std::string each_line(const std::string& text,
                      const std::function<std::string(const std::string&)>& change) {
  std::istringstream lines(text);
  std::string line, result;
  while (std::getline(lines, line)) {
    result += change(line) + "\n";
  }
  return result;
}

std::string plain_tree() {
  TreeText text;
  text.tree(false, numbered);
  return text.text();
}

void expect_same_skeleton(const Skeleton& skeleton, const Skeleton& plain) {
  ASSERT_EQ(skeleton.branches.size(), plain.branches.size());
  for (size_t b = 0; b < plain.branches.size(); ++b) {
    EXPECT_EQ(skeleton.branches[b].points, plain.branches[b].points) << "branch " << b;
    EXPECT_EQ(skeleton.branches[b].radii, plain.branches[b].radii) << "branch " << b;
    EXPECT_EQ(skeleton.branches[b].parent, plain.branches[b].parent) << "branch " << b;
    EXPECT_EQ(skeleton.branches[b].name, plain.branches[b].name) << "branch " << b;
  }
  EXPECT_EQ(skeleton.report.form, plain.report.form);
  EXPECT_EQ(skeleton.report.warnings, plain.report.warnings);
}

TEST_F(ReadTree, LinesMayEndInCarriageReturns) {
  const std::string text = plain_tree();
  expect_same_skeleton(read(each_line(text, [](const std::string& line) { return line + "\r"; })),
                       read(text));
}

TEST_F(ReadTree, BlanksBeforeBetweenAndAfterWordsMeanNothing) {
  const std::string text = plain_tree();
  const auto spaced = [](const std::string& line) {
    std::string wide = " \t";
    for (const char c : line) {
      wide += c == ' ' ? std::string("  \t") : std::string(1, c);
    }
    return wide + "  ";
  };
  expect_same_skeleton(read(each_line(text, spaced)), read(text));
}

TEST_F(ReadTree, BranchesMayBeObjectsInsteadOfGroups) {
  const auto objects = [](const std::string& line) {
    return line.starts_with("g ") ? std::string("o").append(line, 1) : line;
  };
  expect_same_skeleton(read(each_line(plain_tree(), objects)), read(plain_tree()));
}

TEST_F(ReadTree, NamesMayHoldBlanks) {
  TreeText text;
  text.tree(false, [](int level, int number) {
    const char* const names[] = {"old trunk", "long branch", "thin limb"};
    return std::string("g ") + names[level] + " " + std::to_string(number);
  });
  const Skeleton skeleton = read(text.text());
  expect_tree(skeleton, "TUBES_PER_GROUP");
  EXPECT_EQ(skeleton.branches[0].name, "old trunk 1");
  EXPECT_EQ(skeleton.branches[1].name, "long branch 1");
  EXPECT_EQ(skeleton.branches[8].name, "thin limb 4");
}

TEST_F(ReadTree, LimbsOfNoExtentAreReportedAndTheOthersStay) {
  TreeText text;
  text.tree(false, numbered);
  text.line("g limb5");
  text.limb({1, 0, 3}, {0, 0, 1e-6f}, 3, 0.1f, false);
  text.line("g limb6\nv 1 0 3\nv 1 0 3\nv 1 0 3\nv 1 0 3\nf -4 -3 -2 -1");
  const Skeleton skeleton = read(text.text());
  EXPECT_EQ(skeleton.branches.size(), 9u);
  EXPECT_THAT(skeleton.report.skipped_parts,
              testing::UnorderedElementsAre(testing::Pair("limb5", testing::HasSubstr("a disc")),
                                            testing::Pair("limb6", testing::HasSubstr("plane"))));
}

TEST_F(ReadTree, ALimbThatIsAllOnePointStaysABranch) {
  TreeText text;
  text.tree(false, numbered);
  text.line("g limb5");
  text.limb({0, 0, 3}, {0, 0, 1e-6f}, 3, 0.0f, false);
  EXPECT_EQ(read(text.text()).branches.size(), 10u);
}

}  // namespace
}  // namespace snowbough::tree
