#include "tree/tubes/cuts.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <stdexcept>
#include <utility>

#include "tree/tubes/row_turns.h"

namespace snowbough::tree {
namespace {

using Part = FacePart;

/// A tenth more sides than wanted are not worth twice as many.
constexpr double kSpareSides = 1.15;
/// Rows are no shorter than this share of the limb's radius, unless the base's are.
constexpr double kShortestRow = 0.12;
/// Beside a fork rows are as long as this many of the child's sides, over so many of the radii of
/// its base: on the child and on its parent. Where the child leans along its parent the crotch
/// lies further out: by so many radii for each that it goes forward while it rises by one, of which
/// at most kFlattest count.
constexpr double kForkRow = 1.0;
constexpr double kForkReachOnChild = 2.2;
constexpr double kForkReachOnParent = 1.3;
constexpr double kForkReachAslant = 1.5;
constexpr double kFlattest = 3.0;
/// A limb of four sides has turned from its hole's corners to its own within so many radii, or
/// within this share of its first row.
constexpr double kTurnedShare = 0.15;
/// Pieces are worth a change of sides further from the edge with fewer when longer by this factor.
constexpr double kLonger = 1.25;
/// A row that tapers to less than this share has room for a change of sides where it is wide.
constexpr double kPointed = 0.5;
/// In rows shorter than so many sides of the end with fewer their number stays the same.
constexpr double kShortChange = 2.0;
/// The side error grows by this factor, at most so often, until the budget is kept.
constexpr double kCoarser = 1.12;
constexpr int kMostSteps = 90;

std::vector<double> evenly(int count) {
  std::vector<double> at;
  at.reserve(static_cast<size_t>(count) + 1);
  for (int i = 0; i <= count; ++i) {
    at.push_back(static_cast<double>(i) / count);
  }
  return at;
}

/// The same places counted from the other end.
void turn_round(std::vector<double>& at) {
  std::reverse(at.begin(), at.end());
  for (double& share : at) share = 1.0 - share;
}

int power_of_two_from(double wanted, int most) {
  int count = 1;
  while (count < most && count * kSpareSides < wanted) {
    count *= 2;
  }
  return count;
}

class Cutter {
 public:
  Cutter(const Surface& surface, const Edges& edges, const std::vector<LimbShape>& shapes,
         double height, const DetailSettings& settings)
      : surface_(surface), edges_(edges), shapes_(shapes), height_(height), settings_(settings) {
    const size_t count = surface.limbs.size();
    hole_of_.assign(count, -1);
    leaving_.resize(count);
    turns_.resize(count);
    for (size_t j = 0; j < surface.junctions.size(); ++j) {
      const Junction& junction = surface.junctions[j];
      hole_of_[junction.child] = static_cast<int32_t>(j);
      leaving_[junction.parent].push_back(static_cast<int32_t>(j));
    }
    for (size_t b = 0; b < count; ++b) {
      for (size_t row = 0; row + 1 < surface.limbs[b].rings.size(); ++row) {
        turns_[b].push_back(row_turns(shapes[b], row));
      }
    }
  }

  SurfaceCuts cut(double error) {
    cuts_ = {};
    choose_sides(error);
    choose_rows();
    cut_edges();
    for (size_t f = 0; f < surface_.quads.size(); ++f) {
      cuts_.quads += count_quads(patch_cuts(cuts_, edges_, f));
    }
    return std::move(cuts_);
  }

 private:
  static double radius_of(const Ring& ring) { return ring.corner * std::sqrt(2.0 / M_PI); }

  /// Of the child, where it leaves the hole.
  int across_child(int32_t child) const { return cuts_.across[child].front(); }

  /// Length of one of a child's sides at its base.
  double child_side(int32_t child) const {
    const Ring& hole = surface_.limbs[child].rings.front();
    return 0.5 * M_PI * radius_of(hole) / across_child(child);
  }

  /// How far a child goes along its parent, towards the tip, while it rises by one.
  double leaning(const Junction& junction) const {
    const std::vector<Ring>& rings = surface_.limbs[junction.child].rings;
    const glm::dvec3 way = rings[1].centre - rings[0].centre;
    const double rise = std::max(glm::dot(way, rings[0].normal), 0.0);
    const double along = glm::dot(way, surface_.limbs[junction.parent].rings[junction.row].normal);
    return std::abs(along) < kFlattest * rise ? along / rise : std::copysign(kFlattest, along);
  }

  void choose_sides(double error) {
    const int most = settings_.most_sides / 4;
    const size_t count = surface_.limbs.size();
    cuts_.across.resize(count);
    // By the lowest vertex of a ring that a child shares with its parent: which ring that is.
    std::vector<std::pair<int32_t, int32_t>> ends(surface_.vertices.size(), {-1, -1});
    for (size_t b = 0; b < count; ++b) {
      const LimbSurface& limb = surface_.limbs[b];
      for (const Ring& ring : limb.rings) {
        // The middle of one of n sides lies (pi / n)^2 / 2 of the radius inside.
        const double sides = M_PI * std::sqrt(radius_of(ring) / (2.0 * error));
        cuts_.across[b].push_back(power_of_two_from(0.25 * sides, most));
      }
      if (hole_of_[b] >= 0) {
        // Parents come first. With four sides a fork has no room for a fillet.
        const Junction& junction = surface_.junctions[hole_of_[b]];
        const int parent = cuts_.across[junction.parent][junction.row];
        if (parent > 1 && radius_of(limb.rings[0]) > kLeastFork * height_) {
          cuts_.across[b][1] = std::max(cuts_.across[b][1], 2);
        }
        cuts_.across[b][0] = cuts_.across[b][1];
      }
      const auto ring_of = static_cast<int32_t>(limb.rings.size()) - 1;
      ends[limb.rings.back().vertices[0]] = {static_cast<int32_t>(b), ring_of};
    }
    // Parents come first.
    for (size_t b = 0; b < count; ++b) {
      if (surface_.limbs[b].continues_parent) {
        const auto [limb, ring] = ends[surface_.limbs[b].rings[0].vertices[0]];
        int& end = cuts_.across[limb][ring];
        end = cuts_.across[b][0] = std::max(end, cuts_.across[b][0]);
      }
      keep_sides_in_short_rows(b);
    }
  }

  /// Knuckles and short rows have as many sides at both ends.
  void keep_sides_in_short_rows(size_t limb) {
    const std::vector<Ring>& rings = surface_.limbs[limb].rings;
    std::vector<int>& across = cuts_.across[limb];
    std::vector<uint8_t> same(rings.size() - 1, 0);
    for (const int32_t j : leaving_[limb]) same[surface_.junctions[j].row] = 1;
    // The first ring has those of a hole's next, or its parent's.
    const size_t first = hole_of_[limb] >= 0 || surface_.limbs[limb].continues_parent ? 1 : 0;
    const auto keep = [&](size_t row) {
      const size_t fewer = across[row] < across[row + 1] ? row : row + 1;
      const double side = 0.5 * M_PI * radius_of(rings[fewer]) / across[fewer];
      if (same[row] != 0 || row_length(limb, row) < kShortChange * side) {
        across[row] = across[row + 1] = std::max(across[row], across[row + 1]);
      }
    };
    for (size_t row = first; row + 1 < rings.size(); ++row) keep(row);
    for (size_t row = rings.size() - 1; row-- > first;) keep(row);
    if (hole_of_[limb] >= 0) across[0] = across[1];
  }

  double row_length(size_t limb, size_t row) const {
    const std::vector<Ring>& rings = surface_.limbs[limb].rings;
    return glm::distance(rings[row].centre, rings[row + 1].centre);
  }

  /// Pieces of one side of a hole, from its corner `side` to the next.
  int hole_side(const Junction& junction, int side) const {
    if (junction.inset) return across_child(junction.child);
    return side % 2 == 0 ? cuts_.across[junction.parent][junction.row]
                         : static_cast<int>(cuts_.rows[junction.parent][junction.row].size()) - 1;
  }

  void choose_rows() {
    cuts_.rows.resize(surface_.limbs.size());
    cuts_.plain.resize(surface_.limbs.size());
    // Parents come first: what a child starts from is known.
    for (size_t b = 0; b < surface_.limbs.size(); ++b) {
      const size_t rows = shapes_[b].row_count();
      std::vector<uint8_t> knuckle(rows, 0);
      std::vector<RowSamples> wanted(turns_[b]);
      for (size_t row = 0; row < rows; ++row) {
        const int sides = std::max(cuts_.across[b][row], cuts_.across[b][row + 1]);
        const double turn = sides > 1 ? settings_.turn : settings_.thin_turn;
        for (double& value : wanted[row].values) value /= turn;
      }
      cuts_.rows[b].resize(rows);
      for (const int32_t j : leaving_[b]) {
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
      if (hole_of_[b] >= 0 && across_child(static_cast<int32_t>(b)) > 1) {
        const auto child = static_cast<int32_t>(b);
        const double lean = std::abs(leaning(surface_.junctions[hole_of_[b]]));
        const double reach = (kForkReachOnChild + kForkReachAslant * lean) *
                             radius_of(surface_.limbs[b].rings.front());
        want_near(b, -1, 1, reach, kForkRow * child_side(child), wanted);
      } else if (hole_of_[b] >= 0) {
        // Of four sides, it turns from the hole's corners to its own there: not on the whole row.
        const double pieces =
            std::clamp(shapes_[b].hole_twist() / settings_.thin_turn - 0.35, 0.0, 1.0);
        const double reach =
            std::max(kForkReachOnChild * radius_of(surface_.limbs[b].rings.front()),
                     kTurnedShare * row_length(b, 0));
        if (pieces > 0.0) want_near(b, -1, 1, reach, reach / pieces, wanted);
      }
      for (size_t row = 0; row < rows; ++row) {
        cuts_.rows[b][row] = knuckle[row] != 0
                                 ? evenly(knuckle_pieces(b, row))
                                 : spread_pieces(wanted[row], pieces(b, row, wanted[row]));
        cuts_.plain[b].push_back(plain_strips(b, row));
      }
    }
  }

  /// Wants pieces of a length within `reach` of a row, going on from it one way or the other.
  void want_near(size_t limb, int32_t row, int step, double reach, double piece,
                 std::vector<RowSamples>& wanted) const {
    for (row += step; row >= 0 && row < static_cast<int32_t>(wanted.size()) && reach > 0.0;
         row += step) {
      const double length = row_length(limb, row);
      RowSamples& samples = wanted[row];
      const size_t count = samples.values.size();
      double way = 0.0;
      for (size_t i = 0; i < count && way < reach; ++i) {
        const size_t k = step > 0 ? i : count - 1 - i;
        const double sample = length * (samples.at[k + 1] - samples.at[k]);
        samples.values[k] = std::max(samples.values[k], std::min(sample, reach - way) / piece);
        way += sample;
      }
      reach -= length;
    }
  }

  int pieces(size_t limb, size_t row, const RowSamples& wanted) const {
    const double sum = wanted.total();
    const std::vector<Ring>& rings = surface_.limbs[limb].rings;
    const double radius = std::max(radius_of(rings[row]), radius_of(rings[row + 1]));
    const double room = row_length(limb, row) / (kShortestRow * radius);
    int count = std::max(1, static_cast<int>(std::ceil(std::min({sum, room, 64.0}) - 1e-9)));
    const int high = cuts_.across[limb][row + 1];
    if (row == 0 && hole_of_[limb] >= 0) {
      const Junction& junction = surface_.junctions[hole_of_[limb]];
      for (int side = 0; side < 4; ++side) {
        count = std::max(count, halvings(hole_side(junction, side), high));
      }
    } else {
      const int steps = halvings(cuts_.across[limb][row], high);
      const bool pointed = tapering(limb, row, 0.0, 1.0) < kPointed;
      count = std::max(count, steps + (steps > 0 && pointed ? 1 : 0));
    }
    return count;
  }

  /// The smaller of a limb's radii at two places of a row, as a share of the larger one.
  double tapering(size_t limb, size_t row, double a, double b) const {
    const auto [small, large] =
        std::minmax({shapes_[limb].radius(row, a), shapes_[limb].radius(row, b)});
    return large > 0.0 ? small / large : 1.0;
  }

  /// Where a limb's sides change their number: in the longest pieces of the row, between which it
  /// turns least, and that taper least; in short ones they would show as a knot, and of those that
  /// run to a point the first is as wide as the limb and faces aside.
  int plain_strips(size_t limb, size_t row) const {
    const int low = cuts_.across[limb][row], high = cuts_.across[limb][row + 1];
    const int steps = halvings(low, high);
    if (steps == 0 || (row == 0 && hole_of_[limb] >= 0)) return 0;
    const std::vector<double>& at = cuts_.rows[limb][row];
    const auto strips = static_cast<int>(at.size()) - 1;
    int best = 0;
    double longest = 0.0;
    for (int plain = 0; plain + steps <= strips; ++plain) {
      const int first = high < low ? strips - steps - plain : plain;
      double shortest = 1.0;
      for (int strip = first; strip < first + steps; ++strip) {
        const double length = at[strip + 1] - at[strip];
        shortest = std::min(shortest, length * tapering(limb, row, at[strip], at[strip + 1]));
      }
      if (shortest > kLonger * longest) {
        longest = shortest;
        best = plain;
      }
    }
    return best;
  }

  /// A power of two, so that what grows out of the row's side can start from it. A child of four
  /// sides has no fillet that more pieces would serve.
  int knuckle_pieces(size_t limb, size_t row) const {
    const double length = row_length(limb, row);
    double wanted = 1.0;
    int most = 1;
    for (auto j = first_leaving(limb, row, 0);
         j != leaving_[limb].end() && surface_.junctions[*j].row == static_cast<int32_t>(row);
         ++j) {
      const int32_t child = surface_.junctions[*j].child;
      if (across_child(child) == 1) continue;
      wanted = std::max(wanted, length / (kForkRow * child_side(child)));
      most = std::max(most, 2 * across_child(child));
    }
    return power_of_two_from(wanted, std::min(most, settings_.most_sides / 4));
  }

  /// Cuts the edge of a face from corner k to k + 1 into so many pieces; `at` says where. Most
  /// edges are met twice.
  template <typename At>
  void set_edge(size_t face, int k, size_t pieces, const At& at) {
    const int32_t e = edges_.of_face[face][k];
    std::vector<double>& edge = cuts_.edges[e];
    if (edge.empty()) {
      edge = at();
      if (surface_.quads[face][k] != edges_.all[e].a) turn_round(edge);
    } else if (edge.size() != pieces + 1) {
      throw std::logic_error("two faces cut the edge between them differently");
    }
  }

  void set_evenly(size_t face, int k, int pieces) {
    set_edge(face, k, static_cast<size_t>(pieces), [&] { return evenly(pieces); });
  }

  /// The side of a row, or of an inset, that lies between two patches.
  /// @param extra  it takes a level more: with_extra.
  /// @param down  the edge runs against the levels.
  void set_side(size_t face, int k, const std::vector<double>& levels, bool extra, bool thinner,
                int plain, bool down) {
    set_edge(face, k, levels.size() - 1 + (extra ? 1 : 0), [&] {
      std::vector<double> at = extra ? with_extra(levels, thinner, plain) : levels;
      if (down) turn_round(at);
      return at;
    });
  }

  /// Four patches around a limb or around a hole: per corner, 1 where its edge takes a piece more.
  static std::array<int, 4> odd_corners(const std::array<int, 4>& low,
                                        const std::array<int, 4>& high) {
    std::array<int, 4> odd{};
    for (int side = 0; side < 3; ++side) {
      odd[side + 1] = odd[side] ^ (is_odd(low[side], high[side]) ? 1 : 0);
    }
    return odd;
  }

  /// The levels of a row with one more, in the middle of the strip that is odd.
  static std::vector<double> with_extra(const std::vector<double>& at, bool thinner, int plain) {
    std::vector<double> more(at);
    const size_t strip = thinner ? at.size() - 2 - plain : plain;
    more.insert(more.begin() + static_cast<std::ptrdiff_t>(strip) + 1,
                0.5 * (at[strip] + at[strip + 1]));
    return more;
  }

  void cut_edges() {
    cuts_.edges.resize(edges_.all.size());
    cuts_.face_plain.assign(surface_.quads.size(), 0);
    for (size_t f = 0; f < surface_.quads.size(); ++f) {
      const FaceOrigin& origin = surface_.origins[f];
      if (origin.part == Part::kWall) {
        cut_wall(f, origin);
      } else if (origin.part == Part::kInset) {
        cut_inset(f, origin);
      }
    }
    // What only caps have: the tips of limbs cut open.
    for (std::vector<double>& edge : cuts_.edges) {
      if (edge.empty()) edge = {0.0, 1.0};
    }
  }

  void cut_wall(size_t face, const FaceOrigin& origin) {
    const int32_t limb = origin.branch, row = origin.row;
    const int high = cuts_.across[limb][row + 1];
    std::array<int, 4> low{};
    low.fill(cuts_.across[limb][row]);
    if (row == 0 && hole_of_[limb] >= 0) {
      for (int side = 0; side < 4; ++side) {
        low[side] = hole_side(surface_.junctions[hole_of_[limb]], side);
      }
    }
    const std::array<int, 4> odd = odd_corners(low, {high, high, high, high});
    const std::vector<double>& levels = cuts_.rows[limb][row];
    const int plain = cuts_.plain[limb][row];
    cuts_.face_plain[face] = low[origin.side] == high ? 0 : plain;
    const int side = origin.side, next = (side + 1) % 4;
    set_evenly(face, 0, low[side]);
    set_side(face, 1, levels, odd[next] != 0, high == 1, plain, false);
    set_evenly(face, 2, high);
    set_side(face, 3, levels, odd[side] != 0, high == 1, plain, true);
  }

  void cut_inset(size_t face, const FaceOrigin& origin) {
    const Junction& junction = junction_at(origin);
    const int across = cuts_.across[origin.branch][origin.row];
    const int along = static_cast<int>(cuts_.rows[origin.branch][origin.row].size()) - 1;
    const int inner = across_child(junction.child);
    const std::array<int, 4> outer = {across, along, across, along};
    int strips = wanted_around(junction);
    for (const int pieces : outer) {
      strips = std::max(strips, halvings(pieces, inner));
    }
    const std::array<int, 4> odd = odd_corners(outer, {inner, inner, inner, inner});
    const std::vector<double> levels = evenly(strips);
    const int side = origin.inset, next = (side + 1) % 4;
    set_evenly(face, 0, outer[side]);
    set_side(face, 1, levels, odd[next] != 0, inner == 1, 0, false);
    set_evenly(face, 2, inner);
    set_side(face, 3, levels, odd[side] != 0, inner == 1, 0, true);
  }

  /// Strips around a hole in its inset.
  int wanted_around(const Junction& junction) const {
    const int across = across_child(junction.child);
    return across <= 1 ? 1 : across <= 2 ? 2 : 3;
  }

  const Junction& junction_at(const FaceOrigin& origin) const {
    const auto j = first_leaving(origin.branch, origin.row, origin.side);
    if (j == leaving_[origin.branch].end()) {
      throw std::logic_error("an inset without its junction");
    }
    return surface_.junctions[*j];
  }

  /// A limb's first junction at a row's side or after it; they stand in their order along the limb.
  std::vector<int32_t>::const_iterator first_leaving(size_t limb, size_t row, int side) const {
    return std::lower_bound(leaving_[limb].begin(), leaving_[limb].end(),
                            std::pair(static_cast<int32_t>(row), side),
                            [&](int32_t j, const std::pair<int32_t, int>& at) {
                              const Junction& junction = surface_.junctions[j];
                              return std::pair(junction.row, junction.side) < at;
                            });
  }

  const Surface& surface_;
  const Edges& edges_;
  const std::vector<LimbShape>& shapes_;
  double height_;
  const DetailSettings& settings_;
  /// Per branch: the junction it leaves from, or -1, and those of its children.
  std::vector<int32_t> hole_of_;
  std::vector<std::vector<int32_t>> leaving_;
  /// Per branch and row.
  std::vector<std::vector<RowSamples>> turns_;
  SurfaceCuts cuts_;
};

}  // namespace

PatchCuts patch_cuts(const SurfaceCuts& cuts, const Edges& edges, size_t face) {
  const auto pieces = [&](int k) {
    return static_cast<int>(cuts.edges[edges.of_face[face][k]].size()) - 1;
  };
  return {pieces(0), pieces(1), pieces(2), pieces(3), cuts.face_plain[face]};
}

SurfaceCuts cut_surface(const Surface& surface, const Edges& edges,
                        const std::vector<LimbShape>& shapes, double height,
                        const DetailSettings& settings) {
  const auto budget = std::max<int64_t>(
      settings.faces,
      static_cast<int64_t>(settings.per_base * static_cast<double>(surface.quads.size())));
  Cutter cutter(surface, edges, shapes, height, settings);
  const auto coarser = [&](int step) {
    return cutter.cut(settings.side_error * height * std::pow(kCoarser, step));
  };
  SurfaceCuts cuts = coarser(0);
  // The first step that keeps the budget: by steps twice as long each, and then by halves.
  int above = 0, step = 1;
  while (cuts.quads > budget && above < kMostSteps) {
    cuts = coarser(step);
    if (cuts.quads <= budget || step == kMostSteps) break;
    above = step;
    step = std::min(2 * step, kMostSteps);
  }
  for (int below = step; below - above > 1;) {
    const int middle = (above + below) / 2;
    SurfaceCuts between = coarser(middle);
    if (between.quads > budget) {
      above = middle;
    } else {
      below = middle;
      cuts = std::move(between);
    }
  }
  return cuts;
}

}  // namespace snowbough::tree
