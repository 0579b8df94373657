#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace snowbough::snow {

/// What the wind meets in a cell: ground that takes snow, an obstacle, or nothing.
struct DriftCell {
  /// Ground seen from above in m2; 0: none.
  double ground = 0.0;
  /// Height of its snow's surface, or of the obstacle's top, in metres.
  double top = 0.0;
  /// Snow in m3 that the wind can take.
  double loose = 0.0;
  /// Out: snow in m3 that comes, or leaves if negative.
  double change = 0.0;
  bool is_obstacle = false;

  bool is_empty() const { return !(ground > 0.0) && !is_obstacle; }
};

/// Square cells in the axes of the wind: columns follow each other downwind, rows lie side by side.
struct DriftGrid {
  int32_t columns = 0;
  int32_t rows = 0;
  /// Edge of a cell in metres.
  double cell = 0.0;
  std::vector<DriftCell> cells;

  DriftCell& at(int32_t column, int32_t row) {
    return cells[static_cast<size_t>(column) * static_cast<size_t>(rows) +
                 static_cast<size_t>(row)];
  }
};

/// Moves snow over the grid. `flux`: snow in m3 that the wind carries past each metre across it on
/// open ground. Above each cell the carried snow approaches what the wind can carry there: too much
/// settles within a saturation length (K. Kroy, G. Sauermann, H. Herrmann, Minimal model for sand
/// dunes, 2002); what is missing is picked up over the far longer fetch of blowing snow (M.
/// Takeuchi, Vertical profile and horizontal increase of drift-snow transport, 1980), so that no
/// hollow forms where a shelter ends. The wind carries less in the shelter of what stands upwind,
/// by the steepest angle up to it (A. Winstral, K. Elder, R. Davis, Spatial snow modeling of
/// wind-redistributed snow using terrain-based parameters, 2002), and digs before obstacles. Open
/// ground stays as it is, to the bit. Returns the snow in m3 that leaves the grid less what enters
/// it.
double transport(DriftGrid& grid, double flux);

}  // namespace snowbough::snow
