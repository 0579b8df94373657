#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "tree/obj/obj_scene.h"
#include "tree/obj/parts.h"

namespace snowbough::tree {

enum class NameMeaning { kSilent, kWood, kFoliage };

/// What a group's, object's or material's name says, by the words modellers use (trunk, bark, stem
/// ...; leaf, needle, flower ..., the abbreviations of plant libraries, and some German and
/// French). Of several words the last counts: "dogwood_leaf" is foliage, "leaf_stem" is wood.
NameMeaning meaning_of_name(std::string_view name);

/// The names that parts go by.
struct PartLabels {
  /// Distinct labels in the order of the file: groups, or objects where groups tell nothing apart.
  std::vector<std::string> names;
  /// Per part: index into names; -1 = the file names neither group nor object.
  std::vector<int32_t> label;
  /// Per part: what material, group and object together say.
  std::vector<NameMeaning> meaning;
  /// The user has said which names are foliage: nothing else is.
  bool foliage_named = false;
};

/// @param foliage_names names separated by commas: parts whose group, object or material starts
///   with one of them (in any case) are foliage and no others. Empty: told by meaning_of_name.
/// @throws std::invalid_argument where a name is empty or nothing in the file starts with it.
PartLabels label_parts(const ObjScene& scene, const Parts& parts,
                       const std::string& foliage_names = {});

}  // namespace snowbough::tree
