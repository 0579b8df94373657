#include "tree/tubes/cuts.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace snowbough::tree {
namespace {

using Part = FacePart;

/// Allowed excess width of a strip around a hole over the parent's sides.
constexpr double kSpareSide = 0.25;
/// Factor by which the side error grows until the budget is met, and maximum number of times.
constexpr double kCoarser = 1.12;
constexpr int kMaxSteps = 90;

/// Reverses the positions.
void turn_round(std::vector<double>& at) {
  std::reverse(at.begin(), at.end());
  for (double& share : at) share = 1.0 - share;
}

class Cutter {
 public:
  Cutter(const Surface& surface, const Edges& edges, const std::vector<LimbShape>& shapes,
         double height, const DetailSettings& settings)
      : surface_(surface),
        edges_(edges),
        shapes_(shapes),
        height_(height),
        settings_(settings),
        holes_(surface) {
    turns_.resize(surface.limbs.size());
    for (size_t b = 0; b < surface.limbs.size(); ++b) {
      for (size_t row = 0; row + 1 < surface.limbs[b].rings.size(); ++row) {
        turns_[b].push_back(row_turns(shapes[b], row));
      }
    }
    for (const Junction& junction : surface.junctions) {
      double left = 1.0, right = 1.0;
      for (const glm::dvec2& corner : hole_place(surface, junction).corners) {
        left = std::min(left, corner.x);
        right = std::min(right, 1.0 - corner.x);
      }
      beside_hole_.push_back(std::max(left, right));
    }
  }

  /// The numbers of pieces for a side error, without their bounds.
  BaseCuts count(double error) {
    cuts_ = {};
    cuts_.across = count_sides(surface_, holes_, height_, settings_.most_sides, error);
    cuts_.along = cut_rows(surface_, holes_, shapes_, turns_, cuts_.across, settings_);
    cuts_.pieces.assign(edges_.all.size(), 0);
    cut_edges();
    for (size_t f = 0; f < surface_.quads.size(); ++f) {
      cuts_.quads += count_quads(patch_cuts(cuts_, edges_, f));
    }
    return std::move(cuts_);
  }

  /// The same cuts with the bounds of their pieces.
  BaseCuts cut(BaseCuts counted) {
    cuts_ = std::move(counted);
    cuts_.edges.resize(edges_.all.size());
    cut_edges();
    return std::move(cuts_);
  }

 private:
  /// Cuts the edge of a face from corner k to k + 1 into pieces, at `at` if bounds are wanted. Most
  /// edges are visited twice.
  template <typename At>
  void set_edge(size_t face, int k, int pieces, const At& at) {
    const int32_t e = edges_.of_face[face][k];
    if (cuts_.pieces[e] == 0) cuts_.pieces[e] = pieces;
    if (cuts_.pieces[e] != pieces) {
      throw std::logic_error("two faces cut the edge between them differently");
    }
    if (cuts_.edges.empty() || !cuts_.edges[e].empty()) return;
    cuts_.edges[e] = at();
    if (surface_.quads[face][k] != edges_.all[e].a) turn_round(cuts_.edges[e]);
  }

  void set_evenly(size_t face, int k, int pieces) {
    set_edge(face, k, pieces, [&] { return even_pieces(pieces); });
  }

  /// The side of a row, or of an inset, between two patches.
  /// @param lines  of a row; null for an inset, whose strips are even.
  /// @param extra  whether it has one more line: with_extra.
  /// @param down  whether the edge runs against the lines.
  void set_side(size_t face, int k, const std::vector<double>* lines, int strips, bool extra,
                bool thinner, int plain, bool down) {
    set_edge(face, k, strips + (extra ? 1 : 0), [&] {
      std::vector<double> at = lines != nullptr ? *lines : even_pieces(strips);
      if (extra) at = with_extra(at, thinner, plain);
      if (down) turn_round(at);
      return at;
    });
  }

  /// Four patches around a limb or a hole: per corner, 1 if its edge has one more piece.
  static std::array<int, 4> odd_corners(const std::array<int, 4>& low,
                                        const std::array<int, 4>& high) {
    std::array<int, 4> odd{};
    for (int side = 0; side < 3; ++side) {
      odd[side + 1] = odd[side] ^ (is_odd(low[side], high[side]) ? 1 : 0);
    }
    return odd;
  }

  /// The lines of a row with one more, in the middle of the odd strip.
  static std::vector<double> with_extra(const std::vector<double>& at, bool thinner, int plain) {
    std::vector<double> more(at);
    const size_t strip = thinner ? at.size() - 2 - plain : plain;
    more.insert(more.begin() + static_cast<std::ptrdiff_t>(strip) + 1,
                0.5 * (at[strip] + at[strip + 1]));
    return more;
  }

  void cut_edges() {
    cuts_.face_plain.assign(surface_.quads.size(), 0);
    for (size_t f = 0; f < surface_.quads.size(); ++f) {
      const FaceOrigin& origin = surface_.origins[f];
      if (origin.part == Part::kWall) {
        cut_wall(f, origin);
      } else if (origin.part == Part::kInset) {
        cut_inset(f, origin);
      }
    }
    // Edges that only caps have: the tips of limbs cut open.
    for (int32_t& pieces : cuts_.pieces) pieces = std::max(pieces, 1);
    for (std::vector<double>& edge : cuts_.edges) {
      if (edge.empty()) edge = {0.0, 1.0};
    }
  }

  void cut_wall(size_t face, const FaceOrigin& origin) {
    const int32_t limb = origin.branch, row = origin.row;
    const int high = cuts_.across[limb][row + 1];
    std::array<int, 4> low{};
    low.fill(cuts_.across[limb][row]);
    if (row == 0 && holes_.has_hole(limb)) {
      const Junction& junction = surface_.junctions[holes_.of[limb]];
      for (int side = 0; side < 4; ++side) {
        low[side] = hole_side(junction, side, cuts_.across, cuts_.along);
      }
    }
    const std::array<int, 4> odd = odd_corners(low, {high, high, high, high});
    const std::vector<double>* lines = &cuts_.along.rows[limb][row];
    const int strips = cuts_.along.strips(limb, row);
    const int plain = cuts_.along.plain[limb][row];
    cuts_.face_plain[face] = low[origin.side] == high ? 0 : plain;
    const int side = origin.side, next = (side + 1) % 4;
    set_evenly(face, 0, low[side]);
    set_side(face, 1, lines, strips, odd[next] != 0, high == 1, plain, false);
    set_evenly(face, 2, high);
    set_side(face, 3, lines, strips, odd[side] != 0, high == 1, plain, true);
  }

  void cut_inset(size_t face, const FaceOrigin& origin) {
    const int32_t j = junction_at(origin);
    const Junction& junction = surface_.junctions[j];
    const int across = cuts_.across[origin.branch][origin.row];
    const int along = cuts_.along.strips(origin.branch, origin.row);
    const int inner = cuts_.across[junction.child].front();
    const std::array<int, 4> outer = {across, along, across, along};
    int strips = wanted_around(j);
    for (const int pieces : outer) {
      strips = std::max(strips, halvings(pieces, inner));
    }
    const std::array<int, 4> odd = odd_corners(outer, {inner, inner, inner, inner});
    const int side = origin.inset, next = (side + 1) % 4;
    set_evenly(face, 0, outer[side]);
    set_side(face, 1, nullptr, strips, odd[next] != 0, inner == 1, 0, false);
    set_evenly(face, 2, inner);
    set_side(face, 3, nullptr, strips, odd[side] != 0, inner == 1, 0, true);
  }

  /// Number of strips around a hole in its inset: enough for the fillet, and so that none is wider
  /// than the parent's own sides at its widest. Otherwise it would lie inside the round limb, and
  /// the row beside it would face along the limb.
  int wanted_around(int32_t j) const {
    const Junction& junction = surface_.junctions[j];
    const int across = cuts_.across[junction.child].front();
    const double sides = beside_hole_[j] * cuts_.across[junction.parent][junction.row];
    return std::max(across <= 1   ? 1
                    : across <= 2 ? 2
                                  : 3,
                    static_cast<int>(std::ceil(sides - kSpareSide)));
  }

  int32_t junction_at(const FaceOrigin& origin) const {
    const auto j = holes_.first_leaving(origin.branch, origin.row, origin.side);
    if (j == holes_.leaving[origin.branch].end()) {
      throw std::logic_error("an inset has no junction");
    }
    return *j;
  }

  const Surface& surface_;
  const Edges& edges_;
  const std::vector<LimbShape>& shapes_;
  double height_;
  const DetailSettings& settings_;
  LimbHoles holes_;
  /// Per branch and row.
  std::vector<std::vector<RowSamples>> turns_;
  /// Per junction: the wider part of its side beside the hole, as a fraction.
  std::vector<double> beside_hole_;
  BaseCuts cuts_;
};

}  // namespace

PatchCuts patch_cuts(const BaseCuts& cuts, const Edges& edges, size_t face) {
  const auto pieces = [&](int k) { return static_cast<int>(cuts.pieces[edges.of_face[face][k]]); };
  return {pieces(0), pieces(1), pieces(2), pieces(3), cuts.face_plain[face]};
}

BaseCuts cut_base(const Surface& surface, const Edges& edges, const std::vector<LimbShape>& shapes,
                  double height, const DetailSettings& settings) {
  const auto budget = std::max<int64_t>(
      settings.faces,
      static_cast<int64_t>(settings.per_base * static_cast<double>(surface.quads.size())));
  Cutter cutter(surface, edges, shapes, height, settings);
  const auto coarser = [&](int step) {
    return cutter.count(settings.side_error * height * std::pow(kCoarser, step));
  };
  BaseCuts cuts = coarser(0);
  // The first step within the budget, by doubling steps, then bisection.
  int above = 0, step = 1;
  while (cuts.quads > budget && above < kMaxSteps) {
    cuts = coarser(step);
    if (cuts.quads <= budget || step == kMaxSteps) break;
    above = step;
    step = std::min(2 * step, kMaxSteps);
  }
  for (int below = step; below - above > 1;) {
    const int middle = (above + below) / 2;
    BaseCuts between = coarser(middle);
    if (between.quads > budget) {
      above = middle;
    } else {
      below = middle;
      cuts = std::move(between);
    }
  }
  return cutter.cut(std::move(cuts));
}

}  // namespace snowbough::tree
