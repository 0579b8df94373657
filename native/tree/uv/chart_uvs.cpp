#include "tree/uv/chart_uvs.h"

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>

namespace snowbough::tree {
namespace {

/// Minimum gap around holes and insets, as a fraction of their cell.
constexpr double kMinInsetShare = 0.04;

/// Position of an inset cell's hole: left, right, bottom, top, each from 0 to 1.
struct HoleRect {
  double left, right, bottom, top;
};

void order_with_margin(double& low, double& high) {
  low = std::clamp(low, kMinInsetShare, 1.0 - 2.0 * kMinInsetShare);
  high = std::clamp(high, low + kMinInsetShare, 1.0 - kMinInsetShare);
}

/// The cell's corner on or nearest to corner `c` of an inset, and whether the corner belongs to the
/// hole.
struct InsetCorner {
  int cell_corner = 0;
  bool inner = false;
};

std::array<InsetCorner, 4> classify_inset(const Quad& inset, const std::array<int32_t, 4>& cell) {
  std::array<InsetCorner, 4> result;
  std::array<int, 4> outer{-1, -1, -1, -1};
  for (int corner = 0; corner < 4; ++corner) {
    const auto match = std::find(cell.begin(), cell.end(), inset[corner]);
    outer[corner] = match == cell.end() ? -1 : static_cast<int>(match - cell.begin());
  }
  for (int corner = 0; corner < 4; ++corner) {
    if (outer[corner] >= 0) {
      result[corner] = {outer[corner], false};
    } else {
      const int before = outer[(corner + 3) % 4];
      result[corner] = {before >= 0 ? before : std::max(outer[(corner + 1) % 4], 0), true};
    }
  }
  return result;
}

/// @param insets  the quads along the cell's edges; -1 if one is missing.
HoleRect locate_hole(const TreeMesh& mesh, const std::array<int32_t, 4>& insets,
                     const std::array<int32_t, 4>& corners) {
  HoleRect hole{0.25, 0.75, 0.25, 0.75};
  if (std::any_of(corners.begin(), corners.end(), [](int32_t v) { return v < 0; })) {
    return hole;
  }
  std::array<glm::dvec3, 4> p;
  for (int i = 0; i < 4; ++i) {
    p[i] = mesh.vertices[corners[i]];
  }
  const glm::dvec3 centre = 0.25 * (p[0] + p[1] + p[2] + p[3]);
  const glm::dvec3 across = 0.5 * (p[1] - p[0] + p[2] - p[3]);
  const glm::dvec3 along = 0.5 * (p[3] - p[0] + p[2] - p[1]);
  const double aa = glm::dot(across, across);
  const double ab = glm::dot(across, along);
  const double bb = glm::dot(along, along);
  const double determinant = aa * bb - ab * ab;
  if (determinant <= 1e-6 * aa * bb) {
    return hole;
  }
  std::array<double, 4> u{};
  std::array<double, 4> v{};
  std::array<int, 4> count{};
  for (const int32_t inset : insets) {
    if (inset < 0) {
      continue;
    }
    const auto kinds = classify_inset(mesh.quads[inset], corners);
    for (int i = 0; i < 4; ++i) {
      if (kinds[i].inner) {
        const glm::dvec3 d = glm::dvec3(mesh.vertices[mesh.quads[inset][i]]) - centre;
        const int corner = kinds[i].cell_corner;
        u[corner] += 0.5 + (bb * glm::dot(d, across) - ab * glm::dot(d, along)) / determinant;
        v[corner] += 0.5 + (aa * glm::dot(d, along) - ab * glm::dot(d, across)) / determinant;
        ++count[corner];
      }
    }
  }
  for (int i = 0; i < 4; ++i) {
    if (count[i] == 0) {
      return hole;
    }
    u[i] /= count[i];
    v[i] /= count[i];
  }
  hole = {0.5 * (u[0] + u[3]), 0.5 * (u[1] + u[2]), 0.5 * (v[0] + v[1]), 0.5 * (v[2] + v[3])};
  order_with_margin(hole.left, hole.right);
  order_with_margin(hole.bottom, hole.top);
  return hole;
}

}  // namespace

void write_chart_uvs(const Strip& strip, const ChartShapes& shapes, const ChartShape& chart,
                     int32_t seam, const PackShape& outline, const Placement& placement,
                     const ChartMap& map, TreeMesh& mesh) {
  const StripPiece& piece = chart.piece;
  const std::span<const ChartRing> rings = shapes.rings_of(chart);
  const double full_width = static_cast<double>(outline.width) * map.cell_size;
  const double full_height = static_cast<double>(outline.height) * map.cell_size;
  const double texels = map.resolution;
  // After half a turn, the straight edge of the outline is on the other side.
  const bool straight_right = placement.columns_reversed != placement.rows_reversed;
  const auto to_map = [&](double x, double y) {
    if (placement.rows_reversed) {
      x = full_width - x;
      y = full_height - y;
    }
    return glm::vec2((x + static_cast<double>(placement.x) * map.cell_size) / texels,
                     (y + static_cast<double>(placement.y) * map.cell_size) / texels);
  };
  const auto column_x = [&](int ring, double share) {
    const double width = rings[ring].width;
    return (straight_right ? full_width - width : 0.0) + share * width;
  };
  std::array<double, kStripSides + 1> bottom_shares =
      column_shares(strip.rings[piece.first_row], seam);
  for (int32_t row = piece.first_row; row < piece.last_row; ++row) {
    const int ring = row - piece.first_row;
    const auto top_shares = column_shares(strip.rings[row + 1], seam);
    for (int column = 0; column < kStripSides; ++column) {
      const int side = (seam + column) % kStripSides;
      const int next = (side + 1) % kStripSides;
      const StripCell& cell = strip.rows[row].cells[side];
      const double x0 = column_x(ring, bottom_shares[column]);
      const double x1 = column_x(ring, bottom_shares[column + 1]);
      const double x2 = column_x(ring + 1, top_shares[column + 1]);
      const double x3 = column_x(ring + 1, top_shares[column]);
      const double y0 = rings[ring].y;
      const double y1 = rings[ring + 1].y;
      if (cell.wall >= 0) {
        mesh.uv_snow[cell.wall] = {to_map(x0, y0), to_map(x1, y0), to_map(x2, y1), to_map(x3, y1)};
        continue;
      }
      if (cell.empty()) {
        continue;
      }
      const std::array<int32_t, 4>& insets = strip.insets[cell.inset];
      const std::array<int32_t, 4> corners{
          strip.rings[row].corners[side], strip.rings[row].corners[next],
          strip.rings[row + 1].corners[next], strip.rings[row + 1].corners[side]};
      const HoleRect hole = locate_hole(mesh, insets, corners);
      const auto in_cell = [&](double u, double v) {
        const double left = x0 + v * (x3 - x0);
        const double right = x1 + v * (x2 - x1);
        return to_map(left + u * (right - left), y0 + v * (y1 - y0));
      };
      const std::array<glm::vec2, 4> outer{to_map(x0, y0), to_map(x1, y0), to_map(x2, y1),
                                           to_map(x3, y1)};
      const std::array<glm::vec2, 4> inner{
          in_cell(hole.left, hole.bottom), in_cell(hole.right, hole.bottom),
          in_cell(hole.right, hole.top), in_cell(hole.left, hole.top)};
      for (const int32_t inset : insets) {
        if (inset < 0) {
          continue;
        }
        const auto kinds = classify_inset(mesh.quads[inset], corners);
        for (int i = 0; i < 4; ++i) {
          mesh.uv_snow[inset][i] =
              kinds[i].inner ? inner[kinds[i].cell_corner] : outer[kinds[i].cell_corner];
        }
      }
    }
    bottom_shares = top_shares;
  }
  // A cap is attached to the end's side along the straight edge, where the strip leaves room for
  // it.
  const int cap_column = straight_right ? kStripSides - 1 : 0;
  const int cap_side = (seam + cap_column) % kStripSides;
  const auto write_cap = [&](int32_t quad, int ring, double base_y, double far_y) {
    const StripRing& corners = strip.rings[piece.first_row + ring];
    const auto shares = column_shares(corners, seam);
    const double left = column_x(ring, shares[cap_column]);
    const double right = column_x(ring, shares[cap_column + 1]);
    for (int i = 0; i < kStripSides; ++i) {
      // Seen from outside, the far edge of a tip's cap has the next two corners in the limb's
      // order; a root's cap is seen from the other end.
      const int32_t vertex = mesh.quads[quad][i];
      const auto at = std::find(corners.corners.begin(), corners.corners.end(), vertex);
      const int corner = static_cast<int>(at - corners.corners.begin());
      const int step = (corner - cap_side + kStripSides) % kStripSides;
      const double x = step == 1 || step == 2 ? right : left;
      mesh.uv_snow[quad][i] = to_map(x, step < 2 ? base_y : far_y);
    }
  };
  if (piece.has_root_cap) {
    write_cap(strip.root_cap, 0, rings.front().y, 0.0);
  }
  if (piece.has_tip_cap) {
    write_cap(strip.tip_cap, static_cast<int>(rings.size()) - 1, rings.back().y, chart.height);
  }
}

}  // namespace snowbough::tree
