#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "tree/obj/obj_scene.h"
#include "tree/obj/parts.h"

namespace snowbough::tree {

/// kDetail: knots, caps and decals, which SpeedTree puts on limbs: their shape decides.
enum class NameMeaning { kSilent, kWood, kFoliage, kDetail };

/// The meaning of a group's, object's or material's name, by modellers' words (trunk, bark, stem
/// ...; leaf, needle, flower ..., the abbreviations of plant libraries, and some German and
/// French). The last of several words counts: "dogwood_leaf" is foliage, "leaf_stem" is wood.
NameMeaning meaning_of_name(std::string_view name);

struct PartLabels {
  /// Distinct labels in file order: groups, or objects if groups do not distinguish parts.
  std::vector<std::string> names;
  /// Per part: index into names; -1 = the file names neither group nor object.
  std::vector<int32_t> label;
  /// Per part: the combined meaning of material, group and object.
  std::vector<NameMeaning> meaning;
  /// The user has named the foliage: no other part is foliage.
  bool foliage_named = false;
};

/// @param foliage_names name prefixes separated by commas: exactly the parts whose group, object or
///   material starts with one of them (ignoring case) are foliage. Empty: decided by
///   meaning_of_name.
/// @param foliage_words false: words for foliage do not count, as in files whose every name has
/// one.
/// @throws std::invalid_argument for an empty name or one that matches nothing in the file.
PartLabels label_parts(const ObjScene& scene, const Parts& parts,
                       const std::string& foliage_names = {}, bool foliage_words = true);

}  // namespace snowbough::tree
