#include "tree/read/plausible.h"

#include <algorithm>
#include <cstddef>

#include "tree/skeleton/centreline.h"

namespace snowbough::tree {
namespace {

constexpr size_t kFewBranches = 4;
/// Ends whose radii differ by less than this share are equally thick.
constexpr float kEqual = 0.95f;
/// Share of the branches that do not taper from which on they are bars.
constexpr double kBars = 0.75;
/// A limb is thinner than what it stands on if its radius is below this share of that one's.
constexpr float kThinner = 0.8f;
/// Share of the branches that stand on thicker ones below which they are no limbs.
constexpr double kStandOnThicker = 0.5;

bool tapers(const Branch& branch) {
  const auto [thin, thick] = std::minmax_element(branch.radii.begin(), branch.radii.end());
  return *thin < kEqual * *thick;
}

std::string of(size_t count, size_t all) {
  return std::to_string(count) + " of its " + std::to_string(all);
}

}  // namespace

std::string why_no_tree(const std::vector<Branch>& branches) {
  if (branches.size() < kFewBranches) return "";
  size_t bars = 0;
  size_t standing = 0;
  size_t on_thicker = 0;
  for (const Branch& branch : branches) {
    bars += tapers(branch) ? 0 : 1;
    if (branch.parent < 0) continue;
    ++standing;
    const Branch& parent = branches[branch.parent];
    const float there = radius_at(parent, nearest_place(parent, branch.attach_point));
    on_thicker += branch.radii.front() < kThinner * there ? 1 : 0;
  }
  if (static_cast<double>(bars) < kBars * static_cast<double>(branches.size()) ||
      static_cast<double>(on_thicker) >=
          kStandOnThicker * static_cast<double>(branches.size() - 1)) {
    return "";
  }
  return of(bars, branches.size()) +
         " pieces are bars, as thick at one end as at the other, and only " +
         of(on_thicker, standing) + " that stand on others are thinner than those";
}

}  // namespace snowbough::tree
