#include "tree/read/left_out.h"

#include <array>
#include <cstdio>
#include <map>
#include <utility>

namespace snowbough::tree {
namespace {

std::string part_name(const PartLabels& labels, int32_t part) {
  return labels.label[part] >= 0 ? labels.names[labels.label[part]] : "(unnamed)";
}

/// ": 3.2 % of the wood's area"
std::string share_text(double share) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), ": %.2g %% of the wood's area", 100.0 * share);
  return text.data();
}

double wood_area(const ObjScene& scene, const Parts& parts, const ClassifiedParts& classified) {
  double wood = 0.0;
  for (int32_t p = 0; p < parts.count(); ++p) {
    const PartRole role = classified.role[p];
    if (role != PartRole::kFoliage && role != PartRole::kSkipped)
      wood += part_area(scene, parts, p);
  }
  return wood;
}

}  // namespace

LeftOut report_left_out(const ObjScene& scene, const Parts& parts, const PartLabels& labels,
                        const ClassifiedParts& classified, ImportReport& report) {
  LeftOut left_out;
  if (classified.skipped.empty()) return left_out;
  struct Skipped {
    int64_t count = 0;
    double area = 0.0;
    bool wood = true;
  };
  std::map<std::pair<std::string, std::string>, Skipped> groups;
  double area = 0.0;
  double largest = 0.0;
  for (const SkippedPart& skipped : classified.skipped) {
    Skipped& group = groups[{part_name(labels, skipped.part), skipped.why}];
    ++group.count;
    group.wood = skipped.wood;
    if (!skipped.wood) continue;
    const double own = part_area(scene, parts, skipped.part);
    group.area += own;
    area += own;
    if (own > largest) {
      largest = own;
      left_out.why = skipped.why;
    }
  }
  const double all = wood_area(scene, parts, classified) + area;
  if (all > 0.0) left_out.share = area / all;
  for (const auto& [key, group] : groups) {
    const std::string many = group.count > 1 ? " (" + std::to_string(group.count) + " parts)" : "";
    const bool counts = group.wood && all > 0.0;
    report.skipped_parts.emplace_back(key.first + many,
                                      key.second + (counts ? share_text(group.area / all) : ""));
  }
  return left_out;
}

}  // namespace snowbough::tree
