#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <vector>

#include "tree/skeleton/tree_mesh.h"

namespace snowbough::tree {

/// Number of pieces of the four edges of a base quad: `low` from corner 0 to 1, `right` from 1 to
/// 2, `high` from 3 to 2, `left` from 0 to 3. `low` and `high` are powers of two.
///
/// Strips of quads run from left to right. If low and high differ, the number of quads halves or
/// doubles from strip to strip, after `plain` strips from the edge with fewer; there must be enough
/// strips. A strip between one quad and two needs one more vertex on one side: left and right are
/// equal unless exactly one of low and high is 1; then they differ by one. Every patch thus
/// consists of quads only, and edges with equal cuts match without T-junctions.
struct PatchCuts {
  int low = 1, right = 1, high = 1, left = 1;
  int plain = 0;

  int strips() const { return left < right ? left : right; }
};

/// Number of halvings or doublings between two powers of two.
int halvings(int a, int b);

/// Whether the left and right edges must differ by one.
bool is_odd(int low, int high);

/// Number of quads across between low and high, at line 0 (low) to `strips` (high).
int quads_across(const PatchCuts& cuts, int line);

/// The strip between one quad and two in an odd patch.
int odd_strip(const PatchCuts& cuts);

int64_t count_quads(const PatchCuts& cuts);

/// A vertex of a patch. On an edge, `index` counts along the edge, from corner 0 for low and left,
/// from corner 1 for right, from corner 3 for high; inside, along the patch's own vertices.
struct PatchVertex {
  enum class Place : uint8_t { kLow, kRight, kHigh, kLeft, kInside };
  Place place = Place::kInside;
  int32_t index = 0;
};

/// The quads of one patch, anticlockwise like the base quad, and its inner vertices. In a quad with
/// three collinear corners the middle one is corner 0 or 2, so that both triangles of the split
/// between 0 and 2 have an area.
struct Patch {
  std::vector<std::array<PatchVertex, 4>> quads;
  /// Per inner vertex: its line, and its step of `steps` across.
  struct Inside {
    int line = 0, step = 0, steps = 0;
  };
  std::vector<Inside> inside;
};

/// Cuts a patch. Reuses the memory of `patch`.
/// @throws std::invalid_argument for edges that do not match.
void cut_patch(const PatchCuts& cuts, Patch& patch);

}  // namespace snowbough::tree
