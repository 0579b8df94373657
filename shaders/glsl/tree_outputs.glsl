// What a vertex of a limb, tessellated or plain, hands on.
//
// CAPTURE: world positions to transform feedback. SHADOW: the sun's picture, of depth alone.

/// Plain and tessellated patches meet: both programs compute it to the same bits.
invariant gl_Position;
#ifdef CAPTURE
layout(xfb_buffer = 0, xfb_offset = 0, xfb_stride = 12) out vec3 captured;
#else
#ifndef SHADOW
out vec3 world;
out vec3 smooth_normal;
out vec4 bark;
#ifdef IMAGE
layout(std430) readonly buffer BarkPlaces { BarkPlace bark_places[]; };
/// Coordinates of the bark's image, and its layer.
out vec3 image_place;
#endif
#ifdef SNOW
#ifndef WIRE
/// Where the snow is on its map, and the bark in the rest pose.
out vec2 snow_place;
out vec3 rest_place;
/// See limb_noise.
out vec4 snow_noises;
#endif
#endif
#endif
#endif
