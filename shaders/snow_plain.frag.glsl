#include "glsl/snow_fragment.glsl"
