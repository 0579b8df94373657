#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <vector>

#include "snow/movement/repose/links.h"

namespace snowbough::snow {

/// Snow on a block's texels and on those across its links: its greatest thickness in metres, the
/// largest difference across one of the links, and whether any lies on the positive side
/// or on the back.
struct HeightRange {
  float high = 0.0f;
  float step = 0.0f;
  bool any_positive = false;
  bool any_back = false;
};

/// The range of a block of a map. `places`: TexelTable::texel; `height`: of the map's first place,
/// in metres, negative on the back.
HeightRange find_height_range(const ReposeLinks& links, const std::vector<int32_t>& places,
                              int32_t block, const float* height);

/// The greatest thickness in a rectangle of a map whose rows are `pitch` numbers apart.
float highest_of(const float* height, size_t pitch, glm::ivec2 size);

}  // namespace snowbough::snow
