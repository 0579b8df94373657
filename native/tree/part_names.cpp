#include "tree/part_names.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <map>

namespace snowbough::tree {
namespace {

struct Word {
  std::string_view text;
  NameMeaning meaning;
  /// Short words count only where no letter follows: "lef1", but not "left".
  bool whole = false;
};

constexpr auto kWood = NameMeaning::kWood;
constexpr auto kFoliage = NameMeaning::kFoliage;
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
    Word{"blatt", kFoliage},     Word{"blaetter", kFoliage},  Word{"nadel", kFoliage},
    Word{"feuille", kFoliage},   Word{"feuillage", kFoliage}, Word{"fleur", kFoliage},
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
  if (material == NameMeaning::kFoliage) return material;
  // A group of leaves in a wooden material holds petioles as well as leaves: the shape decides.
  if (material == NameMeaning::kWood && group == NameMeaning::kFoliage) return NameMeaning::kSilent;
  return group != NameMeaning::kSilent ? group : material;
}

}  // namespace

NameMeaning meaning_of_name(std::string_view name) {
  std::string lower(name);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
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

PartLabels label_parts(const ObjScene& scene, const Parts& parts) {
  PartLabels labels;
  std::vector<NameMeaning> names;
  std::vector<NameMeaning> materials;
  for (const std::string& name : scene.names) names.push_back(meaning_of_name(name));
  for (const std::string& name : scene.materials) materials.push_back(meaning_of_name(name));

  // Groups are the usual place; one group for everything beside several objects tells nothing.
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
    labels.meaning.push_back(meaning_of_run(names, materials, run));
  }
  return labels;
}

}  // namespace snowbough::tree
