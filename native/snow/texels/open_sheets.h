#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

namespace snowbough::snow {

/// Finds what has no inside: cards, leaves, flags, bowls. Triangles hang together where they share
/// vertices or where vertices of theirs are in one place (within a millionth of the mesh's size),
/// so that neither split vertices nor a leaf that was made of two cards back to back count as open.
/// A part of the mesh is open where it has edges with one triangle only, unless these are short for
/// its area (length^2 <= kClosedButFor * area): a tube with an open end, as modellers leave
/// branches, is closed but for that, and what is within shall not gather snow through walls thinner
/// than a pixel. `triangles`: three indices each into `positions`, in metres. Returns 1 or 0 per
/// triangle. O(T log T).
std::vector<uint8_t> find_open_sheets(const std::vector<int32_t>& triangles,
                                      const std::vector<glm::vec3>& positions);

/// A disc has 4 pi, a square card 16, half of a sphere 2 pi, a cube without a lid 3.2, and a tube
/// ten times as long as it is wide, open at one end, 0.3.
inline constexpr double kClosedButFor = 2.5;

}  // namespace snowbough::snow
