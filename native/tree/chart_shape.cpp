#include "tree/chart_shape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

namespace snowbough::tree {
namespace {

constexpr int kSides = 4;
/// Narrowest chart in texels.
constexpr double kMinWidth = 2.0;
/// From this width on a chart keeps two texels free around it.
constexpr double kWideChart = 4.0;
/// How many times its share of texels a widened row may take, and how far it is shortened for it.
constexpr double kMaxDensityRatio = 1.6;
constexpr double kMinShortening = 0.5;
/// Rows of no length (rings upon each other) still get this many texels, for a positive area.
constexpr double kMinRowLength = 1.0 / 32.0;
/// A side takes at least this share of the perimeter in the map, however short it is.
constexpr double kMinSideShare = 0.1;
/// Holes and insets keep this share of their cell clear of each other.
constexpr double kMinInsetShare = 0.04;
/// Outlines may pass a cell's edge by this much (in cells) before they count as touching it.
constexpr double kTouch = 1e-6;

double ring_width(const StripRing& ring, double scale) {
  return std::max(kMinWidth, scale * ring.perimeter());
}

/// Where the five columns (the seam twice) lie across the chart at one ring, from 0 to 1.
std::array<double, kSides + 1> column_shares(const StripRing& ring, int seam) {
  std::array<double, kSides> share{};
  double sum = 0.0;
  const double perimeter = ring.perimeter();
  for (int column = 0; column < kSides; ++column) {
    const double side = ring.sides[(seam + column) % kSides];
    share[column] = perimeter > 0.0 ? std::max(side / perimeter, kMinSideShare) : 1.0;
    sum += share[column];
  }
  std::array<double, kSides + 1> columns{};
  for (int column = 0; column < kSides; ++column) {
    columns[column + 1] = columns[column] + share[column] / sum;
  }
  columns[kSides] = 1.0;
  return columns;
}

/// Width of a ring's broadest side: as wide as a cap can be, whichever side it hangs on.
double cap_width(const StripRing& ring, double ring_width) {
  const auto columns = column_shares(ring, 0);
  double widest = 0.0;
  for (int side = 0; side < kSides; ++side) {
    widest = std::max(widest, columns[side + 1] - columns[side]);
  }
  return ring_width * widest;
}

/// Marks the columns that a trapezoid with its straight edge on x = 0 covers.
void cover(PackShape& outline, double y0, double y1, double width0, double width1, double cell) {
  y0 /= cell;
  y1 /= cell;
  width0 /= cell;
  width1 /= cell;
  const auto columns =
      std::min(outline.width, static_cast<int>(std::ceil(std::max(width0, width1) - kTouch)));
  for (int column = 0; column < columns; ++column) {
    double low = y0;
    double high = y1;
    // Part of the trapezoid that reaches past the column's left edge.
    if (width0 < column || width1 < column) {
      const double crossing = y0 + (y1 - y0) * (column - width0) / (width1 - width0);
      (width0 < width1 ? low : high) = crossing;
    }
    outline.begin[column] =
        std::min(outline.begin[column], static_cast<int>(std::floor(low + kTouch)));
    outline.end[column] = std::max(outline.end[column], static_cast<int>(std::ceil(high - kTouch)));
  }
}

/// Where the hole of an inset cell lies in it: left, right, bottom, top, each from 0 to 1.
struct HoleRect {
  double left, right, bottom, top;
};

void order_with_margin(double& low, double& high) {
  low = std::clamp(low, kMinInsetShare, 1.0 - 2.0 * kMinInsetShare);
  high = std::clamp(high, low + kMinInsetShare, 1.0 - kMinInsetShare);
}

/// Corner of the cell that corner `c` of an inset lies on or nearest to, and whether it is the
/// hole's.
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

HoleRect locate_hole(const TreeMesh& mesh, const StripCell& cell,
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
  for (const int32_t inset : cell.insets) {
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

std::vector<double> row_lengths(const Strip& strip, double scale) {
  std::vector<double> lengths(strip.rows.size());
  for (size_t row = 0; row < strip.rows.size(); ++row) {
    const StripRing& bottom = strip.rings[row];
    const StripRing& top = strip.rings[row + 1];
    const double own_width = 0.5 * scale * (bottom.perimeter() + top.perimeter());
    const double width = 0.5 * (ring_width(bottom, scale) + ring_width(top, scale));
    double length = own_width > 0.0 ? scale * scale * strip.rows[row].area / own_width : 0.0;
    const double widening = own_width > 0.0 ? width / own_width : 1.0;
    length *= std::clamp(kMaxDensityRatio / widening, kMinShortening, 1.0);
    lengths[row] = std::max(length, kMinRowLength);
  }
  return lengths;
}

ChartShape shape_chart(const Strip& strip, const StripPiece& piece,
                       const std::vector<double>& lengths, double scale, double max_height) {
  ChartShape shape;
  shape.piece = piece;
  const int32_t ring_count = piece.last_row - piece.first_row + 1;
  shape.ring_width.resize(ring_count);
  shape.ring_y.resize(ring_count);
  for (int32_t i = 0; i < ring_count; ++i) {
    shape.ring_width[i] = ring_width(strip.rings[piece.first_row + i], scale);
    shape.width = std::max(shape.width, shape.ring_width[i]);
  }
  shape.root_cap = piece.has_root_cap ? 0.25 * shape.ring_width.front() : 0.0;
  shape.tip_cap = piece.has_tip_cap ? 0.25 * shape.ring_width.back() : 0.0;
  double walls = 0.0;
  for (int32_t row = piece.first_row; row < piece.last_row; ++row) {
    walls += lengths[row];
  }
  const double caps = shape.root_cap + shape.tip_cap;
  const double stretch =
      std::clamp(walls, kMinWidth, std::max(max_height - caps, kMinWidth)) / walls;
  shape.ring_y[0] = shape.root_cap;
  for (int32_t i = 1; i < ring_count; ++i) {
    shape.ring_y[i] = shape.ring_y[i - 1] + stretch * lengths[piece.first_row + i - 1];
  }
  shape.height = shape.ring_y.back() + shape.tip_cap;
  return shape;
}

PackShape footprint(const ChartShape& shape, const Strip& strip, int cell_size) {
  const double cell = cell_size;
  PackShape outline;
  outline.width = static_cast<int>(std::ceil(shape.width / cell - kTouch));
  outline.height = static_cast<int>(std::ceil(shape.height / cell - kTouch));
  outline.begin.assign(outline.width, outline.height);
  outline.end.assign(outline.width, 0);
  const int gutter = shape.width > kWideChart ? 2 : 1;
  outline.gutter = (gutter + cell_size - 1) / cell_size;
  for (size_t i = 0; i + 1 < shape.ring_y.size(); ++i) {
    cover(outline, shape.ring_y[i], shape.ring_y[i + 1], shape.ring_width[i],
          shape.ring_width[i + 1], cell);
  }
  const StripPiece& piece = shape.piece;
  if (shape.root_cap > 0.0) {
    const double width = cap_width(strip.rings[piece.first_row], shape.ring_width.front());
    cover(outline, 0.0, shape.root_cap, width, width, cell);
  }
  if (shape.tip_cap > 0.0) {
    const double width = cap_width(strip.rings[piece.last_row], shape.ring_width.back());
    cover(outline, shape.ring_y.back(), shape.height, width, width, cell);
  }
  return outline;
}

void write_chart_uvs(TreeMesh& mesh, const Strip& strip, const ChartShape& shape, int32_t seam,
                     const PackShape& outline, const Placement& placement, int resolution,
                     int cell_size) {
  const StripPiece& piece = shape.piece;
  const double full_width = static_cast<double>(outline.width) * cell_size;
  const double full_height = static_cast<double>(outline.height) * cell_size;
  const double texels = resolution;
  // Turned by half a turn, the straight edge of the outline comes to lie on the other side.
  const bool straight_right = placement.columns_reversed != placement.rows_reversed;
  const auto to_map = [&](double x, double y) {
    if (placement.rows_reversed) {
      x = full_width - x;
      y = full_height - y;
    }
    return glm::vec2((x + static_cast<double>(placement.x) * cell_size) / texels,
                     (y + static_cast<double>(placement.y) * cell_size) / texels);
  };
  const auto column_x = [&](int ring, double share) {
    const double width = shape.ring_width[ring];
    return (straight_right ? full_width - width : 0.0) + share * width;
  };
  std::array<double, kSides + 1> bottom_shares = column_shares(strip.rings[piece.first_row], seam);
  for (int32_t row = piece.first_row; row < piece.last_row; ++row) {
    const int ring = row - piece.first_row;
    const auto top_shares = column_shares(strip.rings[row + 1], seam);
    for (int column = 0; column < kSides; ++column) {
      const int side = (seam + column) % kSides;
      const int next = (side + 1) % kSides;
      const StripCell& cell = strip.rows[row].cells[side];
      const double x0 = column_x(ring, bottom_shares[column]);
      const double x1 = column_x(ring, bottom_shares[column + 1]);
      const double x2 = column_x(ring + 1, top_shares[column + 1]);
      const double x3 = column_x(ring + 1, top_shares[column]);
      const double y0 = shape.ring_y[ring];
      const double y1 = shape.ring_y[ring + 1];
      if (cell.wall >= 0) {
        mesh.uv_snow[cell.wall] = {to_map(x0, y0), to_map(x1, y0), to_map(x2, y1), to_map(x3, y1)};
        continue;
      }
      if (cell.empty()) {
        continue;
      }
      const std::array<int32_t, 4> corners{
          strip.rings[row].corners[side], strip.rings[row].corners[next],
          strip.rings[row + 1].corners[next], strip.rings[row + 1].corners[side]};
      const HoleRect hole = locate_hole(mesh, cell, corners);
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
      for (const int32_t inset : cell.insets) {
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
  // A cap hangs on the end's side along the straight edge, where the strip leaves room for it.
  const int cap_column = straight_right ? kSides - 1 : 0;
  const int cap_side = (seam + cap_column) % kSides;
  const auto write_cap = [&](int32_t quad, int ring, double base_y, double far_y) {
    const StripRing& corners = strip.rings[piece.first_row + ring];
    const auto shares = column_shares(corners, seam);
    const double left = column_x(ring, shares[cap_column]);
    const double right = column_x(ring, shares[cap_column + 1]);
    for (int i = 0; i < kSides; ++i) {
      // Seen from outside, the far edge of a tip's cap carries the next two corners in the limb's
      // order; a root's cap is seen from the other end.
      const int32_t vertex = mesh.quads[quad][i];
      const auto at = std::find(corners.corners.begin(), corners.corners.end(), vertex);
      const int corner = static_cast<int>(at - corners.corners.begin());
      const int step = (corner - cap_side + kSides) % kSides;
      const double x = step == 1 || step == 2 ? right : left;
      mesh.uv_snow[quad][i] = to_map(x, step < 2 ? base_y : far_y);
    }
  };
  if (piece.has_root_cap) {
    write_cap(strip.root_cap, 0, shape.ring_y.front(), 0.0);
  }
  if (piece.has_tip_cap) {
    write_cap(strip.tip_cap, static_cast<int>(shape.ring_y.size()) - 1, shape.ring_y.back(),
              shape.height);
  }
}

}  // namespace snowbough::tree
