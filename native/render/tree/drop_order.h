#pragma once

#include <cstdint>
#include <map>
#include <vector>

namespace snowbough::render {

/// What a patch's or leaf's drop point depends on, see shaders/lib/thin_limbs.h.
struct DropSize {
  /// Greatest distance of the bare bark from the limb's middle line, and length of the section;
  /// metres.
  float reach = 0.0f;
  float length = 0.0f;
  /// The patch's number; 1: it is dropped as soon as it is narrower than the least width, as caps.
  float number = 0.0f;
};

/// The scale at which a patch is dropped: with fewer pixels per metre, measured in least widths of
/// a limb. `snow`: metres by which snow enlarges the reach.
float drop_point(const DropSize& of, float snow);
/// The same of a leaf, from its size and number.
float leaf_drop_point(float size, float number);

/// Patches by descending size: from each distance, those that may be drawn come first.
class DropOrder {
 public:
  DropOrder() = default;
  /// `sizes`: in the order of their drop points without snow.
  explicit DropOrder(std::vector<DropSize> sizes);

  /// Number of patches that may be drawn at a scale (see drop_point), with `snow` as above. At
  /// `round_from` (metres times scale) and above, a reach is tessellated and not dropped.
  int32_t needed(float scale, float snow, float round_from);
  int32_t count() const { return static_cast<int32_t>(sizes_.size()); }

 private:
  const std::vector<float>& drop_points(float snow);

  std::vector<DropSize> sizes_;
  /// The greatest reach of a patch and all after it.
  std::vector<float> widest_;
  /// The least drop point of a patch and all after it, for depths of snow in steps.
  std::map<int32_t, std::vector<float>> drop_points_;
};

/// Number of leading drop points in ascending order that are reached at a scale.
int32_t reached(const std::vector<float>& points, float scale);

}  // namespace snowbough::render
