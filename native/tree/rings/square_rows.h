#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/union_find.h"
#include "tree/rings/square_links.h"

namespace snowbough::tree {

/// Rows built link by link.
class Rows {
 public:
  explicit Rows(size_t count) : next_(count, {-1, -1}), length_(count), row_(count) {}

  void link(const Link& link);

  /// Repairs rows that continue from their own limb into the root of a child, so that the rest of
  /// their limb, which fits better, is left unlinked. Relinks such rows.
  /// @return whether any was changed.
  bool relink(const Links& links, const std::vector<Plane>& planes);

  /// Removes links that are far longer than those on both their sides.
  void cut_jumps();

  std::vector<std::vector<size_t>> rows() const;

 private:
  int side_to(size_t plane, size_t other) const;

  /// Whether `plane` is reachable from `i` without its side `side`: linking them there makes a
  /// loop.
  bool in_row_of(size_t i, int side, size_t plane) const;

  /// Mean mismatch of a link with its neighbours in the row, over both its ends.
  double misfit(const std::vector<Plane>& planes, size_t i, int side, size_t j, int j_side) const;

  void find_rows();

  bool too_long(size_t plane, int side, double length) const;

  std::vector<std::array<int64_t, 2>> next_;
  std::vector<std::array<double, 2>> length_;
  base::UnionFind row_;
};

}  // namespace snowbough::tree
