#include "snow/surface/cell_grid.h"

#include <algorithm>

#include "base/group_by_key.h"

namespace snowbough::snow {
namespace {

/// Cells a box, on average, and cells of all boxes that are always allowed.
constexpr double kCellsPerBox = 64.0;
constexpr double kFewCells = 1 << 16;
/// Cells along the longest side of all boxes together, so that their numbers are exact floats.
constexpr float kLongestSide = 1 << 22;

/// Upper bound on the number of cells that the boxes overlap.
double count_cells(const std::vector<CellGrid::Box>& boxes, float size) {
  double count = 0.0;
  for (const CellGrid::Box& box : boxes) {
    const glm::dvec3 cells = glm::dvec3(box.high - box.low) / static_cast<double>(size) + 2.0;
    count += cells.x * cells.y * cells.z;
  }
  return count;
}

}  // namespace

size_t CellGrid::slot_of(const glm::ivec3& cell) const {
  const auto part = [](int32_t x) { return static_cast<uint64_t>(static_cast<uint32_t>(x)); };
  uint64_t hash = part(cell.x) * 0x9e3779b97f4a7c15u;
  hash = (hash ^ (hash >> 29) ^ part(cell.y)) * 0xbf58476d1ce4e5b9u;
  hash = (hash ^ (hash >> 32) ^ part(cell.z)) * 0x94d049bb133111ebu;
  return static_cast<size_t>((hash ^ (hash >> 31)) & (begin_.size() - 2));
}

CellGrid::CellGrid(const std::vector<Box>& boxes, float size) : size_(size) {
  if (boxes.empty()) return;
  low_ = boxes.front().low;
  high_ = boxes.front().high;
  for (const Box& box : boxes) {
    low_ = glm::min(low_, box.low);
    high_ = glm::max(high_, box.high);
  }
  const glm::vec3 extent = high_ - low_;
  size_ = std::max(size_, std::max({extent.x, extent.y, extent.z}) / kLongestSide);
  const double most = std::max(kFewCells, kCellsPerBox * static_cast<double>(boxes.size()));
  while (count_cells(boxes, size_) > most) size_ *= 2.0f;
  const auto for_cells = [&](const auto& visit) {
    for (size_t b = 0; b < boxes.size(); ++b) {
      const glm::ivec3 first = cell(boxes[b].low);
      const glm::ivec3 last = cell(boxes[b].high);
      for (int32_t z = first.z; z <= last.z; ++z) {
        for (int32_t y = first.y; y <= last.y; ++y) {
          for (int32_t x = first.x; x <= last.x; ++x) visit(glm::ivec3(x, y, z), b);
        }
      }
    }
  };
  size_t count = 0;
  for_cells([&](const glm::ivec3&, size_t) { ++count; });
  size_t slots = 1;
  while (slots < count) slots *= 2;
  // The number of slots is a power of two. The extra entry marks the end of the last slot.
  begin_.assign(slots + 1, 0);  // slot_of() uses its size
  const auto for_entries = [&](const auto& visit) {
    for_cells([&](const glm::ivec3& at, size_t b) {
      visit(slot_of(at), Entry{at, static_cast<int32_t>(b)});
    });
  };
  base::group_by_key(slots, for_entries, begin_, entries_);
}

}  // namespace snowbough::snow
