#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <glm/vec2.hpp>
#include <vector>

#include "tree/skeleton/tree_mesh.h"

namespace snowbough::tree {

/// Into how many pieces the four edges of a base quad are cut: `low` from corner 0 to 1, `right`
/// from 1 to 2, `high` from 3 to 2, `left` from 0 to 3. `low` and `high` are powers of two.
///
/// Strips of quads run from left to right. Where low and high differ, their number halves or
/// doubles from strip to strip, after `plain` strips from the edge with fewer; there must be enough
/// of these. A strip that goes from one quad to two, or back, needs one more vertex on one side:
/// left and right are equal but where exactly one of low and high is 1, in which case they differ
/// by one. So every patch is made of quads alone, and edges that are cut alike fit, without
/// T-junctions.
struct PatchCuts {
  int low = 1, right = 1, high = 1, left = 1;
  int plain = 0;

  int strips() const { return left < right ? left : right; }
};

/// Halvings or doublings between two powers of two.
int halvings(int a, int b);

/// Whether a patch with such edges needs sides that differ by one.
bool is_odd(int low, int high);

/// Quads across between low and high, at level 0 (low) to `strips` (high).
int quads_across(const PatchCuts& cuts, int level);

/// The strip that goes from one quad to two or back in an odd patch.
int odd_strip(const PatchCuts& cuts);

/// Number of quads that a patch is cut into.
int64_t count_quads(const PatchCuts& cuts);

/// A vertex of a patch. On an edge, `index` counts along the edge, from corner 0 for low and left,
/// from corner 1 for right, from corner 3 for high; inside, along the patch's own vertices.
struct PatchVertex {
  enum class Place : uint8_t { kLow, kRight, kHigh, kLeft, kInside };
  Place place = Place::kInside;
  int32_t index = 0;
};

/// The quads of one patch, anticlockwise as the base quad, and its vertices inside. Of a quad with
/// three corners in a row the middle one is corner 0 or 2, so that the triangles that it is cut
/// into between these have an area.
struct Patch {
  std::vector<std::array<PatchVertex, 4>> quads;
  /// Per vertex inside: the level and the step across, of how many.
  struct Inside {
    int level = 0, step = 0, steps = 0;
  };
  std::vector<Inside> inside;
};

/// Cuts a patch. Reuses the memory of `patch`.
/// @throws std::invalid_argument for edges that do not fit together.
void cut_patch(const PatchCuts& cuts, Patch& patch);

}  // namespace snowbough::tree
