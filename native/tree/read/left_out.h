#pragma once

#include <string>

#include "tree/obj/obj_scene.h"
#include "tree/obj/parts.h"
#include "tree/read/classify.h"
#include "tree/read/part_names.h"
#include "tree/skeleton/skeleton.h"

namespace snowbough::tree {

/// The parts left out of the wood.
struct LeftOut {
  /// Fraction of the whole area, including them.
  double share = 0.0;
  /// Why the largest of them is not wood; empty if nothing was left out.
  std::string why;
};

/// Adds the left-out parts to the report: one line per name and reason, with their fraction of the
/// wood's area.
LeftOut report_left_out(const ObjScene& scene, const Parts& parts, const PartLabels& labels,
                        const ClassifiedParts& classified, ImportReport& report);

}  // namespace snowbough::tree
