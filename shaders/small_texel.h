// GLSL only: whether a texel is too small to take the snow of the pixel over it alone.
#include "fall_frame.h"

/// Part of a pixel's area that the sharing texels should have together.
const float kSpreadArea = 0.25;

/// `area`: of one or several texels, in m2.
bool is_small(float area) { return area < kSpreadArea * fall.direction.w * fall.direction.w; }
