// SPDX-License-Identifier: GPL-3.0-or-later
// The snow of one moment, from what is written beside an exported tree: `snow` in the scene's extras.

#include "snow_rule.glsl"

layout(std140, binding = 0) uniform SnowAtlas {
  ivec2 tiles;         // columns, rows
  float tile_texels;   // tile
  int frame_count;     // how many frames there are
  float height_scale;  // height.scale
  float height_offset; // height.offset
  float frame;         // which frame, counted from 0 in the list; between two of them both are mixed
  float open_depth;    // openDepths of that frame
  float last_depth;    // lastDepth
  SnowStyle snow_style; // style; 1 is fresh snow
};

layout(binding = 0) uniform sampler2D snow_heights;

/// Where TEXCOORD_1 lies in the atlas. Half a texel inside its tile, or its neighbours would be mixed in.
vec2 atlas_place(vec2 uv, int number) {
  vec2 inside = clamp(uv, 0.5 / tile_texels, 1.0 - 0.5 / tile_texels);
  return (inside + vec2(number % tiles.x, number / tiles.x)) / vec2(tiles);
}

/// Metres that the map holds along the normal; below 0 on the back of leaves. Tessellation has no derivatives: level 0.
float snow_height(vec2 uv) {
  int first = clamp(int(frame), 0, frame_count - 1);
  int second = min(first + 1, frame_count - 1);
  float before = textureLod(snow_heights, atlas_place(uv, first), 0.0).r;
  float after = textureLod(snow_heights, atlas_place(uv, second), 0.0).r;
  return height_offset + height_scale * mix(before, after, clamp(frame - float(first), 0.0, 1.0));
}

/// The snow on a place of the tree: the way to its surface, and its height there.
struct ShownSnow {
  vec3 offset;
  float height;
};

/// POSITION with z up, as the noise counts.
vec3 z_up(vec3 place) { return vec3(place.x, -place.z, place.y); }

/// The noise of a point: patches, hem, relief and bumps of a SnowPoint. `rest`: its POSITION, with which noise stays.
vec4 limb_noise(vec3 rest) {
  vec3 place = z_up(rest) / max(last_depth, 1e-4);
  SnowPoint point = point_noise(place);
  return vec4(point.patches, point.hem, point.relief, bump_noise(place));
}

/// `limb_width`: _LIMB_WIDTH; 0, as on leaves: most of the snow shows. `normal`: the world's.
ShownSnow shown_snow(vec4 noise, float limb_width, vec2 uv, vec3 normal) {
  float held = snow_height(uv);
  float thickness = abs(held);
  vec3 out_of = held < 0.0 ? -normal : normal;
  SnowPoint point = on_limb(SnowPoint(noise.x, noise.y, noise.z, noise.w, 0.0, 0.0, 0.0), limb_width, last_depth);
  SnowEdge edge = snow_edge(point, thickness, open_depth, out_of.y);
  float height = limb_height(point, snow_style, edge, thickness, open_depth);
  vec3 down = out_of * out_of.y - vec3(0.0, 1.0, 0.0);
  float sag = sagging(point, snow_style, edge, thickness, height, out_of.y);
  return ShownSnow(out_of * height + down * (sag / max(length(down), 1e-3)), height);
}
