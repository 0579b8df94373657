#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "tree/rings/squares.h"

namespace snowbough::tree {

/// Turns of the line through the planes' centres in file order.
struct Turns {
  size_t all = 0;
  /// Turns by more than a right angle.
  size_t back = 0;

  /// Whether the order is random: more than `share` of the turns go back. Along limbs hardly any
  /// do; for limbs of two or three planes each, about half of them (0.48 on Betula lenta). For
  /// planes in random order two thirds do along a straight limb, and more across a crown.
  bool shuffled(double share = 0.57) const;
  void operator+=(const Turns& other);
};

Turns count_turns(std::span<const CrossSection> sections);

/// Sorts the planes of one limb along it: the shortest path through their centres, the thicker end
/// first. Returns indices of the planes.
std::vector<size_t> order_one_limb(std::span<const CrossSection> sections);

/// Joins unordered planes to limbs: links pairs that face each other over a short distance, the
/// best first, one on either side of a plane, unless another plane of their size is in between or
/// the distance is far longer than the one before. Returns indices of the planes per row, the
/// thicker end first. A plane without a link makes a row of its own.
std::vector<std::vector<size_t>> chain_loose_sections(std::span<const CrossSection> sections);

/// Fraction of the links along the rows that join consecutive planes of the input: near 0 if the
/// order is random.
double neighbour_share(const std::vector<std::vector<size_t>>& rows);

/// Fraction of the planes that are perpendicular to their row (within 25 degrees) and have a
/// neighbour in it: near 1 for limbs, small for leaves that happen to be behind one another.
double square_share(std::span<const CrossSection> sections,
                    const std::vector<std::vector<size_t>>& rows);

}  // namespace snowbough::tree
