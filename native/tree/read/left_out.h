#pragma once

#include <string>

#include "tree/obj/obj_scene.h"
#include "tree/obj/parts.h"
#include "tree/read/classify.h"
#include "tree/read/part_names.h"
#include "tree/skeleton/skeleton.h"

namespace snowbough::tree {

/// What was left out of the wood.
struct LeftOut {
  /// Of the wood's area, it included.
  double share = 0.0;
  /// Why its largest part is no wood; empty where nothing was left out.
  std::string why;
};

/// Writes into the report what was left out: one line for all parts of a name that were so for the
/// same reason, with their share of the wood's area.
LeftOut report_left_out(const ObjScene& scene, const Parts& parts, const PartLabels& labels,
                        const ClassifiedParts& classified, ImportReport& report);

}  // namespace snowbough::tree
