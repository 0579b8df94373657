#pragma once

#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "tree/skeleton/skeleton.h"

namespace snowbough::tree {

inline Branch make_branch(int32_t parent, int32_t level, std::vector<glm::vec3> points,
                          std::vector<float> radii) {
  Branch branch;
  branch.parent = parent;
  branch.level = level;
  branch.attach_point = points.front();
  branch.points = std::move(points);
  branch.radii = std::move(radii);
  for (float radius : branch.radii) {
    branch.areas.push_back(static_cast<float>(M_PI) * radius * radius);
  }
  return branch;
}

inline Skeleton make_skeleton(std::vector<Branch> branches) {
  Skeleton skeleton;
  skeleton.branches = std::move(branches);
  for (size_t b = 0; b < skeleton.branches.size(); ++b) {
    skeleton.branches[b].name = std::string("b").append(std::to_string(b));
  }
  complete_skeleton(skeleton);
  return skeleton;
}

/// A straight trunk of 10 m along Z with a ring every metre.
inline Branch trunk(float radius = 0.2f) {
  std::vector<glm::vec3> points;
  for (int i = 0; i <= 10; ++i) {
    points.emplace_back(0.0f, 0.0f, static_cast<float>(i));
  }
  return make_branch(-1, 0, points, std::vector<float>(points.size(), radius));
}

/// Anything a skeleton may hold: up to eight children at one point, children thicker than their
/// parent, zero-length segments, points that return, right-angle and backward bends, branches of
/// one segment or one point, no thickness at all.
class RandomSkeleton {
 public:
  explicit RandomSkeleton(uint32_t seed) : random_(seed) {}

  Skeleton make() {
    const int wanted = 1 + whole(60);
    add(-1, 0, {0.0f, 0.0f, 0.0f}, {0.0f, 0.0f, 1.0f}, 0.02f + 0.2f * unit());
    if (chance(0.2)) {
      add(-1, 0, {5.0f, 0.0f, 0.0f}, {0.0f, 0.0f, 1.0f}, 0.1f);
    }
    for (size_t parent = 0;
         parent < branches_.size() && static_cast<int>(branches_.size()) < wanted; ++parent) {
      for (int places = whole(4); places > 0; --places) {
        add_children(static_cast<int32_t>(parent));
      }
    }
    return make_skeleton(branches_);
  }

 private:
  float unit() { return static_cast<float>(random_() * 0x1p-32); }
  bool chance(double share) { return unit() < share; }
  int whole(int below) { return static_cast<int>(random_() % static_cast<uint32_t>(below)); }
  glm::vec3 direction() {
    while (true) {
      const glm::vec3 v(2.0f * unit() - 1.0f, 2.0f * unit() - 1.0f, 2.0f * unit() - 1.0f);
      const float length = glm::length(v);
      if (length > 0.1f && length <= 1.0f) {
        return v / length;
      }
    }
  }

  void add_children(int32_t parent) {
    const std::vector<glm::vec3> points = branches_[parent].points;
    glm::vec3 place = points[whole(static_cast<int>(points.size()))];
    if (chance(0.5) && points.size() > 1) {
      const int i = whole(static_cast<int>(points.size()) - 1);
      place = glm::mix(points[i], points[i + 1], unit());
    } else if (chance(0.2)) {
      place = points.back();
    }
    constexpr float kWidths[] = {0.0f, 0.2f, 0.5f, 0.95f, 1.5f, 3.0f};
    for (int count = chance(0.3) ? 1 + whole(8) : 1; count > 0; --count) {
      add(parent, branches_[parent].level + 1, place, direction(),
          branches_[parent].radii[0] * kWidths[whole(6)]);
    }
  }

  void add(int32_t parent, int32_t level, const glm::vec3& start, glm::vec3 heading, float radius) {
    std::vector<glm::vec3> points = {start};
    const float step = 0.05f + 0.5f * unit();
    const int segments = chance(0.05) ? 0 : 1 + whole(8);
    for (int i = 0; i < segments; ++i) {
      const float kind = unit();
      glm::vec3 next = points.back();
      if (kind < 0.1f) {
        // A segment of no length.
      } else if (kind < 0.2f) {
        heading = glm::normalize(glm::cross(heading, direction()) + 1e-3f * heading);
        next += heading * step;
      } else if (kind < 0.28f) {
        heading = -heading;
        next += heading * step;
      } else if (kind < 0.36f && points.size() > 1) {
        next = points[points.size() - 2];
      } else {
        heading = glm::normalize(heading + 0.4f * direction());
        next += heading * step;
      }
      points.push_back(next);
    }
    std::vector<float> radii(points.size(), radius);
    const float taper = unit();
    for (size_t i = 0; i < radii.size(); ++i) {
      radii[i] *= 1.0f - taper * static_cast<float>(i) / static_cast<float>(radii.size());
    }
    if (chance(0.3)) {
      radii.back() = 0.0f;
    }
    branches_.push_back(make_branch(parent, level, points, radii));
  }

  std::mt19937 random_;
  std::vector<Branch> branches_;
};

/// A branch of one radius but for its tip, which is half as thick; whose level is not
/// yet known.
inline Branch tapering(std::string name, std::vector<glm::vec3> points, float radius) {
  Branch branch;
  branch.name = std::move(name);
  branch.level = -1;
  branch.points = std::move(points);
  branch.radii.assign(branch.points.size(), radius);
  branch.radii.back() = 0.5f * radius;
  branch.areas.assign(branch.points.size(), radius * radius);
  return branch;
}

}  // namespace snowbough::tree
