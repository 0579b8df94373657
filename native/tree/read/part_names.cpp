#include "tree/read/part_names.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <stdexcept>

#include "tree/obj/text.h"

namespace snowbough::tree {
namespace {

struct Word {
  std::string_view text;
  NameMeaning meaning;
  /// Short words count only if no letter follows: "lef1", but not "left".
  bool whole = false;
};

constexpr auto kWood = NameMeaning::kWood;
constexpr auto kFoliage = NameMeaning::kFoliage;
constexpr auto kDetail = NameMeaning::kDetail;
constexpr std::array kWords{
    Word{"trunk", kWood},        Word{"bark", kWood},         Word{"branch", kWood},
    Word{"bough", kWood},        Word{"limb", kWood},         Word{"twig", kWood},
    Word{"stem", kWood},         Word{"wood", kWood},         Word{"bole", kWood, true},
    Word{"brk", kWood, true},    Word{"stamm", kWood},        Word{"rinde", kWood},
    Word{"zweig", kWood},        Word{"tronc", kWood},        Word{"ecorce", kWood},
    Word{"branche", kWood},      Word{"leaf", kFoliage},      Word{"leave", kFoliage},
    Word{"lef", kFoliage, true}, Word{"foliage", kFoliage},   Word{"needle", kFoliage},
    Word{"flower", kFoliage},    Word{"blossom", kFoliage},   Word{"petal", kFoliage},
    Word{"frond", kFoliage},     Word{"fruit", kFoliage},     Word{"berry", kFoliage},
    Word{"berries", kFoliage},   Word{"catkin", kFoliage},    Word{"acorn", kFoliage},
    Word{"samara", kFoliage},    Word{"bud", kFoliage, true}, Word{"buds", kFoliage, true},
    Word{"bifurcating", kWood},  Word{"roots", kWood, true},  Word{"cap", kDetail, true},
    Word{"caps", kDetail, true}, Word{"knot", kDetail, true}, Word{"knots", kDetail, true},
    Word{"cavity", kDetail},     Word{"decal", kDetail},      Word{"blatt", kFoliage},
    Word{"blaetter", kFoliage},  Word{"nadel", kFoliage},     Word{"feuille", kFoliage},
    Word{"feuillage", kFoliage}, Word{"fleur", kFoliage},
};

bool is_letter(char c) {
  return std::isalpha(static_cast<unsigned char>(c)) != 0;
}

NameMeaning meaning_of_run(const std::vector<NameMeaning>& names,
                           const std::vector<NameMeaning>& materials, const FaceRun& run) {
  const auto of = [](const std::vector<NameMeaning>& meanings, int32_t i) {
    return i >= 0 ? meanings[i] : NameMeaning::kSilent;
  };
  const NameMeaning material = of(materials, run.material);
  NameMeaning group = of(names, run.group);
  if (group == NameMeaning::kSilent) group = of(names, run.object);
  if (group == NameMeaning::kDetail || material == NameMeaning::kDetail) {
    return NameMeaning::kSilent;
  }
  if (material == NameMeaning::kFoliage) return material;
  // A group of leaves in a wooden material contains petioles as well: the shape decides.
  if (material == NameMeaning::kWood && group == NameMeaning::kFoliage) return NameMeaning::kSilent;
  return group != NameMeaning::kSilent ? group : material;
}

/// Names (groups and objects, or materials) that start with one of `prefixes`; marks those used.
std::vector<bool> starting_with(const std::vector<std::string>& names,
                                const std::vector<std::string>& prefixes, std::vector<bool>& used) {
  std::vector<bool> named;
  for (const std::string& name : names) {
    const std::string lower = lower_case(name);
    bool any = false;
    for (size_t i = 0; i < prefixes.size(); ++i) {
      if (!lower.starts_with(prefixes[i])) continue;
      any = true;
      used[i] = true;
    }
    named.push_back(any);
  }
  return named;
}

std::vector<std::string> split_foliage_names(const std::string& list) {
  std::vector<std::string> prefixes;
  for (size_t from = 0; from <= list.size();) {
    const size_t comma = std::min(list.find(',', from), list.size());
    const std::string lower = lower_case(std::string_view(list).substr(from, comma - from));
    const size_t first = lower.find_first_not_of(" \t");
    if (first == std::string::npos) {
      throw std::invalid_argument("foliage: a name is empty in '" + list + "'");
    }
    prefixes.push_back(lower.substr(first, lower.find_last_not_of(" \t") - first + 1));
    from = comma + 1;
  }
  return prefixes;
}

/// Applies the user's foliage names; other foliage becomes wood or is decided by shape.
void overrule_foliage(const ObjScene& scene, const Parts& parts, const std::string& list,
                      PartLabels& labels) {
  const std::vector<std::string> prefixes = split_foliage_names(list);
  std::vector<bool> used(prefixes.size(), false);
  const std::vector<bool> names = starting_with(scene.names, prefixes, used);
  const std::vector<bool> materials = starting_with(scene.materials, prefixes, used);
  for (size_t i = 0; i < prefixes.size(); ++i) {
    if (used[i]) continue;
    throw std::invalid_argument("foliage: no group, object or material of the file starts with '" +
                                prefixes[i] + "'");
  }
  const auto is_named = [](const std::vector<bool>& named, int32_t i) {
    return i >= 0 && named[i];
  };
  for (size_t p = 0; p < parts.run.size(); ++p) {
    const FaceRun& run = scene.runs[parts.run[p]];
    NameMeaning& meaning = labels.meaning[p];
    if (is_named(names, run.group) || is_named(names, run.object) ||
        is_named(materials, run.material)) {
      meaning = NameMeaning::kFoliage;
    } else if (meaning == NameMeaning::kFoliage) {
      meaning = NameMeaning::kSilent;
    }
  }
  labels.foliage_named = true;
}

}  // namespace

NameMeaning meaning_of_name(std::string_view name) {
  const std::string lower = lower_case(name);
  // SpeedTree's name of the thickest branches; within a longer name it says nothing.
  if (lower.starts_with("big") &&
      lower.find_first_not_of(" ._0123456789", 3) == std::string::npos) {
    return kWood;
  }
  NameMeaning meaning = NameMeaning::kSilent;
  size_t last_end = 0;
  for (const Word& word : kWords) {
    for (size_t at = lower.find(word.text); at != std::string::npos;
         at = lower.find(word.text, at + 1)) {
      const size_t end = at + word.text.size();
      if (word.whole && end < lower.size() && is_letter(lower[end])) continue;
      if (end > last_end) {
        last_end = end;
        meaning = word.meaning;
      }
    }
  }
  return meaning;
}

PartLabels label_parts(const ObjScene& scene, const Parts& parts, const std::string& foliage_names,
                       bool foliage_words) {
  PartLabels labels;
  std::vector<NameMeaning> names;
  std::vector<NameMeaning> materials;
  for (const std::string& name : scene.names) names.push_back(meaning_of_name(name));
  for (const std::string& name : scene.materials) materials.push_back(meaning_of_name(name));

  // Groups are the usual labels; one group for everything beside several objects is useless.
  std::map<int32_t, int> groups;
  std::map<int32_t, int> objects;
  for (const FaceRun& run : scene.runs) {
    ++groups[run.group];
    ++objects[run.object];
  }
  const bool by_object = groups.size() <= 1 && objects.size() > 1;

  std::map<int32_t, int32_t> number;
  labels.label.reserve(parts.run.size());
  labels.meaning.reserve(parts.run.size());
  for (const int32_t r : parts.run) {
    const FaceRun& run = scene.runs[r];
    const int32_t name = by_object || run.group < 0 ? run.object : run.group;
    int32_t label = -1;
    if (name >= 0) {
      const auto [found, added] =
          number.try_emplace(name, static_cast<int32_t>(labels.names.size()));
      if (added) labels.names.push_back(scene.names[name]);
      label = found->second;
    }
    labels.label.push_back(label);
    const NameMeaning meaning = meaning_of_run(names, materials, run);
    labels.meaning.push_back(meaning == kFoliage && !foliage_words ? NameMeaning::kSilent
                                                                   : meaning);
  }
  if (!foliage_names.empty()) overrule_foliage(scene, parts, foliage_names, labels);
  return labels;
}

}  // namespace snowbough::tree
