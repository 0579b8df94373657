#version 410 core
#extension GL_ARB_shading_language_420pack : require
// Adds a deposit in metres to its texel (additive blending).
flat in float deposit;
layout(location = 0) out float added;

void main() { added = deposit; }
