#include "tree/strip_rows.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>

namespace snowbough::tree {
namespace {

constexpr int kSides = 4;

/// All that the quads say of one branch, in its own order of sides.
struct BranchRows {
  std::vector<std::array<StripCell, kSides>> cells;
  std::vector<std::array<int32_t, kSides>> rings;
  int32_t root_cap = -1;
  int32_t tip_cap = -1;
};

[[noreturn]] void reject(const FaceOrigin& origin, const std::string& why) {
  throw std::invalid_argument("quad of branch " + std::to_string(origin.branch) + ", row " +
                              std::to_string(origin.row) + ", side " + std::to_string(origin.side) +
                              ": " + why);
}

void check_origin(const FaceOrigin& origin, size_t branch_count) {
  if (origin.branch < 0 || static_cast<size_t>(origin.branch) >= branch_count) {
    reject(origin, "its branch is not in the skeleton");
  }
  if (origin.row < 0 || origin.side < 0 || origin.side >= kSides || origin.inset < 0 ||
      origin.inset >= kSides) {
    reject(origin, "row, side or inset is out of range");
  }
}

void claim(int32_t& slot, int32_t quad, const FaceOrigin& origin) {
  if (slot >= 0) {
    reject(origin, "two quads have the same origin");
  }
  slot = quad;
}

void set_corner(BranchRows& rows, int32_t ring, int32_t corner, int32_t vertex,
                const FaceOrigin& origin) {
  int32_t& slot = rows.rings[ring][corner % kSides];
  if (slot >= 0 && slot != vertex) {
    reject(origin, "its corners do not meet those of its neighbours");
  }
  slot = vertex;
}

std::vector<BranchRows> sort_quads(const TreeMesh& mesh, size_t branch_count) {
  if (mesh.origins.size() != mesh.quads.size()) {
    throw std::invalid_argument("the mesh has " + std::to_string(mesh.quads.size()) +
                                " quads but " + std::to_string(mesh.origins.size()) + " origins");
  }
  std::vector<BranchRows> branches(branch_count);
  for (size_t quad = 0; quad < mesh.quads.size(); ++quad) {
    const FaceOrigin& origin = mesh.origins[quad];
    check_origin(origin, branch_count);
    BranchRows& rows = branches[origin.branch];
    const auto index = static_cast<int32_t>(quad);
    if (origin.part == FacePart::kRootCap) {
      claim(rows.root_cap, index, origin);
      continue;
    }
    if (origin.part == FacePart::kTipCap) {
      claim(rows.tip_cap, index, origin);
      continue;
    }
    if (rows.cells.size() <= static_cast<size_t>(origin.row)) {
      rows.cells.resize(origin.row + 1);
    }
    StripCell& cell = rows.cells[origin.row][origin.side];
    claim(origin.part == FacePart::kWall ? cell.wall : cell.insets[origin.inset], index, origin);
  }
  for (BranchRows& rows : branches) {
    rows.rings.assign(rows.cells.size() + 1, {-1, -1, -1, -1});
  }
  for (size_t quad = 0; quad < mesh.quads.size(); ++quad) {
    const FaceOrigin& origin = mesh.origins[quad];
    if (origin.part != FacePart::kWall) {
      continue;
    }
    BranchRows& rows = branches[origin.branch];
    const Quad& corners = mesh.quads[quad];
    set_corner(rows, origin.row, origin.side, corners[0], origin);
    set_corner(rows, origin.row, origin.side + 1, corners[1], origin);
    set_corner(rows, origin.row + 1, origin.side + 1, corners[2], origin);
    set_corner(rows, origin.row + 1, origin.side, corners[3], origin);
  }
  return branches;
}

/// Where insets fill all sides of a row, its corners are only known from them: the corner of the
/// cell is the vertex that two consecutive insets share on the outside.
void complete_rings(BranchRows& rows, const TreeMesh& mesh) {
  for (size_t row = 0; row < rows.cells.size(); ++row) {
    for (int side = 0; side < kSides; ++side) {
      const StripCell& cell = rows.cells[row][side];
      if (cell.insets[0] < 0) {
        continue;
      }
      const std::array<std::pair<size_t, int>, kSides> places{
          {{row, side}, {row, side + 1}, {row + 1, side + 1}, {row + 1, side}}};
      for (int edge = 0; edge < kSides; ++edge) {
        if (cell.insets[edge] < 0) {
          continue;
        }
        const auto [ring, corner] = places[edge];
        int32_t& slot = rows.rings[ring][corner % kSides];
        slot = slot < 0 ? mesh.quads[cell.insets[edge]][0] : slot;
      }
    }
  }
}

/// How far the child's sides are turned against the parent's where both share a ring; -1 if they
/// share none.
int shared_ring_turn(const BranchRows& parent, const BranchRows& child) {
  if (parent.cells.empty() || child.cells.empty()) {
    return -1;
  }
  const auto& end = parent.rings.back();
  const auto& start = child.rings.front();
  for (int turn = 0; turn < kSides; ++turn) {
    bool same = true;
    for (int corner = 0; corner < kSides; ++corner) {
      same = same && start[corner] >= 0 && start[corner] == end[(corner + turn) % kSides];
    }
    if (same) {
      return turn;
    }
  }
  return -1;
}

void append_branch(Strip& strip, const BranchRows& rows, int32_t branch, int turn) {
  const auto turned = [turn](int side) { return (side + kSides - turn) % kSides; };
  for (size_t ring = strip.rings.empty() ? 0 : 1; ring < rows.rings.size(); ++ring) {
    StripRing& added = strip.rings.emplace_back();
    for (int corner = 0; corner < kSides; ++corner) {
      added.corners[corner] = rows.rings[ring][turned(corner)];
    }
  }
  for (const auto& cells : rows.cells) {
    StripRow& added = strip.rows.emplace_back();
    added.branch = branch;
    for (int side = 0; side < kSides; ++side) {
      added.cells[side] = cells[turned(side)];
    }
  }
}

double triangle_area(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  return 0.5 * glm::length(glm::cross(glm::dvec3(b - a), glm::dvec3(c - a)));
}

void measure_rings(Strip& strip, const TreeMesh& mesh) {
  const StripRing* previous = nullptr;
  for (StripRing& ring : strip.rings) {
    double known_length = 0.0;
    int known_sides = 0;
    double centre = 0.0;
    int known_corners = 0;
    for (int side = 0; side < kSides; ++side) {
      const int32_t a = ring.corners[side];
      const int32_t b = ring.corners[(side + 1) % kSides];
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
    for (int side = 0; side < kSides; ++side) {
      const int32_t a = ring.corners[side];
      const int32_t b = ring.corners[(side + 1) % kSides];
      if (a >= 0) {
        ring.heights[side] = mesh.vertices[a].z - centre / known_corners;
      }
      if (a < 0 || b < 0) {
        const double fallback = previous != nullptr ? previous->sides[side] : 0.0;
        ring.sides[side] = known_sides > 0 ? known_length / known_sides : fallback;
      }
    }
    previous = &ring;
    strip.perimeters.push_back(ring.sides[0] + ring.sides[1] + ring.sides[2] + ring.sides[3]);
  }
}

void measure_rows(Strip& strip, const TreeMesh& mesh) {
  for (size_t row = 0; row < strip.rows.size(); ++row) {
    double known_area = 0.0;
    int known_cells = 0;
    for (int side = 0; side < kSides; ++side) {
      const int next = (side + 1) % kSides;
      const std::array<int32_t, 4> corners{
          strip.rings[row].corners[side], strip.rings[row].corners[next],
          strip.rings[row + 1].corners[next], strip.rings[row + 1].corners[side]};
      if (std::any_of(corners.begin(), corners.end(), [](int32_t v) { return v < 0; })) {
        continue;
      }
      const glm::vec3& origin = mesh.vertices[corners[0]];
      known_area += triangle_area(origin, mesh.vertices[corners[1]], mesh.vertices[corners[2]]) +
                    triangle_area(origin, mesh.vertices[corners[2]], mesh.vertices[corners[3]]);
      ++known_cells;
    }
    strip.areas.push_back(known_cells > 0 ? known_area * kSides / known_cells : 0.0);
  }
}

/// Whether the cells of a piece hang together by their edges once it is cut open at `seam`.
bool is_connected(const Strip& strip, int32_t first_row, int32_t last_row, int seam) {
  std::vector<int32_t> group(static_cast<size_t>(last_row - first_row) * kSides);
  std::iota(group.begin(), group.end(), 0);
  const auto find = [&group](int32_t i) {
    while (group[i] != i) {
      i = group[i] = group[group[i]];
    }
    return i;
  };
  const auto filled = [&](int32_t row, int column) {
    return !strip.rows[row].cells[(seam + column) % kSides].empty();
  };
  int32_t groups = 0;
  for (int32_t row = first_row; row < last_row; ++row) {
    for (int column = 0; column < kSides; ++column) {
      if (!filled(row, column)) {
        continue;
      }
      ++groups;
      const int32_t cell = (row - first_row) * kSides + column;
      const auto join = [&](int32_t other) {
        const int32_t a = find(cell);
        const int32_t b = find(other);
        groups -= a != b;
        group[std::max(a, b)] = std::min(a, b);
      };
      if (column > 0 && filled(row, column - 1)) {
        join(cell - 1);
      }
      if (row > first_row && filled(row - 1, column)) {
        join(cell - kSides);
      }
    }
  }
  return groups <= 1;
}

/// Where nothing but holes lies between two rows, or in one of them, the strip falls apart anyway.
bool rows_touch(const StripRow& a, const StripRow& b) {
  for (int side = 0; side < kSides; ++side) {
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
  std::vector<BranchRows> branches = sort_quads(mesh, branch_count);
  for (BranchRows& rows : branches) {
    complete_rings(rows, mesh);
  }
  std::vector<Strip> strips;
  // Strip and turn of each branch: parents come first, so a child finds its parent's.
  std::vector<int32_t> strip_of(branch_count, -1);
  std::vector<int> turn_of(branch_count, 0);
  for (size_t branch = 0; branch < branch_count; ++branch) {
    const BranchRows& rows = branches[branch];
    if (rows.cells.empty()) {
      if (rows.root_cap >= 0 || rows.tip_cap >= 0) {
        throw std::invalid_argument("branch " + std::to_string(branch) + " has a cap but no walls");
      }
      continue;
    }
    const int32_t parent = skeleton.branches[branch].parent;
    const int turn = parent >= 0 ? shared_ring_turn(branches[parent], rows) : -1;
    if (turn >= 0) {
      strip_of[branch] = strip_of[parent];
      turn_of[branch] = (turn_of[parent] + turn) % kSides;
    } else {
      strip_of[branch] = static_cast<int32_t>(strips.size());
      strips.emplace_back().root_cap = rows.root_cap;
    }
    Strip& strip = strips[strip_of[branch]];
    append_branch(strip, rows, static_cast<int32_t>(branch), turn_of[branch]);
    strip.tip_cap = rows.tip_cap;
  }
  for (Strip& strip : strips) {
    measure_rings(strip, mesh);
    measure_rows(strip, mesh);
    find_ranges(strip);
  }
  return strips;
}

void cut_strip(const Strip& strip, int32_t strip_index, const std::vector<double>& row_lengths,
               double max_length, std::vector<StripPiece>& pieces) {
  const auto row_count = static_cast<int32_t>(strip.rows.size());
  const auto add_piece = [&](int32_t first, int32_t last) {
    pieces.push_back({strip_index, first, last, first == 0 && strip.root_cap >= 0,
                      last == row_count && strip.tip_cap >= 0});
  };
  for (auto [first, last] : strip.ranges) {
    double rest = std::accumulate(row_lengths.begin() + first, row_lengths.begin() + last, 0.0);
    while (rest > max_length && last - first > 1) {
      const double target = rest / std::ceil(rest / max_length);
      double length = 0.0;
      double best_score = std::numeric_limits<double>::infinity();
      double best_length = 0.0;
      int32_t best_row = first + 1;
      for (int32_t row = first + 1; row < last; ++row) {
        length += row_lengths[row - 1];
        if (length > max_length && row > first + 1) {
          break;
        }
        // A joint keeps its continuing child on the same chart if another cut is about as good.
        const bool joint = strip.rows[row - 1].branch != strip.rows[row].branch;
        const double score = std::abs(length - target) + (joint ? 0.25 * max_length : 0.0);
        if (score < best_score) {
          best_score = score;
          best_row = row;
          best_length = length;
        }
      }
      add_piece(first, best_row);
      first = best_row;
      rest -= best_length;
    }
    add_piece(first, last);
  }
}

int32_t choose_seam(const Strip& strip, const StripPiece& piece) {
  std::array<double, kSides> height{};
  for (int32_t row = piece.first_row; row < piece.last_row; ++row) {
    const double width = strip.perimeters[row] + strip.perimeters[row + 1];
    const double length = width > 0.0 ? 2.0 * strip.areas[row] / width : 0.0;
    for (int corner = 0; corner < kSides; ++corner) {
      height[corner] +=
          length * (strip.rings[row].heights[corner] + strip.rings[row + 1].heights[corner]);
    }
  }
  std::array<int, kSides> order{0, 1, 2, 3};
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return height[a] < height[b]; });
  for (const int seam : order) {
    if (is_connected(strip, piece.first_row, piece.last_row, seam)) {
      return seam;
    }
  }
  return order[0];
}

}  // namespace snowbough::tree
