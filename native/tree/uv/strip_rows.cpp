#include "tree/uv/strip_rows.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <numeric>
#include <span>
#include <stdexcept>
#include <string>

namespace snowbough::tree {
namespace {

using Corners = std::array<int32_t, kStripSides>;

/// The quads by branch, each in its own order of sides, in flat arrays.
struct BranchRows {
  /// Each branch's first row, and the end of the last one.
  std::vector<int32_t> first_row;
  std::vector<std::array<StripCell, kStripSides>> cells;
  /// One more per branch than rows.
  std::vector<Corners> rings;
  std::vector<Corners> insets;
  std::vector<int32_t> root_caps;
  std::vector<int32_t> tip_caps;

  int32_t row_count(size_t branch) const { return first_row[branch + 1] - first_row[branch]; }
  size_t first_ring(size_t branch) const { return first_row[branch] + branch; }
  std::span<const std::array<StripCell, kStripSides>> cells_of(size_t branch) const {
    return std::span(cells).subspan(first_row[branch], row_count(branch));
  }
  std::span<const Corners> rings_of(size_t branch) const {
    return std::span(rings).subspan(first_ring(branch), row_count(branch) + 1);
  }
};

[[noreturn]] void reject(const FaceOrigin& origin, const std::string& why) {
  throw std::invalid_argument("quad of branch " + std::to_string(origin.branch) + ", row " +
                              std::to_string(origin.row) + ", side " + std::to_string(origin.side) +
                              ": " + why);
}

void check_origin(const FaceOrigin& origin, size_t branch_count, size_t quad_count) {
  if (origin.branch < 0 || static_cast<size_t>(origin.branch) >= branch_count) {
    reject(origin, "its branch is not in the skeleton");
  }
  if (origin.row < 0 || static_cast<size_t>(origin.row) > quad_count || origin.side < 0 ||
      origin.side >= kStripSides || origin.inset < 0 || origin.inset >= kStripSides) {
    reject(origin, "row, side or inset is out of range");
  }
}

void claim(int32_t& slot, int32_t quad, const FaceOrigin& origin) {
  if (slot >= 0) {
    reject(origin, "two quads have the same origin");
  }
  slot = quad;
}

/// Sets corner `corner` (modulo four) of a ring.
void set_corner(Corners& ring, int32_t corner, int32_t vertex, const FaceOrigin& origin) {
  int32_t& slot = ring[corner % kStripSides];
  if (slot >= 0 && slot != vertex) {
    reject(origin, "its corners do not meet those of its neighbours");
  }
  slot = vertex;
}

bool is_cap(const FaceOrigin& origin) {
  return origin.part == FacePart::kRootCap || origin.part == FacePart::kTipCap;
}

/// Checks the origins and allocates every branch's rows.
BranchRows count_rows(const TreeMesh& mesh, size_t branch_count) {
  if (mesh.origins.size() != mesh.quads.size()) {
    throw std::invalid_argument("the mesh has " + std::to_string(mesh.quads.size()) +
                                " quads but " + std::to_string(mesh.origins.size()) + " origins");
  }
  BranchRows rows;
  rows.first_row.assign(branch_count + 1, 0);
  for (const FaceOrigin& origin : mesh.origins) {
    check_origin(origin, branch_count, mesh.quads.size());
    if (!is_cap(origin)) {
      int32_t& count = rows.first_row[origin.branch + 1];
      count = std::max(count, origin.row + 1);
    }
  }
  std::partial_sum(rows.first_row.begin(), rows.first_row.end(), rows.first_row.begin());
  rows.cells.resize(rows.first_row.back());
  rows.rings.assign(rows.first_row.back() + branch_count, {-1, -1, -1, -1});
  rows.root_caps.assign(branch_count, -1);
  rows.tip_caps.assign(branch_count, -1);
  return rows;
}

BranchRows sort_quads(const TreeMesh& mesh, size_t branch_count) {
  BranchRows rows = count_rows(mesh, branch_count);
  for (size_t quad = 0; quad < mesh.quads.size(); ++quad) {
    const FaceOrigin& origin = mesh.origins[quad];
    const auto index = static_cast<int32_t>(quad);
    if (is_cap(origin)) {
      auto& caps = origin.part == FacePart::kRootCap ? rows.root_caps : rows.tip_caps;
      claim(caps[origin.branch], index, origin);
      continue;
    }
    StripCell& cell = rows.cells[rows.first_row[origin.branch] + origin.row][origin.side];
    if (origin.part == FacePart::kInset) {
      if (cell.inset < 0) {
        cell.inset = static_cast<int32_t>(rows.insets.size());
        rows.insets.push_back({-1, -1, -1, -1});
      }
      claim(rows.insets[cell.inset][origin.inset], index, origin);
      continue;
    }
    claim(cell.wall, index, origin);
    const Quad& corners = mesh.quads[quad];
    Corners* const ring = &rows.rings[rows.first_ring(origin.branch) + origin.row];
    set_corner(ring[0], origin.side, corners[0], origin);
    set_corner(ring[0], origin.side + 1, corners[1], origin);
    set_corner(ring[1], origin.side + 1, corners[2], origin);
    set_corner(ring[1], origin.side, corners[3], origin);
  }
  return rows;
}

/// If insets fill all sides of a row, its corners follow only from them: the corner of a cell is
/// the outer vertex shared by two consecutive insets.
void complete_rings(const TreeMesh& mesh, BranchRows& rows) {
  for (size_t quad = 0; quad < mesh.quads.size(); ++quad) {
    const FaceOrigin& origin = mesh.origins[quad];
    if (origin.part != FacePart::kInset) {
      continue;
    }
    // Edges 0 to 3 begin at the cell's corners, anticlockwise from its lower left.
    const int32_t up = origin.inset / 2;
    const int32_t right = origin.inset == 1 || origin.inset == 2 ? 1 : 0;
    Corners& ring = rows.rings[rows.first_ring(origin.branch) + origin.row + up];
    int32_t& slot = ring[(origin.side + right) % kStripSides];
    slot = slot < 0 ? mesh.quads[quad][0] : slot;
  }
}

/// Rotation of the child's sides relative to the parent's if both share a ring; -1 if they share
/// none.
int shared_ring_turn(const BranchRows& rows, size_t parent, size_t child) {
  if (rows.row_count(parent) == 0 || rows.row_count(child) == 0) {
    return -1;
  }
  const Corners& end = rows.rings_of(parent).back();
  const Corners& start = rows.rings_of(child).front();
  for (int turn = 0; turn < kStripSides; ++turn) {
    bool same = true;
    for (int corner = 0; corner < kStripSides; ++corner) {
      same = same && start[corner] >= 0 && start[corner] == end[(corner + turn) % kStripSides];
    }
    if (same) {
      return turn;
    }
  }
  return -1;
}

void append_branch(const BranchRows& rows, size_t branch, int turn, Strip& strip) {
  const auto turned = [turn](int side) { return (side + kStripSides - turn) % kStripSides; };
  const auto rings = rows.rings_of(branch);
  const auto cells = rows.cells_of(branch);
  strip.rings.reserve(strip.rings.size() + rings.size());
  strip.rows.reserve(strip.rows.size() + cells.size());
  for (size_t ring = strip.rings.empty() ? 0 : 1; ring < rings.size(); ++ring) {
    StripRing& added = strip.rings.emplace_back();
    for (int corner = 0; corner < kStripSides; ++corner) {
      added.corners[corner] = rings[ring][turned(corner)];
    }
  }
  for (const auto& row : cells) {
    StripRow& added = strip.rows.emplace_back();
    added.branch = static_cast<int32_t>(branch);
    for (int side = 0; side < kStripSides; ++side) {
      StripCell& cell = added.cells[side];
      cell = row[turned(side)];
      if (cell.inset >= 0) {
        strip.insets.push_back(rows.insets[cell.inset]);
        cell.inset = static_cast<int32_t>(strip.insets.size()) - 1;
      }
    }
  }
}

/// Area of a nearly flat quad: half the cross product of its diagonals.
double quad_area(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& d) {
  return 0.5 * glm::length(glm::cross(glm::dvec3(c - a), glm::dvec3(d - b)));
}

void measure_rings(const TreeMesh& mesh, Strip& strip) {
  strip.perimeters.reserve(strip.rings.size());
  const StripRing* previous = nullptr;
  for (StripRing& ring : strip.rings) {
    float known_length = 0.0f;
    int known_sides = 0;
    float centre = 0.0f;
    int known_corners = 0;
    for (int side = 0; side < kStripSides; ++side) {
      const int32_t a = ring.corners[side];
      const int32_t b = ring.corners[(side + 1) % kStripSides];
      if (a >= 0) {
        centre += mesh.vertices[a].z;
        ++known_corners;
      }
      if (a >= 0 && b >= 0) {
        ring.sides[side] = glm::distance(mesh.vertices[a], mesh.vertices[b]);
        known_length += ring.sides[side];
        ++known_sides;
      }
    }
    centre /= static_cast<float>(std::max(known_corners, 1));
    double perimeter = 0.0;
    for (int side = 0; side < kStripSides; ++side) {
      const int32_t a = ring.corners[side];
      const int32_t b = ring.corners[(side + 1) % kStripSides];
      if (a >= 0) {
        ring.heights[side] = mesh.vertices[a].z - centre;
      }
      if (a < 0 || b < 0) {
        const float fallback = previous != nullptr ? previous->sides[side] : 0.0f;
        ring.sides[side] =
            known_sides > 0 ? known_length / static_cast<float>(known_sides) : fallback;
      }
      perimeter += ring.sides[side];
    }
    strip.perimeters.push_back(perimeter);
    previous = &ring;
  }
}

void measure_rows(const TreeMesh& mesh, Strip& strip) {
  strip.areas.reserve(strip.rows.size());
  for (size_t row = 0; row < strip.rows.size(); ++row) {
    const auto& low = strip.rings[row].corners;
    const auto& high = strip.rings[row + 1].corners;
    double known_area = 0.0;
    int known_cells = 0;
    for (int side = 0; side < kStripSides; ++side) {
      const int next = (side + 1) % kStripSides;
      if (low[side] >= 0 && low[next] >= 0 && high[next] >= 0 && high[side] >= 0) {
        known_area += quad_area(mesh.vertices[low[side]], mesh.vertices[low[next]],
                                mesh.vertices[high[next]], mesh.vertices[high[side]]);
        ++known_cells;
      }
    }
    strip.areas.push_back(known_cells > 0 ? known_area * kStripSides / known_cells : 0.0);
  }
}

/// Whether two rows touch; if all sides between them, or of one of them, are holes, the strip falls
/// apart.
bool rows_touch(const StripRow& a, const StripRow& b) {
  for (int side = 0; side < kStripSides; ++side) {
    if (!a.cells[side].empty() && !b.cells[side].empty()) {
      return true;
    }
  }
  return false;
}

void find_ranges(Strip& strip) {
  const auto row_count = static_cast<int32_t>(strip.rows.size());
  for (int32_t row = 0; row < row_count;) {
    const auto& cells = strip.rows[row].cells;
    const int32_t first = row++;
    if (std::all_of(cells.begin(), cells.end(), [](const StripCell& c) { return c.empty(); })) {
      continue;
    }
    while (row < row_count && rows_touch(strip.rows[row - 1], strip.rows[row])) {
      ++row;
    }
    strip.ranges.push_back({first, row});
  }
}

}  // namespace

std::vector<Strip> collect_strips(const TreeMesh& mesh, const Skeleton& skeleton) {
  const size_t branch_count = skeleton.branches.size();
  BranchRows rows = sort_quads(mesh, branch_count);
  complete_rings(mesh, rows);
  std::vector<Strip> strips;
  strips.reserve(branch_count);
  // Strip and rotation of each branch: parents come first, so a child finds its parent's.
  std::vector<int32_t> strip_of(branch_count, -1);
  std::vector<int> turn_of(branch_count, 0);
  for (size_t branch = 0; branch < branch_count; ++branch) {
    if (rows.row_count(branch) == 0) {
      if (rows.root_caps[branch] >= 0 || rows.tip_caps[branch] >= 0) {
        throw std::invalid_argument("branch " + std::to_string(branch) + " has a cap but no walls");
      }
      continue;
    }
    const int32_t parent = skeleton.branches[branch].parent;
    const int turn = parent >= 0 ? shared_ring_turn(rows, parent, branch) : -1;
    if (turn >= 0) {
      strip_of[branch] = strip_of[parent];
      turn_of[branch] = (turn_of[parent] + turn) % kStripSides;
    } else {
      strip_of[branch] = static_cast<int32_t>(strips.size());
      strips.emplace_back().root_cap = rows.root_caps[branch];
    }
    Strip& strip = strips[strip_of[branch]];
    append_branch(rows, branch, turn_of[branch], strip);
    strip.tip_cap = rows.tip_caps[branch];
  }
  for (Strip& strip : strips) {
    measure_rings(mesh, strip);
    measure_rows(mesh, strip);
    find_ranges(strip);
  }
  return strips;
}

}  // namespace snowbough::tree
