// Outputs of a limb's vertex, tessellated or plain.
//
// CAPTURE: world positions for transform feedback. SHADOW: shadow map, depth only.

/// Plain and tessellated patches share edges: both programs must compute the same bits.
invariant gl_Position;
#ifdef CAPTURE
layout(xfb_buffer = 0, xfb_offset = 0, xfb_stride = 12) out vec3 captured;
#else
#ifndef SHADOW
out vec3 world;
out vec3 smooth_normal;
out vec4 bark;
#ifdef IMAGE
layout(std430) readonly buffer BarkUvs { BarkUv bark_uvs[]; };
/// Coordinates on the bark's image, and its layer.
out vec3 image_uv;
#endif
#ifndef WIRE
flat out int drawn_tree;
#ifdef SNOW
/// Of the TreeInstance: pixels outside of a triangle, which derivatives use, cannot read its buffer.
flat out ivec4 snow_map;
flat out vec4 snow_depths;
flat out SnowStyle snow_style;
/// Coordinates on the snow map, and the position in the rest pose without bark.
out vec2 snow_uv;
out vec3 rest_position;
/// See limb_noise.
out vec4 snow_noises;
#endif
#endif
#endif
#endif
