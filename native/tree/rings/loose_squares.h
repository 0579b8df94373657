#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "tree/rings/squares.h"

namespace snowbough::tree {

/// Turns of the line through the centres of planes in the order of the file.
struct Turns {
  size_t all = 0;
  /// Those that go back, by more than a right angle.
  size_t back = 0;

  /// Whether the order means nothing: more than `share` of the turns go back. Along limbs hardly
  /// one does; with the limbs one after the other, two or three planes each, about half of them
  /// (0.48 on Betula lenta). Of planes in random order two thirds do along a straight limb, and
  /// more across a crown.
  bool shuffled(double share = 0.57) const;
  void operator+=(const Turns& other);
};

Turns count_turns(std::span<const CrossSection> sections);

/// Puts the planes of one limb, given in any order, along it: the shortest way through their
/// centres, the thicker end first. Indices of the planes.
std::vector<size_t> order_one_limb(std::span<const CrossSection> sections);

/// Puts planes in any order together to limbs: pairs that face each other across a short stretch
/// are linked, the best first, one on either side of a plane, unless another plane of their size
/// stands between them or the step is far longer than the one before. Indices of the planes, row by
/// row, the thicker end first. A plane that faces none makes a row of its own.
std::vector<std::vector<size_t>> chain_loose_sections(std::span<const CrossSection> sections);

/// Share of the links along the rows that join neighbours in the order of the planes: near 0 where
/// they are shuffled.
double neighbour_share(const std::vector<std::vector<size_t>>& rows);

/// Share of the planes that stand squarely across their row (within 25 degrees), with a neighbour
/// on it: near 1 for limbs, small for leaves that happen to lie behind one another.
double square_share(std::span<const CrossSection> sections,
                    const std::vector<std::vector<size_t>>& rows);

}  // namespace snowbough::tree
