#include "tree/tubes/row_cuts.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "tree/tubes/patch.h"

namespace snowbough::tree {
namespace {

/// Minimum length of a row relative to the limb's radius, unless the base's rows are shorter.
constexpr double kShortestRow = 0.12;
/// Beside a fork, length of rows in sides of the child, and their range in radii of its base: on
/// the child and on its parent. If the child leans along its parent, the crotch is farther out: by
/// this many radii per unit of slope, of which at most kFlattest count.
constexpr double kForkRow = 1.0;
constexpr double kForkReachOnChild = 2.2;
constexpr double kForkReachOnParent = 1.3;
constexpr double kForkReachAslant = 1.5;
constexpr double kFlattest = 3.0;
/// A four-sided limb turns from its hole's corners to its own within kTurnedShare of its first row.
/// From face to face it turns by half of that with one or two pieces, and by a third with three,
/// which it takes from kTwisted turns of a row on.
constexpr double kTurnedShare = 0.15;
constexpr double kTwisted = 3.5;
/// A piece farther from the edge with fewer quads is preferred for a change of sides if it is
/// longer by this factor.
constexpr double kLonger = 1.25;
/// Where a limb's number of sides halves, the sides of the other end face sideways: by a right
/// angle over the number of sides, of which this fraction is on the edge of the end with more.
constexpr double kMoreSides = 0.64;
/// At such a place limbs of four and eight sides turn by no more than that plus this many turns of
/// a row, using up to this many additional pieces.
constexpr double kBesideChange = 0.6;
constexpr int kMorePieces = 3;
/// Assumed length of the next row's piece while it is not cut.
constexpr double kNextPiece = 0.15;
/// A row that tapers to less than this fraction has room for a change of sides where it is wide.
constexpr double kPointed = 0.5;

class RowCutter {
 public:
  RowCutter(const Surface& surface, const LimbHoles& holes, const std::vector<LimbShape>& shapes,
            const std::vector<std::vector<RowSamples>>& turns, const SideCounts& across,
            const DetailSettings& settings)
      : surface_(surface),
        holes_(holes),
        shapes_(shapes),
        turns_(turns),
        across_(across),
        settings_(settings) {}

  RowCuts cut() {
    cuts_.rows.resize(surface_.limbs.size());
    cuts_.plain.resize(surface_.limbs.size());
    // Parents come first, so the start of a child is known.
    for (size_t b = 0; b < surface_.limbs.size(); ++b) {
      const size_t rows = shapes_[b].row_count();
      std::vector<uint8_t> knuckle(rows, 0);
      std::vector<RowSamples>& wanted = wanted_;
      wanted = turns_[b];
      for (size_t row = 0; row < rows; ++row) {
        const int sides = std::max(across_[b][row], across_[b][row + 1]);
        const double turn = sides > 1 ? settings_.turn : settings_.thin_turn;
        for (double& value : wanted[row].values) value /= turn;
      }
      cuts_.rows[b].resize(rows);
      for (const int32_t j : holes_.leaving[b]) {
        const Junction& junction = surface_.junctions[j];
        knuckle[junction.row] = 1;
        if (across_child(junction.child) > 1) {
          const double reach =
              kForkReachOnParent * radius_of(surface_.limbs[junction.child].rings.front());
          const double piece = kForkRow * child_side(junction.child);
          const double lean = kForkReachAslant * leaning(junction) *
                              radius_of(surface_.limbs[junction.child].rings.front());
          want_near(b, junction.row, -1, reach + std::max(-lean, 0.0), piece, wanted);
          want_near(b, junction.row, 1, reach + std::max(lean, 0.0), piece, wanted);
        }
      }
      if (holes_.has_hole(b) && across_child(static_cast<int32_t>(b)) > 1) {
        const auto child = static_cast<int32_t>(b);
        const double lean = std::abs(leaning(surface_.junctions[holes_.of[b]]));
        const double reach = (kForkReachOnChild + kForkReachAslant * lean) *
                             radius_of(surface_.limbs[b].rings.front());
        want_near(b, -1, 1, reach, kForkRow * child_side(child), wanted);
      } else if (holes_.has_hole(b)) {
        // A four-sided limb turns from the hole's corners to its own there, not over the whole row.
        const double turns = shapes_[b].hole_twist() / settings_.thin_turn;
        const double pieces = turns < kTwisted ? std::clamp(turns - 0.35, 0.0, 1.0)
                                               : std::max(3.0, 1.5 * turns / kTwisted);
        const double reach =
            std::max(kForkReachOnChild * radius_of(surface_.limbs[b].rings.front()),
                     kTurnedShare * row_length(surface_.limbs[b], 0));
        if (pieces > 0.0) want_near(b, -1, 1, reach, reach / pieces, wanted);
      }
      for (size_t row = 0; row < rows; ++row) {
        cuts_.plain[b].push_back(0);
        if (knuckle[row] != 0) {
          cuts_.rows[b][row] = even_pieces(knuckle_pieces(b, row));
        } else {
          cut_row(b, row, wanted[row]);
        }
      }
    }
    return std::move(cuts_);
  }

 private:
  /// The child's, where it leaves the hole.
  int across_child(int32_t child) const { return across_[child].front(); }

  /// Length of one of a child's sides at its base.
  double child_side(int32_t child) const {
    const Ring& hole = surface_.limbs[child].rings.front();
    return 0.5 * M_PI * radius_of(hole) / across_child(child);
  }

  /// How far a child moves along its parent, towards the tip, per unit of height.
  double leaning(const Junction& junction) const {
    const std::vector<Ring>& rings = surface_.limbs[junction.child].rings;
    const glm::dvec3 step = rings[1].centre - rings[0].centre;
    const double rise = std::max(glm::dot(step, rings[0].normal), 0.0);
    const double along = glm::dot(step, surface_.limbs[junction.parent].rings[junction.row].normal);
    return std::abs(along) < kFlattest * rise ? along / rise : std::copysign(kFlattest, along);
  }

  /// Requests pieces of a length within `reach` of a row, continuing from it in one direction.
  void want_near(size_t limb, int32_t row, int step, double reach, double piece,
                 std::vector<RowSamples>& wanted) const {
    for (row += step; row >= 0 && row < static_cast<int32_t>(wanted.size()) && reach > 0.0;
         row += step) {
      const double length = row_length(surface_.limbs[limb], row);
      RowSamples& samples = wanted[row];
      const size_t count = samples.values.size();
      double passed = 0.0;
      for (size_t i = 0; i < count && passed < reach; ++i) {
        const size_t k = step > 0 ? i : count - 1 - i;
        const double sample = length * (samples.at[k + 1] - samples.at[k]);
        samples.values[k] = std::max(samples.values[k], std::min(sample, reach - passed) / piece);
        passed += sample;
      }
      reach -= length;
    }
  }

  int pieces(size_t limb, size_t row, const RowSamples& wanted) const {
    const double sum = wanted.total();
    const std::vector<Ring>& rings = surface_.limbs[limb].rings;
    const double radius = std::max(radius_of(rings[row]), radius_of(rings[row + 1]));
    const double room = row_length(surface_.limbs[limb], row) / (kShortestRow * radius);
    int count = std::max(1, static_cast<int>(std::ceil(std::min({sum, room, 64.0}) - 1e-9)));
    const int high = across_[limb][row + 1];
    if (row == 0 && holes_.has_hole(limb)) {
      const Junction& junction = surface_.junctions[holes_.of[limb]];
      for (int side = 0; side < 4; ++side) {
        count = std::max(count, halvings(hole_side(junction, side, across_, cuts_), high));
      }
    } else {
      const int steps = halvings(across_[limb][row], high);
      const bool pointed = tapering(limb, row, 0.0, 1.0) < kPointed;
      count = std::max(count, steps + (steps > 0 && pointed ? 1 : 0));
    }
    return count;
  }

  /// Ratio of the smaller to the larger radius at two places of a row.
  double tapering(size_t limb, size_t row, double a, double b) const {
    const auto [small, large] =
        std::minmax({shapes_[limb].radius(row, a), shapes_[limb].radius(row, b)});
    return large > 0.0 ? small / large : 1.0;
  }

  /// Cuts a row, with more pieces than its turns need if its sides change next to a turn.
  void cut_row(size_t limb, size_t row, const RowSamples& wanted) {
    const int count = pieces(limb, row, wanted);
    std::vector<double>& at = cuts_.rows[limb][row];
    at = spread_pieces(wanted, count);
    if (across_[limb][row] == across_[limb][row + 1]) return;
    // Around a hole all sides have their own number; the limb's equals the next ring's from the
    // start.
    if (row == 0 && holes_.has_hole(limb)) return;
    Change change = best_change(limb, row, at);
    for (int more = 1; more <= kMorePieces && change.turn > change.most; ++more) {
      std::vector<double> finer = spread_pieces(wanted, count + more);
      const Change other = best_change(limb, row, finer);
      if (other.turn >= change.turn) continue;
      change = other;
      at = std::move(finer);
    }
    cuts_.plain[limb][row] = change.plain;
  }

  /// Strips before a limb's number of sides changes, the largest angle between its faces there, and
  /// the allowed angle.
  struct Change {
    int plain = 0;
    double turn = 1e300, most = 0.0;
  };

  /// Where a limb's number of sides changes: in the longest pieces of the row away from its bends,
  /// with the least taper. Short pieces would show a knot; in rows that run to a point, the first
  /// piece is as wide as the limb and faces sideways.
  Change best_change(size_t limb, size_t row, const std::vector<double>& at) const {
    const int low = across_[limb][row], high = across_[limb][row + 1];
    const int steps = halvings(low, high);
    const auto strips = static_cast<int>(at.size()) - 1;
    const std::vector<double> turns = turns_at(limb, row, at);
    // Per edge across the change, its faces' sideways turn.
    std::vector<double> aside(static_cast<size_t>(steps) + 1, 0.0);
    for (int step = 0; step < steps; ++step) {
      const int fewer = high < low ? low >> (step + 1) : low << step;
      const double angle = M_PI / (8.0 * fewer);
      aside[high < low ? step : step + 1] += kMoreSides * angle;
      aside[high < low ? step + 1 : step] += (1.0 - kMoreSides) * angle;
    }
    Change best;
    best.most = kMoreSides * M_PI / 8.0 + kBesideChange * settings_.turn;
    double longest = 0.0;
    for (int plain = 0; plain + steps <= strips; ++plain) {
      const int first = high < low ? strips - steps - plain : plain;
      double shortest = 1.0, turn = 0.0;
      for (int strip = first; strip < first + steps; ++strip) {
        const double length = at[strip + 1] - at[strip];
        shortest = std::min(shortest, length * tapering(limb, row, at[strip], at[strip + 1]));
      }
      for (int edge = 0; edge <= steps; ++edge) {
        turn = std::max(turn, turns[first + edge] + aside[edge]);
      }
      const bool fits = turn <= best.most, fitted = best.turn <= best.most;
      if (fits && fitted ? shortest > kLonger * longest : turn < best.turn) {
        longest = shortest;
        best.plain = plain;
        best.turn = turn;
      }
    }
    return best;
  }

  /// Turn in radians of a limb's sides at the cuts of a row, including its ends.
  std::vector<double> turns_at(size_t limb, size_t row, const std::vector<double>& at) const {
    const LimbShape& shape = shapes_[limb];
    std::vector<glm::dvec3> centres;
    std::vector<double> radii;
    const auto add = [&](size_t of_row, double share) {
      centres.push_back(shape.centre(of_row, share));
      radii.push_back(shape.radius(of_row, share));
    };
    // Rows are cut in order: the next one's cuts are unknown.
    const bool before = row > 0, after = row + 1 < shape.row_count();
    if (before) add(row - 1, cuts_.rows[limb][row - 1].end()[-2]);
    for (const double share : at) add(row, share);
    if (after) add(row + 1, kNextPiece);
    std::vector<double> turns(before ? 0 : 1, 0.0);
    for (size_t i = 1; i + 1 < centres.size(); ++i) {
      const glm::dvec3 in = centres[i] - centres[i - 1], out = centres[i + 1] - centres[i];
      const double taper = std::atan2(radii[i + 1] - radii[i], glm::length(out)) -
                           std::atan2(radii[i] - radii[i - 1], glm::length(in));
      turns.push_back(std::atan2(glm::length(glm::cross(in, out)), glm::dot(in, out)) +
                      std::abs(taper));
    }
    if (!after) turns.push_back(0.0);
    return turns;
  }

  /// A power of two, so that children of the row's side can start from it. A four-sided child has
  /// no fillet that needs more pieces.
  int knuckle_pieces(size_t limb, size_t row) const {
    const double length = row_length(surface_.limbs[limb], row);
    double wanted = 1.0;
    int most = 1;
    for (auto j = holes_.first_leaving(limb, row, 0);
         j != holes_.leaving[limb].end() && surface_.junctions[*j].row == static_cast<int32_t>(row);
         ++j) {
      const int32_t child = surface_.junctions[*j].child;
      if (across_child(child) == 1) continue;
      wanted = std::max(wanted, length / (kForkRow * child_side(child)));
      most = std::max(most, 2 * across_child(child));
    }
    return power_of_two_from(wanted, std::min(most, settings_.most_sides / 4));
  }

  const Surface& surface_;
  const LimbHoles& holes_;
  const std::vector<LimbShape>& shapes_;
  const std::vector<std::vector<RowSamples>>& turns_;
  const SideCounts& across_;
  const DetailSettings& settings_;
  /// Of the limb that is being cut; its memory serves the next.
  std::vector<RowSamples> wanted_;
  RowCuts cuts_;
};

}  // namespace

int hole_side(const Junction& junction, int side, const SideCounts& across, const RowCuts& cuts) {
  if (junction.inset) return across[junction.child].front();
  return side % 2 == 0 ? across[junction.parent][junction.row]
                       : cuts.strips(junction.parent, junction.row);
}

RowCuts cut_rows(const Surface& surface, const LimbHoles& holes,
                 const std::vector<LimbShape>& shapes,
                 const std::vector<std::vector<RowSamples>>& turns, const SideCounts& across,
                 const DetailSettings& settings) {
  return RowCutter(surface, holes, shapes, turns, across, settings).cut();
}

}  // namespace snowbough::tree
