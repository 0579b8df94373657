#pragma once

// The object of a triangle.

#include "../lib/kernel.h"
#include "../lib/snow_shared.h"

/// The scene's triangles word by word.
KERNEL_VIEW_R32UI(triangle_words);

/// Slot of a triangle's object, with the bits kReceives and kTwoSided.
uint object_of(uint triangle) { return texelFetch(triangle_words, int(4u * triangle + 3u)).x; }
