#include "tree/surface/knuckles.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace snowbough::tree {
namespace {

/// Maximum cosine between the directions of two children on one knuckle; otherwise one would leave
/// through a side that faces away from it.
constexpr double kSharingCosine = 0.35;
/// The same for two second stems: seen from one of three equal stems around a fork, the others are
/// 60 degrees apart.
constexpr double kStemsCosine = 0.85;
/// Fraction of the shorter one's length that must overlap for two children to be at one place.
constexpr double kSharingOverlap = 0.4;
/// Fraction of its length to which a knuckle shrinks before it pushes its neighbours along the
/// limb.
constexpr double kShrinkBeforeShift = 0.6;

struct Group {
  double low, high;
  std::vector<ChildRequest> children;

  double heading() const {
    double sum = 0.0;
    for (const ChildRequest& child : children) {
      sum += child.heading;
    }
    return sum / static_cast<double>(children.size());
  }
  double middle() const { return 0.5 * (low + high); }
  double length() const { return high - low; }
};

bool can_share(const Group& group, const ChildRequest& request) {
  if (group.children.size() >= 4) {
    return false;
  }
  const double low = request.position - 0.5 * request.length;
  const double high = request.position + 0.5 * request.length;
  const double overlap = std::min(high, group.high) - std::max(low, group.low);
  if (overlap < kSharingOverlap * std::min(request.length, group.length())) {
    return false;
  }
  return std::all_of(group.children.begin(), group.children.end(), [&](const ChildRequest& other) {
    const bool are_stems = other.crotch && request.crotch;
    return glm::dot(other.direction, request.direction) <
           (are_stems ? kStemsCosine : kSharingCosine);
  });
}

std::vector<Group> group_children(std::vector<ChildRequest> requests) {
  std::stable_sort(
      requests.begin(), requests.end(),
      [](const ChildRequest& a, const ChildRequest& b) { return a.position < b.position; });
  std::vector<Group> groups;
  for (const ChildRequest& request : requests) {
    const size_t reach = std::min<size_t>(groups.size(), 4);
    auto home = std::find_if(groups.end() - static_cast<std::ptrdiff_t>(reach), groups.end(),
                             [&](const Group& group) { return can_share(group, request); });
    const double low = request.position - 0.5 * request.length;
    const double high = request.position + 0.5 * request.length;
    if (home == groups.end()) {
      groups.push_back({low, high, {request}});
    } else {
      home->low = std::min(home->low, low);
      home->high = std::max(home->high, high);
      home->children.push_back(request);
    }
  }
  std::stable_sort(groups.begin(), groups.end(),
                   [](const Group& a, const Group& b) { return a.middle() < b.middle(); });
  // Of two children for the same stretch the one that leans forward more comes first, otherwise
  // they would cross.
  for (size_t pass = 1; pass < groups.size(); ++pass) {
    bool swapped = false;
    for (size_t i = 0; i + 1 < groups.size(); ++i) {
      const double apart = std::abs(groups[i + 1].middle() - groups[i].middle());
      const double reach = 0.25 * (groups[i].length() + groups[i + 1].length());
      if (apart < reach && groups[i].heading() > groups[i + 1].heading()) {
        std::swap(groups[i], groups[i + 1]);
        swapped = true;
      }
    }
    if (!swapped) {
      break;
    }
  }
  return groups;
}

/// Non-decreasing sequence nearest to `values` (least squares), by pooling adjacent violators.
/// Source: M. Ayer et al., "An empirical distribution function for sampling with incomplete
/// information", Annals of Mathematical Statistics 26, 1955.
std::vector<double> isotonic(const std::vector<double>& values) {
  struct Block {
    double sum;
    size_t count;
    double mean() const { return sum / static_cast<double>(count); }
  };
  std::vector<Block> blocks;
  for (double value : values) {
    blocks.push_back({value, 1});
    while (blocks.size() > 1 && blocks[blocks.size() - 2].mean() > blocks.back().mean()) {
      blocks[blocks.size() - 2].sum += blocks.back().sum;
      blocks[blocks.size() - 2].count += blocks.back().count;
      blocks.pop_back();
    }
  }
  std::vector<double> result;
  for (const Block& block : blocks) {
    result.insert(result.end(), block.count, block.mean());
  }
  return result;
}

/// Divides `free` metres between two neighbours that request `left` and `right` of it, keeping a
/// gap.
void share(double free, double gap, double smallest_gap, double& left, double& right) {
  const double kept = std::max(smallest_gap, std::min(gap, 0.3 * free));
  const double given = std::max(0.0, free - kept);
  const double wanted = left + right;
  if (wanted > given) {
    left *= given / wanted;
    right *= given / wanted;
  }
}

double least_room(size_t count, const LengthLimits& scale) {
  const auto n = static_cast<double>(count);
  return n * scale.smallest_knuckle + (n + 1.0) * scale.smallest_gap;
}

}  // namespace

KnuckleRow place_knuckles(std::vector<ChildRequest> requests, double begin, double end, double gap,
                          const LengthLimits& scale) {
  KnuckleRow row;
  row.end = end;
  if (requests.empty()) {
    return row;
  }
  const std::vector<Group> groups = group_children(std::move(requests));
  const size_t count = groups.size();
  const auto n = static_cast<double>(count);

  const double least = least_room(count, scale);
  row.end = std::max(row.end, begin + 1.01 * least);
  const double room = row.end - begin;

  std::vector<double> lengths(count);
  double total = (n + 1.0) * scale.smallest_gap;
  for (size_t i = 0; i < count; ++i) {
    lengths[i] = std::max(scale.smallest_knuckle, kShrinkBeforeShift * groups[i].length());
    total += lengths[i];
  }
  if (total > room) {
    const double factor = (room - least) / (total - least);
    total = (n + 1.0) * scale.smallest_gap;
    for (double& length : lengths) {
      length = scale.smallest_knuckle + (length - scale.smallest_knuckle) * factor;
      total += length;
    }
  }

  // After subtracting the lengths before it, keeping knuckles apart means keeping a sequence in
  // order.
  std::vector<double> offsets(count), places(count);
  double used = scale.smallest_gap;
  for (size_t i = 0; i < count; ++i) {
    offsets[i] = used + 0.5 * lengths[i];
    places[i] = groups[i].middle() - offsets[i];
    used += lengths[i] + scale.smallest_gap;
  }
  places = isotonic(places);
  std::vector<double> low(count), high(count);
  for (size_t i = 0; i < count; ++i) {
    const double middle =
        std::clamp(places[i], begin, std::max(begin, row.end - total)) + offsets[i];
    low[i] = middle - 0.5 * lengths[i];
    high[i] = middle + 0.5 * lengths[i];
  }

  // If there is room left, they grow back to the requested length.
  std::vector<double> grow_low(count), grow_high(count);
  for (size_t i = 0; i < count; ++i) {
    grow_low[i] = grow_high[i] = 0.5 * std::max(0.0, groups[i].length() - lengths[i]);
  }
  double none = 0.0;
  share(low[0] - begin, gap, scale.smallest_gap, none, grow_low[0]);
  for (size_t i = 0; i + 1 < count; ++i) {
    share(low[i + 1] - high[i], gap, scale.smallest_gap, grow_high[i], grow_low[i + 1]);
  }
  share(row.end - high[count - 1], gap, scale.smallest_gap, grow_high[count - 1], none);
  for (size_t i = 0; i < count; ++i) {
    row.knuckles.push_back({low[i] - grow_low[i], high[i] + grow_high[i], groups[i].children});
  }
  return row;
}

KnuckleRow place_knuckles_between(std::vector<ChildRequest> requests, double begin, double end,
                                  double gap, std::vector<std::pair<double, double>> bends,
                                  const LengthLimits& scale) {
  std::erase_if(bends, [&](const auto& bend) {
    return bend.first - bend.second <= begin || bend.first + bend.second >= end;
  });
  while (!bends.empty()) {
    // Stretches between the bends, and the children of each.
    std::vector<std::vector<ChildRequest>> leaving(bends.size() + 1);
    for (const ChildRequest& request : requests) {
      size_t piece = 0;
      while (piece < bends.size() && request.position > bends[piece].first) {
        ++piece;
      }
      leaving[piece].push_back(request);
    }
    size_t crowded = bends.size();
    KnuckleRow row;
    row.end = end;
    for (size_t piece = 0; piece <= bends.size() && crowded == bends.size(); ++piece) {
      const bool last = piece == bends.size();
      const double low = piece == 0 ? begin : bends[piece - 1].first + bends[piece - 1].second;
      const double high = last ? end : bends[piece].first - bends[piece].second;
      if (!leaving[piece].empty() && high - low < 1.02 * least_room(leaving[piece].size(), scale)) {
        crowded = last ? piece - 1 : piece;
        break;
      }
      const KnuckleRow part = place_knuckles(leaving[piece], low, high, gap, scale);
      row.knuckles.insert(row.knuckles.end(), part.knuckles.begin(), part.knuckles.end());
    }
    if (crowded == bends.size()) {
      return row;
    }
    bends.erase(bends.begin() + static_cast<std::ptrdiff_t>(crowded));
  }
  return place_knuckles(std::move(requests), begin, end, gap, scale);
}

}  // namespace snowbough::tree
