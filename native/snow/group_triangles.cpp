#include "snow/group_triangles.h"

#include <algorithm>

#include "shaders/snow_shared.h"

namespace snowbough::snow {
namespace {

using shared::kTexelGroup;

/// Finds the triangles of one group after the other.
class Finder {
 public:
  Finder(const TexelTable& table, const std::vector<int32_t>& order,
         const std::vector<uint32_t>& owners)
      : table_(table), order_(order), owners_(owners), size_(table.resolution) {
    int32_t last = -1;
    for (const int32_t triangle : table.fragment_triangle) last = std::max(last, triangle);
    noted_in_.assign(static_cast<size_t>(last) + 1, 0);
    first_owner_ = owner_of(table.texel[static_cast<size_t>(order.front())]);
  }

  /// Of the group whose texels begin at `begin` of the order; appended, ascending.
  void find(size_t begin, std::vector<uint32_t>& triangles) {
    ++group_;
    group_owner_ = first_owner_ + static_cast<uint32_t>(begin);
    found_.clear();
    const size_t end = std::min(order_.size(), begin + kTexelGroup);
    for (size_t at = begin; at < end; ++at) {
      const auto i = static_cast<size_t>(order_[at]);
      note(i);
      if (!lies_inside(table_.texel[i])) note_neighbours(i);
    }
    std::sort(found_.begin(), found_.end());
    triangles.insert(triangles.end(), found_.begin(), found_.end());
  }

 private:
  uint32_t owner_of(int32_t texel) const { return owners_[static_cast<size_t>(texel)]; }
  bool is_of_group(uint32_t owner) const { return owner - group_owner_ < kTexelGroup; }

  /// Whether all texels around this one are of the group. At the map's left and right edge the row
  /// before or behind has a say, too: a no too many only costs time.
  bool lies_inside(int32_t texel) const {
    if (texel <= size_ || texel + size_ + 1 >= size_ * size_) return false;
    bool inside = true;
    for (const int32_t middle : {texel - size_, texel, texel + size_}) {
      inside = inside & is_of_group(owner_of(middle - 1)) & is_of_group(owner_of(middle)) &
               is_of_group(owner_of(middle + 1));
    }
    return inside;
  }

  /// Notes the triangles of texels of other groups and the same chart around texel i.
  void note_neighbours(size_t i) {
    const int32_t column = table_.texel[i] % size_;
    const int32_t row = table_.texel[i] / size_;
    for (int32_t y = std::max(row - 1, 0); y <= std::min(row + 1, size_ - 1); ++y) {
      for (int32_t x = std::max(column - 1, 0); x <= std::min(column + 1, size_ - 1); ++x) {
        const uint32_t owner = owner_of(y * size_ + x);
        if (owner == 0 || is_of_group(owner)) continue;
        const auto other = static_cast<size_t>(order_[owner - first_owner_]);
        if (table_.chart[other] == table_.chart[i]) note(other);
      }
    }
  }

  /// Notes the triangles of texel i.
  void note(size_t i) {
    for (int32_t f = table_.fragment_begin[i]; f < table_.fragment_begin[i + 1]; ++f) {
      const auto triangle = static_cast<size_t>(table_.fragment_triangle[static_cast<size_t>(f)]);
      if (noted_in_[triangle] == group_) continue;
      noted_in_[triangle] = group_;
      found_.push_back(static_cast<uint32_t>(triangle));
    }
  }

  const TexelTable& table_;
  const std::vector<int32_t>& order_;
  const std::vector<uint32_t>& owners_;
  int32_t size_;
  uint32_t first_owner_ = 0;
  uint32_t group_owner_ = 0;
  /// Number of the group at hand, from 1 on, and per triangle the last that it was noted in.
  int32_t group_ = 0;
  std::vector<int32_t> noted_in_;
  std::vector<uint32_t> found_;
};

}  // namespace

void add_group_triangles(const TexelTable& table, const std::vector<int32_t>& order,
                         const std::vector<uint32_t>& owners, uint32_t first_triangle,
                         GroupTriangles& groups) {
  if (order.empty()) return;
  Finder finder(table, order, owners);
  for (size_t begin = 0; begin < order.size(); begin += kTexelGroup) {
    const size_t before = groups.triangles.size();
    finder.find(begin, groups.triangles);
    for (size_t t = before; t < groups.triangles.size(); ++t) groups.triangles[t] += first_triangle;
    groups.begin.push_back(static_cast<uint32_t>(groups.triangles.size()));
  }
}

}  // namespace snowbough::snow
