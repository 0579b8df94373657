#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>
#include <sstream>
#include <string>

#include "tree/read_tree.h"

namespace snowbough::tree {

/// Writes small trees as OBJ text, Z up: a trunk from z = 0 to 8, limbs along x, y.
class TreeText {
 public:
  /// A square tube, or a row of disconnected squares, from `root` in `step`s.
  void limb(glm::vec3 root, glm::vec3 step, int rings, float radius, bool squares) {
    const glm::vec3 side =
        std::abs(step.z) > 0.5f * glm::length(step) ? glm::vec3(1, 0, 0) : glm::vec3(0, 0, 1);
    const glm::vec3 u = glm::normalize(glm::cross(step, side));
    const glm::vec3 w = glm::normalize(glm::cross(step, u));
    const int first = vertices_ + 1;
    for (int i = 0; i < rings; ++i) {
      const float r = radius * (1.0f - 0.8f * i / rings);
      for (const auto& [a, b] : {std::pair(1, 0), {0, 1}, {-1, 0}, {0, -1}}) {
        const glm::vec3 p = root + step * float(i) + r * (float(a) * u + float(b) * w);
        text_ << "v " << p.x << " " << p.y << " " << p.z << "\n";
        ++vertices_;
      }
    }
    for (int i = 0; i < rings; ++i) {
      const int a = first + 4 * i;
      if (squares) {
        text_ << "f " << a << " " << a + 1 << " " << a + 2 << " " << a + 3 << "\n";
        continue;
      }
      for (int c = 0; c < 4 && i + 1 < rings; ++c) {
        text_ << "f " << a + c << " " << a + (c + 1) % 4 << " " << a + 4 + (c + 1) % 4 << " "
              << a + 4 + c << "\n";
      }
    }
  }

  /// A square leaf from `base` along `along`.
  void leaf(glm::vec3 base, glm::vec3 along) {
    for (const glm::vec3& p : {base, base + along + glm::vec3(0, 0, 0.1f), base + 2.0f * along,
                               base + along - glm::vec3(0, 0, 0.1f)}) {
      text_ << "v " << p.x << " " << p.y << " " << p.z << "\nvt " << p.x << " " << p.y << "\n";
    }
    text_ << "f -4/-4 -3/-3 -2/-2 -1/-1\n";
    vertices_ += 4;
  }

  TreeText& line(const std::string& text) {
    text_ << text << "\n";
    return *this;
  }

  /// A trunk and four limbs, each with a twig; `name(level, number)` gives the line before each.
  template <typename Name>
  void tree(bool squares, const Name& name) {
    line(name(0, 1));
    limb({0, 0, 0}, {0, 0, 1}, 9, 0.5f, squares);
    const glm::vec3 ways[] = {{1, 0, 0.2f}, {0, 1, 0.2f}, {-1, 0, 0.2f}, {0, -1, 0.2f}};
    for (int i = 0; i < 4; ++i) {
      line(name(1, i + 1));
      limb({0, 0, 2.5f + i}, 0.5f * ways[i], 6, 0.2f, squares);
    }
    for (int i = 0; i < 4; ++i) {
      line(name(2, i + 1));
      limb(glm::vec3(0, 0, 2.5f + i) + 1.25f * ways[i], {0.02f, 0.01f, 0.3f}, 4, 0.05f, squares);
    }
  }

  std::string text() const { return text_.str(); }

 private:
  std::ostringstream text_;
  int vertices_ = 0;
};

class ReadTree : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        std::filesystem::path(testing::TempDir()) /
        ("read_tree_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& text) {
    const std::string path = (folder_ / name).string();
    std::ofstream(path, std::ios::binary) << text;
    return path;
  }
  Skeleton read(const std::string& text, const ReadTreeOptions& options = {}) {
    return read_tree(write("tree.obj", text), options);
  }
  std::string error_of(const std::string& text, const ReadTreeOptions& options = {}) {
    try {
      read(text, options);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "no error";
  }

  std::filesystem::path folder_;
};

/// The tree of TreeText::tree: nine branches on three levels, every twig on its limb.
inline void expect_tree(const Skeleton& skeleton, const std::string& form) {
  EXPECT_EQ(skeleton.report.form, form);
  EXPECT_EQ(skeleton.report.up_axis, "Z");
  EXPECT_THAT(skeleton.report.branches_per_level, testing::ElementsAre(1, 4, 4));
  EXPECT_THAT(skeleton.report.extra_roots, testing::IsEmpty());
  EXPECT_THAT(skeleton.report.skipped_parts, testing::IsEmpty());
  ASSERT_EQ(skeleton.branches.size(), 9u);
  EXPECT_FLOAT_EQ(skeleton.height, 8.0f);
  EXPECT_EQ(skeleton.branches[0].points.size(), 9u);
  EXPECT_NEAR(skeleton.branches[0].radii[0], 0.5f, 1e-5f);
  EXPECT_NEAR(skeleton.branches[0].areas[0], 0.5f, 1e-5f);
  for (int i = 1; i <= 4; ++i) {
    EXPECT_EQ(skeleton.branches[i].parent, 0);
    EXPECT_LT(glm::distance(skeleton.branches[i].attach_point, glm::vec3(0, 0, 1.5f + i)), 1e-5f);
    EXPECT_EQ(skeleton.branches[4 + i].parent, i);
  }
}

inline std::string numbered(int level, int number) {
  return std::string("g ") +
         (level == 0   ? "trunk"
          : level == 1 ? "branch"
                       : "limb") +
         std::to_string(number);
}

}  // namespace snowbough::tree
