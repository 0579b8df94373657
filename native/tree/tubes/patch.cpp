#include "tree/tubes/patch.h"

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <stdexcept>
#include <string>

namespace snowbough::tree {
namespace {

using Place = PatchVertex::Place;

int log2_of(int power) {
  return std::countr_zero(static_cast<unsigned>(power));
}

void check(const PatchCuts& cuts) {
  const auto power = [](int n) { return n > 0 && std::has_single_bit(static_cast<unsigned>(n)); };
  const int apart = std::abs(cuts.left - cuts.right);
  if (!power(cuts.low) || !power(cuts.high) || cuts.strips() < 1 || cuts.plain < 0 ||
      cuts.strips() < halvings(cuts.low, cuts.high) + cuts.plain ||
      apart != (is_odd(cuts.low, cuts.high) ? 1 : 0)) {
    throw std::invalid_argument("a patch cannot be cut into " + std::to_string(cuts.low) + ", " +
                                std::to_string(cuts.right) + ", " + std::to_string(cuts.high) +
                                " and " + std::to_string(cuts.left) + " pieces");
  }
}

/// Numbers a patch's vertices by line and step.
class Lines {
 public:
  Lines(const PatchCuts& cuts, Patch& patch) : cuts_(cuts), strips_(cuts.strips()) {
    odd_ = is_odd(cuts.low, cuts.high) ? odd_strip(cuts) : strips_;
    first_inside_.assign(strips_ + 1, 0);
    for (int line = 1; line < strips_; ++line) {
      first_inside_[line] = static_cast<int32_t>(patch.inside.size());
      const int across = at(line);
      for (int step = 1; step < across; ++step) {
        patch.inside.push_back({line, step, across});
      }
    }
  }

  int at(int line) const { return quads_across(cuts_, line); }

  PatchVertex vertex(int line, int step) const {
    if (line == 0) return {Place::kLow, step};
    if (line == strips_) return {Place::kHigh, step};
    if (step == 0) return {Place::kLeft, on_side(line, cuts_.left)};
    if (step == at(line)) return {Place::kRight, on_side(line, cuts_.right)};
    return {Place::kInside, first_inside_[line] + step - 1};
  }

  /// The additional vertex beside the odd strip.
  PatchVertex extra() const {
    return {cuts_.left > cuts_.right ? Place::kLeft : Place::kRight, odd_ + 1};
  }
  bool extra_is_left() const { return cuts_.left > cuts_.right; }

 private:
  int on_side(int line, int pieces) const {
    return pieces > strips_ && line > odd_ ? line + 1 : line;
  }

  PatchCuts cuts_;
  int strips_;
  int odd_;
  std::vector<int32_t> first_inside_;
};

}  // namespace

int halvings(int a, int b) {
  return std::abs(log2_of(a) - log2_of(b));
}

bool is_odd(int low, int high) {
  return low != high && std::min(low, high) == 1;
}

int quads_across(const PatchCuts& cuts, int line) {
  const int steps = halvings(cuts.low, cuts.high);
  return cuts.high < cuts.low
             ? cuts.low >> std::clamp(line - (cuts.strips() - steps - cuts.plain), 0, steps)
             : cuts.low << std::clamp(line - cuts.plain, 0, steps);
}

int odd_strip(const PatchCuts& cuts) {
  return cuts.high < cuts.low ? cuts.strips() - 1 - cuts.plain : cuts.plain;
}

int64_t count_quads(const PatchCuts& cuts) {
  int64_t count = 0;
  const int strips = cuts.strips();
  for (int strip = 0; strip < strips; ++strip) {
    const int a = quads_across(cuts, strip);
    const int b = quads_across(cuts, strip + 1);
    const int fewer = std::min(a, b);
    count += a == b ? a : fewer == 1 ? 2 : fewer / 2 * 3;
  }
  return count;
}

void cut_patch(const PatchCuts& cuts, Patch& patch) {
  check(cuts);
  patch.quads.clear();
  patch.inside.clear();
  const Lines lines(cuts, patch);
  auto& quads = patch.quads;
  for (int strip = 0; strip < cuts.strips(); ++strip) {
    const int across = lines.at(strip), above = lines.at(strip + 1);
    const auto a = [&](int step) { return lines.vertex(strip, step); };
    const auto b = [&](int step) { return lines.vertex(strip + 1, step); };
    const PatchVertex x = lines.extra();
    if (across == above) {
      for (int i = 0; i < across; ++i) {
        quads.push_back({a(i), a(i + 1), b(i + 1), b(i)});
      }
    } else if (across == 1 && lines.extra_is_left()) {
      quads.push_back({a(0), a(1), b(2), b(1)});
      quads.push_back({x, a(0), b(1), b(0)});
    } else if (across == 1) {
      quads.push_back({a(0), a(1), b(1), b(0)});
      quads.push_back({x, b(2), b(1), a(1)});
    } else if (above == 1 && lines.extra_is_left()) {
      quads.push_back({a(1), a(2), b(1), b(0)});
      quads.push_back({x, a(0), a(1), b(0)});
    } else if (above == 1) {
      quads.push_back({a(0), a(1), b(1), b(0)});
      quads.push_back({a(1), a(2), x, b(1)});
    } else if (above > across) {
      for (int i = 0; i < across; i += 2) {
        quads.push_back({a(i), a(i + 1), b(2 * i + 1), b(2 * i)});
        quads.push_back({a(i + 1), b(2 * i + 3), b(2 * i + 2), b(2 * i + 1)});
        quads.push_back({a(i + 1), a(i + 2), b(2 * i + 4), b(2 * i + 3)});
      }
    } else {
      for (int i = 0; i < above; i += 2) {
        quads.push_back({a(2 * i), a(2 * i + 1), b(i + 1), b(i)});
        quads.push_back({a(2 * i + 2), a(2 * i + 3), b(i + 1), a(2 * i + 1)});
        quads.push_back({a(2 * i + 3), a(2 * i + 4), b(i + 2), b(i + 1)});
      }
    }
  }
}

}  // namespace snowbough::tree
