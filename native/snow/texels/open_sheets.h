#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

namespace snowbough::snow {

/// Finds surfaces without an inside: cards, leaves, flags, bowls. Triangles are connected if they
/// share vertices or their vertices coincide (within a millionth of the mesh's size), so that split
/// vertices, or a leaf made of two cards back to back, do not count as open. A component is open if
/// it has edges with a single triangle, unless these are short for its area (length^2 <=
/// kLargestOpening * area): a tube with one open end, as modellers leave branches, counts as
/// closed, because its inside must not gather snow through walls thinner than a pixel. `triangles`:
/// three indices each into `positions`, in metres. Returns 1 or 0 per triangle. O(T log T).
std::vector<uint8_t> find_open_sheets(const std::vector<int32_t>& triangles,
                                      const std::vector<glm::vec3>& positions);

/// length^2 / area of a disc is 4 pi, of a square card 16, of a hemisphere 2 pi, of a cube without
/// lid 3.2, of a tube ten times as long as wide, open at one end, 0.3.
inline constexpr double kLargestOpening = 2.5;

}  // namespace snowbough::snow
