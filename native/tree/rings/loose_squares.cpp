#include "tree/rings/loose_squares.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <numeric>
#include <tuple>

namespace snowbough::tree {
namespace {

/// Fewer turns than this tell nothing.
constexpr size_t kFewestTurns = 3;
/// Cosine between a plane's normal and a link from which on it may be one.
constexpr double kAcross = 0.5;
/// How much dearer a link is for each of its planes that it meets aslant (per 1 - cosine), and for
/// a jump of the radius (per e-fold, up to two of them). Chosen on AL06a with its squares shuffled,
/// where 20 to 30 are best.
constexpr double kSlantCost = 25.0;
constexpr double kRadiusCost = 0.7;
/// Best links that a plane remembers on either side.
constexpr size_t kBest = 12;
/// A link is no longer than this many times its neighbour in the row, ...
constexpr double kJump = 6.0;
/// ... and not this much longer than both. In three trees with their order kept, the longest was
/// 2.05 times as long.
constexpr double kJumpInside = 2.5;
/// A plane stands between two others if the way over it is no longer than this, ...
constexpr double kDetour = 1.08;
/// ... it is met this squarely, and its radius is within these factors of theirs.
constexpr double kSquarely = 0.85;
constexpr double kThinner = 0.7;
constexpr double kThicker = 1.4;
/// A link gives way to another one whose step, turn and taper fit their neighbours this much
/// better.
constexpr double kBetterFit = 0.6;
constexpr double kTurnMisfit = 4.0;
constexpr int kFitRounds = 4;
/// Within 15 degrees.
constexpr double kSquareCosine = 0.966;
/// Rows longer than this are not straightened further.
constexpr size_t kLongestImproved = 2000;

struct Plane {
  glm::dvec3 centre{0.0};
  /// Unit; zero for a plane without area, which ends a limb and is met squarely from anywhere.
  glm::dvec3 normal{0.0};
  double radius = 0.0;

  bool has_normal() const { return normal != glm::dvec3(0.0); }
  double across(const glm::dvec3& unit) const {
    return has_normal() ? std::abs(glm::dot(normal, unit)) : 1.0;
  }
  /// The side of the plane towards a direction; all of a plane without area is one side.
  int side(const glm::dvec3& towards) const { return glm::dot(normal, towards) < 0.0 ? 1 : 0; }
};

std::vector<Plane> planes_of(std::span<const CrossSection> sections) {
  const Limb limb = limb_from_cross_sections(sections);
  std::vector<Plane> planes(sections.size());
  for (size_t i = 0; i < sections.size(); ++i) {
    planes[i].centre = limb.points[i];
    planes[i].radius = limb.radii[i];
    const std::vector<glm::vec3>& corners = sections[i].corners;
    for (size_t c = 1; c + 1 < corners.size(); ++c) {
      planes[i].normal +=
          glm::cross(glm::dvec3(corners[c] - corners[0]), glm::dvec3(corners[c + 1] - corners[0]));
    }
    const double length = glm::length(planes[i].normal);
    planes[i].normal = length > 0.0 ? planes[i].normal / length : glm::dvec3(0.0);
  }
  return planes;
}

struct Link {
  double cost = 0.0;
  uint32_t from = 0, to = 0;
  uint8_t from_side = 0, to_side = 0;
  double length = 0.0;
};

/// The best links of every plane, per side.
class Links {
 public:
  explicit Links(const std::vector<Plane>& planes) : planes_(planes), best_(planes.size()) {
    glm::dvec3 low(1e300), high(-1e300);
    for (const Plane& plane : planes) {
      low = glm::min(low, plane.centre);
      high = glm::max(high, plane.centre);
    }
    const glm::dvec3 extent = high - low;
    const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0
                     : extent.y >= extent.z                       ? 1
                                                                  : 2;
    std::vector<uint32_t> order(planes.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
      return planes[a].centre[axis] < planes[b].centre[axis];
    });
    for (size_t at = 0; at < order.size(); ++at) {
      const uint32_t i = order[at];
      // A link costs at least its length: beyond the worst one remembered nothing better comes.
      const auto far = [&](uint32_t j) {
        return std::abs(planes[j].centre[axis] - planes[i].centre[axis]) > limit(i);
      };
      for (size_t next = at + 1; next < order.size() && !far(order[next]); ++next) {
        consider(i, order[next]);
      }
      for (size_t next = at; next-- > 0 && !far(order[next]);) consider(i, order[next]);
    }
  }

  /// All of them, cheapest first.
  std::vector<Link> sorted() const {
    std::vector<Link> all;
    for (const auto& sides : best_) {
      for (const std::vector<Link>& side : sides) all.insert(all.end(), side.begin(), side.end());
    }
    std::sort(all.begin(), all.end(), [](const Link& a, const Link& b) {
      return std::tie(a.cost, a.from, a.to) < std::tie(b.cost, b.from, b.to);
    });
    return all;
  }

  /// The links of a plane's side, cheapest first.
  const std::vector<Link>& of(size_t plane, int side) const { return best_[plane][side]; }

  /// Whether a plane that the limb would have to pass through stands between the two.
  bool passes_through_another(const Link& link) const {
    const Plane& a = planes_[link.from];
    const Plane& b = planes_[link.to];
    const double thin = kThinner * std::min(a.radius, b.radius);
    const double thick = kThicker * std::max(a.radius, b.radius);
    const std::vector<Link>& from = best_[link.from][link.from_side];
    return std::any_of(from.begin(), from.end(), [&](const Link& first) {
      if (first.to == link.to) return false;
      const Plane& between = planes_[first.to];
      const glm::dvec3 in = between.centre - a.centre, out = b.centre - between.centre;
      const double there = glm::length(in), on = glm::length(out);
      return there > 0.0 && on > 0.0 && there + on <= kDetour * link.length &&
             between.radius >= thin && between.radius <= thick &&
             between.across(in / there) >= kSquarely && between.across(out / on) >= kSquarely;
    });
  }

 private:
  double limit(uint32_t i) const {
    double worst = 0.0;
    for (int side = 0; side < (planes_[i].has_normal() ? 2 : 1); ++side) {
      if (best_[i][side].size() < kBest) return 1e300;
      worst = std::max(worst, best_[i][side].back().cost);
    }
    return worst;
  }

  void consider(uint32_t i, uint32_t j) {
    const Plane& a = planes_[i];
    const Plane& b = planes_[j];
    const glm::dvec3 step = b.centre - a.centre;
    const double length = glm::length(step);
    if (length == 0.0) return;
    const double first = a.across(step / length), second = b.across(step / length);
    if (first < kAcross || second < kAcross) return;
    const double smallest = 1e-6 * length;
    const double jump =
        std::abs(std::log(std::max(a.radius, smallest) / std::max(b.radius, smallest)));
    Link link;
    link.cost =
        length * std::exp(kSlantCost * (2.0 - first - second) + kRadiusCost * std::min(jump, 2.0));
    link.from = i;
    link.to = j;
    link.from_side = static_cast<uint8_t>(a.side(step));
    link.to_side = static_cast<uint8_t>(b.side(-step));
    link.length = length;
    std::vector<Link>& best = best_[i][link.from_side];
    const auto place =
        std::upper_bound(best.begin(), best.end(), link,
                         [](const Link& x, const Link& y) { return x.cost < y.cost; });
    best.insert(place, link);
    if (best.size() > kBest) best.pop_back();
  }

  const std::vector<Plane>& planes_;
  std::vector<std::array<std::vector<Link>, 2>> best_;
};

/// Rows that grow together link by link.
class Rows {
 public:
  explicit Rows(size_t count) : next_(count, {-1, -1}), length_(count), row_(count) {
    std::iota(row_.begin(), row_.end(), 0);
  }

  void link(const Link& link) {
    if (next_[link.from][link.from_side] >= 0 || next_[link.to][link.to_side] >= 0) return;
    if (too_long(link.from, link.from_side, link.length) ||
        too_long(link.to, link.to_side, link.length)) {
      return;
    }
    const size_t a = find(link.from), b = find(link.to);
    if (a == b) return;
    row_[std::max(a, b)] = std::min(a, b);
    next_[link.from][link.from_side] = link.to;
    next_[link.to][link.to_side] = link.from;
    length_[link.from][link.from_side] = length_[link.to][link.to_side] = link.length;
  }

  /// A row that goes over from its own limb to the root of a child finds that root in its way; the
  /// rest of its limb then waits behind it, and fits better. Changes such links over.
  /// @return whether there was any.
  bool change_over(const Links& links, const std::vector<Plane>& planes) {
    bool any = false;
    for (size_t i = 0; i < next_.size(); ++i) {
      for (int side = 0; side < 2; ++side) {
        const int64_t linked = next_[i][side];
        if (linked < 0 || next_[i][1 - side] < 0) continue;
        const auto old = static_cast<size_t>(linked);
        double least = kBetterFit * misfit(planes, i, side, old, side_to(old, i));
        const Link* better = nullptr;
        for (const Link& link : links.of(i, side)) {
          if (next_[link.to][link.to_side] >= 0 || next_[link.to][1 - link.to_side] < 0) continue;
          const double fit = misfit(planes, i, side, link.to, link.to_side);
          if (fit < least && !in_row_of(i, side, link.to)) {
            least = fit;
            better = &link;
          }
        }
        if (better == nullptr) continue;
        next_[old][side_to(old, i)] = -1;
        next_[i][side] = better->to;
        next_[better->to][better->to_side] = static_cast<int64_t>(i);
        length_[i][side] = length_[better->to][better->to_side] = better->length;
        any = true;
      }
    }
    find_rows();
    return any;
  }

  /// Takes back links that are far longer than those on both their sides.
  void cut_jumps() {
    std::vector<std::pair<size_t, int>> jumps;
    for (size_t i = 0; i < next_.size(); ++i) {
      for (int side = 0; side < 2; ++side) {
        const int64_t other = next_[i][side];
        if (other < 0 || next_[i][1 - side] < 0) continue;
        const int there = side_to(static_cast<size_t>(other), i);
        if (next_[other][1 - there] < 0) continue;
        const double longest = std::max(length_[i][1 - side], length_[other][1 - there]);
        if (length_[i][side] > kJumpInside * longest) jumps.emplace_back(i, side);
      }
    }
    for (const auto& [plane, side] : jumps) next_[plane][side] = -1;
    find_rows();
  }

  std::vector<std::vector<size_t>> rows() const {
    std::vector<std::vector<size_t>> all;
    std::vector<char> seen(next_.size(), 0);
    for (size_t i = 0; i < next_.size(); ++i) {
      if (seen[i] != 0 || (next_[i][0] >= 0 && next_[i][1] >= 0)) continue;
      std::vector<size_t> row;
      for (int64_t at = static_cast<int64_t>(i); at >= 0;) {
        row.push_back(static_cast<size_t>(at));
        seen[at] = 1;
        const auto& [one, other] = next_[at];
        at = one >= 0 && seen[one] == 0 ? one : other >= 0 && seen[other] == 0 ? other : -1;
      }
      all.push_back(std::move(row));
    }
    return all;
  }

 private:
  int side_to(size_t plane, size_t other) const {
    return next_[plane][0] == static_cast<int64_t>(other) ? 0 : 1;
  }

  /// Whether `plane` is reached from `i` without its side `side`: linking them there makes a loop.
  bool in_row_of(size_t i, int side, size_t plane) const {
    size_t from = i;
    int64_t at = next_[i][1 - side];
    while (at >= 0) {
      if (static_cast<size_t>(at) == plane) return true;
      const auto here = static_cast<size_t>(at);
      at = next_[here][1 - side_to(here, from)];
      from = here;
    }
    return false;
  }

  /// How badly three planes in a row fit: change of the step, turn, change of the taper.
  static double misfit_of(const Plane& a, const Plane& b, const Plane& c) {
    const glm::dvec3 in = b.centre - a.centre, out = c.centre - b.centre;
    const double before = glm::length(in), after = glm::length(out);
    if (before == 0.0 || after == 0.0) return 1e3;
    const double least = 1e-6 * (before + after);
    const auto taper = [&](const Plane& x, const Plane& y) {
      return std::log(std::max(y.radius, least) / std::max(x.radius, least));
    };
    return std::abs(std::log(after / before)) +
           kTurnMisfit * (1.0 - glm::dot(in, out) / (before * after)) +
           std::min(std::abs(taper(b, c) - taper(a, b)), 1.0);
  }

  /// The same for a link, at both its ends.
  double misfit(const std::vector<Plane>& planes, size_t i, int side, size_t j, int j_side) const {
    double sum = misfit_of(planes[next_[i][1 - side]], planes[i], planes[j]);
    if (next_[j][1 - j_side] < 0) return sum;
    sum += misfit_of(planes[i], planes[j], planes[next_[j][1 - j_side]]);
    return 0.5 * sum;
  }

  void find_rows() {
    std::iota(row_.begin(), row_.end(), 0);
    for (size_t i = 0; i < next_.size(); ++i) {
      for (const int64_t other : next_[i]) {
        if (other < 0) continue;
        const size_t a = find(i), b = find(static_cast<size_t>(other));
        row_[std::max(a, b)] = std::min(a, b);
      }
    }
  }

  size_t find(size_t i) {
    while (row_[i] != i) i = row_[i] = row_[row_[i]];
    return i;
  }
  bool too_long(size_t plane, int side, double length) const {
    return next_[plane][1 - side] >= 0 && length > kJump * length_[plane][1 - side];
  }

  std::vector<std::array<int64_t, 2>> next_;
  std::vector<std::array<double, 2>> length_;
  std::vector<size_t> row_;
};

/// The thicker half first.
void put_root_first(const std::vector<Plane>& planes, std::vector<size_t>& row) {
  double first = 0.0, last = 0.0;
  for (size_t i = 0; i < row.size() / 2; ++i) {
    first += planes[row[i]].radius;
    last += planes[row[row.size() - 1 - i]].radius;
  }
  if (last > first) std::reverse(row.begin(), row.end());
}

/// Reverses stretches of the row as long as that shortens the way.
void shorten(const std::vector<Plane>& planes, std::vector<size_t>& row) {
  const auto step = [&](size_t a, size_t b) {
    return glm::distance(planes[row[a]].centre, planes[row[b]].centre);
  };
  const size_t count = row.size();
  for (bool better = true; better;) {
    better = false;
    for (size_t i = 0; i + 1 < count; ++i) {
      for (size_t j = i + 1; j < count; ++j) {
        const double before =
            (i > 0 ? step(i - 1, i) : 0.0) + (j + 1 < count ? step(j, j + 1) : 0.0);
        const double after =
            (i > 0 ? step(i - 1, j) : 0.0) + (j + 1 < count ? step(i, j + 1) : 0.0);
        if (after < before * (1.0 - 1e-9)) {
          std::reverse(row.begin() + static_cast<std::ptrdiff_t>(i),
                       row.begin() + static_cast<std::ptrdiff_t>(j) + 1);
          better = true;
        }
      }
    }
  }
}

}  // namespace

bool Turns::shuffled(double share) const {
  return all >= kFewestTurns && static_cast<double>(back) > share * static_cast<double>(all);
}

void Turns::operator+=(const Turns& other) {
  all += other.all;
  back += other.back;
}

Turns count_turns(std::span<const CrossSection> sections) {
  const Limb limb = limb_from_cross_sections(sections);
  Turns turns;
  for (size_t i = 2; i < limb.points.size(); ++i) {
    const float turn =
        glm::dot(limb.points[i - 1] - limb.points[i - 2], limb.points[i] - limb.points[i - 1]);
    ++turns.all;
    turns.back += turn < 0.0f ? 1 : 0;
  }
  return turns;
}

std::vector<size_t> order_one_limb(std::span<const CrossSection> sections) {
  const std::vector<Plane> planes = planes_of(sections);
  std::vector<size_t> row(planes.size());
  std::iota(row.begin(), row.end(), 0);
  // From plane to nearest plane, beginning at the thickest.
  for (size_t i = 0; i < row.size(); ++i) {
    const auto better = [&](size_t a, size_t b) {
      return i == 0 ? planes[a].radius > planes[b].radius
                    : glm::distance(planes[a].centre, planes[row[i - 1]].centre) <
                          glm::distance(planes[b].centre, planes[row[i - 1]].centre);
    };
    const auto here = row.begin() + static_cast<std::ptrdiff_t>(i);
    std::iter_swap(here, std::min_element(here, row.end(), better));
  }
  if (row.size() <= kLongestImproved) shorten(planes, row);
  put_root_first(planes, row);
  return row;
}

std::vector<std::vector<size_t>> chain_loose_sections(std::span<const CrossSection> sections) {
  const std::vector<Plane> planes = planes_of(sections);
  const Links links(planes);
  Rows rows(planes.size());
  std::vector<Link> second;
  const std::vector<Link> all = links.sorted();
  for (const Link& link : all) {
    if (links.passes_through_another(link)) {
      second.push_back(link);
    } else {
      rows.link(link);
    }
  }
  rows.cut_jumps();
  for (const Link& link : second) rows.link(link);
  rows.cut_jumps();
  for (int round = 0; round < kFitRounds && rows.change_over(links, planes); ++round) {
    for (const Link& link : all) rows.link(link);
    rows.cut_jumps();
  }
  std::vector<std::vector<size_t>> chained = rows.rows();
  for (std::vector<size_t>& row : chained) put_root_first(planes, row);
  return chained;
}

double neighbour_share(const std::vector<std::vector<size_t>>& rows) {
  size_t links = 0, neighbours = 0;
  for (const std::vector<size_t>& row : rows) {
    for (size_t i = 1; i < row.size(); ++i) {
      ++links;
      neighbours += std::max(row[i], row[i - 1]) - std::min(row[i], row[i - 1]) == 1 ? 1 : 0;
    }
  }
  return links > 0 ? static_cast<double>(neighbours) / static_cast<double>(links) : 0.0;
}

double square_share(std::span<const CrossSection> sections,
                    const std::vector<std::vector<size_t>>& rows) {
  const std::vector<Plane> planes = planes_of(sections);
  size_t squarely = 0;
  for (const std::vector<size_t>& row : rows) {
    for (size_t i = 0; row.size() > 2 && i < row.size(); ++i) {
      const size_t low = i > 0 ? i - 1 : 0, high = std::min(i + 1, row.size() - 1);
      const glm::dvec3 along = planes[row[high]].centre - planes[row[low]].centre;
      const double length = glm::length(along);
      squarely += length > 0.0 && planes[row[i]].across(along / length) >= kSquareCosine ? 1 : 0;
    }
  }
  return sections.empty() ? 0.0
                          : static_cast<double>(squarely) / static_cast<double>(sections.size());
}

}  // namespace snowbough::tree
