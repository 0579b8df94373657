#include "glsl/listed_patch.glsl"
