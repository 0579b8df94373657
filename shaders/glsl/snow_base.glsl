// A receiver's base, as it is without snow.
#include "lib/snow_patch.h"

layout(std430) readonly buffer SnowVertices { SnowVertex vertices[]; };
layout(std430) readonly buffer CornerNormals { vec4 corner_normals[]; };
