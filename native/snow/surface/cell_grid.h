#pragma once

#include <cstdint>
#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <glm/vector_relational.hpp>
#include <vector>

namespace snowbough::snow {

/// Boxes, hashed by the cells of a regular grid that they overlap. A query near a point visits only
/// the boxes in nearby cells, and may visit a box more than once. Gain: a bake of 121 bevelled
/// stones takes 31 s of the processor's time, instead of 50 s with one cell.
class CellGrid {
 public:
  struct Box {
    glm::vec3 low, high;
  };

  CellGrid() = default;
  /// @param size edge length of a cell in metres, over 0. It grows if the boxes would overlap many
  /// millions of cells: a long diagonal box overlaps the cube of its length in cells.
  CellGrid(const std::vector<Box>& boxes, float size);

  /// Calls visit(index), in a fixed order, for every box that overlaps a cell between `low` and
  /// `high`.
  template <typename Visit>
  void visit(const glm::vec3& low, const glm::vec3& high, const Visit& visit) const {
    if (begin_.empty() || glm::any(glm::greaterThan(low, high_)) ||
        glm::any(glm::lessThan(high, low_))) {
      return;
    }
    const glm::ivec3 first = cell(glm::max(low, low_));
    const glm::ivec3 last = cell(glm::min(high, high_));
    for (int32_t z = first.z; z <= last.z; ++z) {
      for (int32_t y = first.y; y <= last.y; ++y) {
        for (int32_t x = first.x; x <= last.x; ++x) {
          const size_t slot = slot_of({x, y, z});
          for (uint32_t i = begin_[slot]; i < begin_[slot + 1]; ++i) {
            if (entries_[i].cell == glm::ivec3(x, y, z)) visit(entries_[i].box);
          }
        }
      }
    }
  }

  float size() const { return size_; }

 private:
  struct Entry {
    glm::ivec3 cell;
    int32_t box;
  };
  glm::ivec3 cell(const glm::vec3& point) const {
    return glm::ivec3(glm::floor((point - low_) / size_));
  }
  size_t slot_of(const glm::ivec3& cell) const;

  float size_ = 1.0f;
  glm::vec3 low_{0.0f}, high_{-1.0f};
  /// Entries of hash slot s are from begin_[s] to begin_[s + 1].
  std::vector<uint32_t> begin_;
  std::vector<Entry> entries_;
};

}  // namespace snowbough::snow
