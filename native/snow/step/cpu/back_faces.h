#pragma once

#include "snow/scene/projection.h"
#include "snow/step/cpu/scene.h"

namespace snowbough::snow::cpu {

/// Counts the tile's own pixels in which the sky sees back faces of receivers, which gather
/// nothing: many of them hint at flipped normals.
void count_back_faces(Scene& scene, const Tile& tile);

}  // namespace snowbough::snow::cpu
