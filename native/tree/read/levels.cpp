#include "tree/read/levels.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <glm/geometric.hpp>
#include <map>
#include <numeric>
#include <set>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "tree/obj/text.h"
#include "tree/skeleton/segment_tree.h"

namespace snowbough::tree {
namespace {

constexpr std::array<std::string_view, 4> kTrunkWords = {"trunk", "bole", "stamm", "tronc"};
/// Fraction by which more of one cluster's branches must grow on another's than the reverse.
constexpr double kClearlyGrowing = 0.25;
/// With more clusters than this, names determine the order.
constexpr size_t kMaxRanked = 12;

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

size_t digits_begin(std::string_view name) {
  size_t at = name.size();
  while (at > 0 && is_digit(name[at - 1])) --at;
  return at;
}

std::string trim(std::string_view text) {
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.front()))) {
    text.remove_prefix(1);
  }
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back()))) {
    text.remove_suffix(1);
  }
  return std::string(text);
}

/// Whether the suffixes are 0, 1, 2 ... or 1, 2, 3 ... without gap or repeat.
bool counts_up(const std::vector<std::string>& suffixes) {
  std::set<std::string> numbers;
  for (const std::string& suffix : suffixes) {
    if (suffix.empty() || (suffix.size() > 1 && suffix[0] == '0')) return false;
    if (!numbers.insert(suffix).second) return false;
  }
  const size_t first = numbers.contains("0") ? 0 : 1;
  for (size_t i = 0; i < numbers.size(); ++i) {
    if (!numbers.contains(std::to_string(first + i))) return false;
  }
  return true;
}

/// Whether numbers of one prefix begin with a level's digit: prefix + digit + running number.
bool levels_end_in_digits(const std::vector<std::string>& suffixes) {
  if (counts_up(suffixes)) return false;
  std::map<char, std::vector<std::string>> by_digit;
  for (const std::string& suffix : suffixes) {
    if (suffix.size() < 2) return false;
    by_digit[suffix[0]].push_back(suffix.substr(1));
  }
  return std::all_of(by_digit.begin(), by_digit.end(),
                     [](const auto& entry) { return counts_up(entry.second); });
}

/// Replaces every run of digits by one sign, for names like "branch12_mesh".
std::string without_numbers(std::string_view name) {
  std::string pattern;
  for (const char c : name) {
    if (!is_digit(c)) {
      pattern += c;
    } else if (pattern.empty() || pattern.back() != '#') {
      pattern += '#';
    }
  }
  return pattern;
}

/// Keys that distinguish nearly every label give no levels.
bool too_many(size_t keys, size_t labels) {
  return keys > 12 && keys * 3 > labels;
}

double volume(const Branch& branch) {
  double sum = 0.0;
  for (size_t i = 0; i + 1 < branch.points.size(); ++i) {
    sum += glm::distance(branch.points[i], branch.points[i + 1]) *
           (0.5 * branch.areas[i] + 0.5 * branch.areas[i + 1]);
  }
  return sum;
}

bool is_trunk(const std::string& name) {
  const std::string lower = lower_case(name);
  return std::any_of(kTrunkWords.begin(), kTrunkWords.end(),
                     [&](std::string_view word) { return lower.find(word) != std::string::npos; });
}

/// Fraction of the branches whose root touches one of `parents`, except at its root.
double growing_share(const std::vector<Branch>& branches, const std::vector<Branch>& parents) {
  const SegmentTree segments(parents, std::vector<int32_t>(parents.size(), 0), 0.0f);
  double growing = 0.0;
  for (const Branch& branch : branches) {
    const NearestSegment found = segments.nearest(branch.points.front(), 1, Measure::kDistance);
    growing += found.branch >= 0 && found.distance <= found.radius + branch.radii.front() &&
                       found.point != parents[found.branch].points.front()
                   ? 1.0
                   : 0.0;
  }
  return growing / static_cast<double>(std::max<size_t>(branches.size(), 1));
}

/// Swaps neighbours in `order` if the first grows on the second.
void put_parents_first(const std::vector<std::string>& names, const std::vector<Branch>& branches,
                       const std::vector<int32_t>& branch_cluster, std::vector<int32_t>& order) {
  if (order.size() > kMaxRanked) return;
  std::vector<std::vector<Branch>> members(names.size());
  for (size_t b = 0; b < branches.size(); ++b) members[branch_cluster[b]].push_back(branches[b]);
  const auto numbered_alike = [&](int32_t a, int32_t b) {
    const size_t at = digits_begin(names[a]);
    return at < names[a].size() && digits_begin(names[b]) == at && at < names[b].size() &&
           names[a].compare(0, at, names[b], 0, at) == 0;
  };
  for (size_t pass = 1; pass < order.size(); ++pass) {
    bool changed = false;
    for (size_t i = 0; i + 1 < order.size(); ++i) {
      const std::vector<Branch>& first = members[order[i]];
      const std::vector<Branch>& second = members[order[i + 1]];
      if (numbered_alike(order[i], order[i + 1]) ||
          growing_share(first, second) <= growing_share(second, first) + kClearlyGrowing) {
        continue;
      }
      std::swap(order[i], order[i + 1]);
      changed = true;
    }
    if (!changed) return;
  }
}

}  // namespace

LevelClusters cluster_labels(const std::vector<std::string>& labels) {
  std::map<std::string, std::vector<std::string>> suffixes;
  std::set<std::string> patterns;
  for (const std::string& label : labels) {
    const size_t at = digits_begin(label);
    suffixes[label.substr(0, at)].push_back(label.substr(at));
    patterns.insert(without_numbers(label));
  }
  const bool by_pattern =
      too_many(suffixes.size(), labels.size()) && !too_many(patterns.size(), labels.size());
  std::set<std::string> ending_in_digits;
  for (const auto& [prefix, numbers] : suffixes) {
    if (levels_end_in_digits(numbers)) ending_in_digits.insert(prefix);
  }
  LevelClusters clusters;
  std::map<std::string, int32_t> number;
  for (const std::string& label : labels) {
    std::string key = without_numbers(label);
    if (!by_pattern) {
      const size_t at = digits_begin(label);
      key = label.substr(0, at);
      if (ending_in_digits.contains(key)) key += label[at];
    }
    const auto [found, added] =
        number.try_emplace(key, static_cast<int32_t>(clusters.names.size()));
    if (added) clusters.names.push_back(key);
    clusters.cluster.push_back(found->second);
  }
  return clusters;
}

LevelClusters match_levels(const std::string& levels, const std::vector<std::string>& labels) {
  LevelClusters clusters;
  std::vector<std::string> prefixes;
  for (size_t from = 0; from <= levels.size();) {
    const size_t comma = std::min(levels.find(',', from), levels.size());
    const std::string name = trim(std::string_view(levels).substr(from, comma - from));
    if (name.empty()) throw std::invalid_argument("levels: a name is empty in '" + levels + "'");
    const std::string prefix = lower_case(name);
    if (std::find(prefixes.begin(), prefixes.end(), prefix) != prefixes.end()) {
      throw std::invalid_argument("levels: '" + name + "' appears twice");
    }
    clusters.names.push_back(name);
    prefixes.push_back(prefix);
    from = comma + 1;
  }
  bool any = false;
  for (const std::string& label : labels) {
    const std::string lower = lower_case(label);
    int32_t best = -1;
    for (size_t i = 0; i < prefixes.size(); ++i) {
      if (lower.starts_with(prefixes[i]) &&
          (best < 0 || prefixes[i].size() > prefixes[best].size())) {
        best = static_cast<int32_t>(i);
      }
    }
    any = any || best >= 0;
    clusters.cluster.push_back(best);
  }
  if (!any) {
    std::string known;
    for (size_t i = 0; i < labels.size() && i < 8; ++i) {
      known += (i > 0 ? ", '" : "'") + labels[i] + "'";
    }
    throw std::invalid_argument("levels: no group of the file starts with any of '" + levels +
                                "'; its groups are " + (known.empty() ? "unnamed" : known) +
                                (labels.size() > 8 ? ", ..." : ""));
  }
  return clusters;
}

std::vector<int32_t> rank_levels(const std::vector<std::string>& cluster_names,
                                 const std::vector<Branch>& branches,
                                 const std::vector<int32_t>& branch_cluster) {
  const size_t count = cluster_names.size();
  std::vector<double> mean(count, 0.0);
  std::vector<double> members(count, 0.0);
  for (size_t b = 0; b < branches.size(); ++b) {
    mean[branch_cluster[b]] += volume(branches[b]);
    members[branch_cluster[b]] += 1.0;
  }
  for (size_t c = 0; c < count; ++c) mean[c] /= std::max(members[c], 1.0);
  std::vector<int32_t> order(count);
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int32_t a, int32_t b) { return mean[a] > mean[b]; });

  // Families such as stems_1, stems_2 keep their places, sorted by number.
  std::map<std::string, std::vector<size_t>> families;
  for (size_t place = 0; place < count; ++place) {
    const std::string& name = cluster_names[order[place]];
    const size_t at = digits_begin(name);
    if (at < name.size()) families[name.substr(0, at)].push_back(place);
  }
  for (const auto& [prefix, places] : families) {
    std::vector<int32_t> family;
    for (const size_t place : places) family.push_back(order[place]);
    const size_t digits_begin = prefix.size();
    std::stable_sort(family.begin(), family.end(), [&](int32_t a, int32_t b) {
      const auto number = [&](int32_t c) {
        const std::string digits = cluster_names[c].substr(digits_begin);
        const size_t zeros = std::min(digits.find_first_not_of('0'), digits.size());
        return std::pair(digits.size() - zeros, digits.substr(zeros));
      };
      return number(a) < number(b);
    });
    for (size_t i = 0; i < places.size(); ++i) order[places[i]] = family[i];
  }
  put_parents_first(cluster_names, branches, branch_cluster, order);
  std::stable_partition(order.begin(), order.end(),
                        [&](int32_t c) { return is_trunk(cluster_names[c]); });
  std::vector<int32_t> level(count);
  for (size_t place = 0; place < count; ++place) level[order[place]] = static_cast<int32_t>(place);
  return level;
}

}  // namespace snowbough::tree
