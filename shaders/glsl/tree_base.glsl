// Vertices, edges, patches and sections of the instance `tree`, by their numbers in its base.
#pragma once
#include "glsl/tree_instance.glsl"

layout(std430) readonly buffer TreeVertices { TreeVertex vertices[]; };
layout(std430) readonly buffer PosedVertices { PosedVertex posed[]; };

TreeVertex vertex_of(int index) { return vertices[tree.base.x + index]; }
PosedVertex posed_of(int index) { return posed[tree.own.x + index]; }
