#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tree/obj/obj_scene.h"
#include "tree/obj/parts.h"
#include "tree/read/classify.h"
#include "tree/skeleton/skeleton.h"

namespace snowbough::tree {

/// Share of the wood below which limbs do not represent it.
inline constexpr double kLowCoverage = 0.75;

/// How well limbs represent the wood of a file.
struct Coverage {
  /// Area of the wood, and of what limbs represent of it; square units of the file.
  double area = 0.0;
  double covered = 0.0;
  /// Parts of the file with uncovered area, the largest first: part and uncovered area.
  std::vector<std::pair<int32_t, double>> missing;

  /// Fraction of the wood that limbs represent; 1 without wood.
  double share() const { return area > 0.0 ? covered / area : 1.0; }
};

/// Checks every limb against its own polygons, both ways. A polygon counts as covered as far as its
/// corners lie inside its limb or within three quarters of the limb's radius from it; and only as
/// much of a limb's polygons as the fraction of its length that has polygons within twice its
/// radius. Wood in which no limb was found is covered where it lies on other limbs. Planes across
/// limbs are always covered.
/// @param branches  in the file's axes, not simplified; `piece` is the part of the file.
Coverage measure_coverage(const ObjScene& scene, const Parts& parts,
                          const ClassifiedParts& classified, const std::vector<Branch>& branches);

}  // namespace snowbough::tree
