#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "base/parallel_for.h"
#include "tree/obj/obj_scene.h"
#include "tree/obj/parts.h"
#include "tree/read/part_names.h"
#include "tree/rings/rings.h"
#include "tree/welded/welded.h"

namespace snowbough::tree {

/// The forms of trees in OBJ files.
enum class TreeForm {
  /// 1: one group per branch, each a row of planes across the limb.
  kSquaresPerGroup,
  /// 2: one group or object per branch, a tube each.
  kTubesPerGroup,
  /// 3: one group per level, containing that level's tubes.
  kTubesPerLevel,
  /// 4: tubes without useful names.
  kMergedTubes,
  /// 5: as 4, with several materials: wood and foliage are distinguished by material name and
  /// shape.
  kMaterials,
  /// 6: planes without useful names, chained by their order and distance.
  kMergedSquares,
  /// 7: one surface that forks, for the whole tree or most of it.
  kWelded,
};

/// SQUARES_PER_GROUP and so on, for the import report.
std::string form_name(TreeForm form);

enum class PartRole : uint8_t { kTube, kCrossSection, kWelded, kFoliage, kSkipped };

struct SkippedPart {
  int32_t part = -1;
  std::string why;
  /// False for foliage that the user's names exclude.
  bool wood = true;
};

/// The role of every part of the file.
struct ClassifiedParts {
  TreeForm form = TreeForm::kMergedTubes;
  std::vector<PartRole> role;
  /// The traced tubes, and per part the index of its tube or -1.
  std::vector<Limb> limbs;
  std::vector<int32_t> limb;
  /// The forking surfaces, with their parts; ascending.
  std::vector<std::pair<int32_t, WeldedTree>> welded;
  /// The planes seem to be in random order in the file.
  bool shuffled = false;
  /// Parts left out.
  std::vector<SkippedPart> skipped;
  int32_t foliage_count = 0;
};

/// Whether the largest part that reaches the ground may be anything, or is the tree if it forks.
enum class LargestPart : uint8_t { kAny, kTree };

/// Decides the role of each part, by its names, then by its shape, and the form of the file.
/// Forking surfaces count as trees if their area exceeds that of all tubes and they divide into
/// limbs that are thin for their length. Planes count as cross-sections if they form rows across
/// limbs, otherwise as leaves. The largest part that reaches the ground is never foliage unless its
/// name says so.
ClassifiedParts classify_parts(const ObjScene& scene, const Parts& parts, const PartLabels& labels,
                               LargestPart largest = LargestPart::kAny,
                               const base::Execution& execution = {});

}  // namespace snowbough::tree
