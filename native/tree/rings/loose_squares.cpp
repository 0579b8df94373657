#include "tree/rings/loose_squares.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <numeric>

#include "tree/rings/square_links.h"
#include "tree/rings/square_rows.h"

namespace snowbough::tree {
namespace {

/// Fewer turns than this do not decide.
constexpr size_t kFewestTurns = 3;
/// Maximum number of rounds of relinking.
constexpr int kFitRounds = 4;
/// Within 15 degrees.
constexpr double kSquareCosine = 0.966;
/// Rows longer than this are not improved further.
constexpr size_t kLongestImproved = 2000;

/// Puts the thicker half first.
void put_root_first(const std::vector<Plane>& planes, std::vector<size_t>& row) {
  double first = 0.0, last = 0.0;
  for (size_t i = 0; i < row.size() / 2; ++i) {
    first += planes[row[i]].radius;
    last += planes[row[row.size() - 1 - i]].radius;
  }
  if (last > first) std::reverse(row.begin(), row.end());
}

/// Reverses stretches of the row while that shortens the path.
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
  for (int round = 0; round < kFitRounds && rows.relink(links, planes); ++round) {
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
