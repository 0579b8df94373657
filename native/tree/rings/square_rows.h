#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/union_find.h"
#include "tree/rings/square_links.h"

namespace snowbough::tree {

/// Rows that grow together link by link.
class Rows {
 public:
  explicit Rows(size_t count) : next_(count, {-1, -1}), length_(count), row_(count) {}

  void link(const Link& link);

  /// A row that goes over from its own limb to the root of a child finds that root in its way; the
  /// rest of its limb then waits behind it, and fits better. Changes such links over.
  /// @return whether there was any.
  bool change_over(const Links& links, const std::vector<Plane>& planes);

  /// Takes back links that are far longer than those on both their sides.
  void cut_jumps();

  std::vector<std::vector<size_t>> rows() const;

 private:
  int side_to(size_t plane, size_t other) const;

  /// Whether `plane` is reached from `i` without its side `side`: linking them there makes a loop.
  bool in_row_of(size_t i, int side, size_t plane) const;

  /// How badly a link fits its neighbours in the row, as a mean over both its ends.
  double misfit(const std::vector<Plane>& planes, size_t i, int side, size_t j, int j_side) const;

  void find_rows();

  bool too_long(size_t plane, int side, double length) const;

  std::vector<std::array<int64_t, 2>> next_;
  std::vector<std::array<double, 2>> length_;
  base::UnionFind row_;
};

}  // namespace snowbough::tree
