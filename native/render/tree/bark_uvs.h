#pragma once

#include <cstdint>
#include <vector>

#include "render/data/sources.h"
#include "shaders/lib/tree_shared.h"

namespace snowbough::render {

/// Coordinates of a tree's patches on the images of its bark. `quads`: the source's quad of each
/// patch. @throws std::invalid_argument with the reason: arrays of a different length, no
/// materials, or indices out of range.
std::vector<shared::BarkUv> bark_uvs(const BarkSource& source, const std::vector<int32_t>& quads);

}  // namespace snowbough::render
