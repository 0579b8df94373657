#include "glsl/tree_fragment.glsl"
