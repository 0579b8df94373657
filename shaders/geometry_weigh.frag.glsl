#version 410 core
#extension GL_ARB_shading_language_420pack : require
// Adds a texel's projected area, in pixels, to its pixel's sum (additive blending).
flat in float weight;
layout(location = 0) out float sum;

void main() { sum = weight; }
