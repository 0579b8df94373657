// SPDX-License-Identifier: GPL-3.0-or-later
// The same as tree.{vert,tesc,tese,frag}.glsl for Direct3D 11 and later: vertex_main, hull_main, domain_main, pixel_main.
// Matrices are column-major, as Direct3D's default has them.

#include "snow_rule.hlsl"
#include "snow_shading.hlsl"

cbuffer SnowAtlas : register(b0) {
  int2 tiles;           // columns, rows
  float tile_texels;    // tile
  int frame_count;      // how many frames there are
  float height_scale;   // height.scale
  float height_offset;  // height.offset
  float frame;          // which frame, counted from 0 in the list; between two of them both are mixed
  float open_depth;     // openDepths of that frame
  float last_depth;     // lastDepth
  SnowStyle snow_style; // style; 1 is fresh snow
};
cbuffer Tessellation : register(b1) {
  float branch_levels;  // branch_levels in the scene's extras
  float target_pixels;  // length of a part of an edge
  float highest;        // at most so many parts, up to 64
  float snow_share;     // 0: no snow; 1: what faces up is as fine as the trunk
};
cbuffer View : register(b2) {
  float4x4 view_projection;
  float3 eye;
  float pixels_at_one_metre;  // height of the picture / (2 tan(field of view / 2))
};
cbuffer Light : register(b3) {
  float3 to_sun;
  float sun;
  float3 sky;          // from straight above
  float alpha_cutoff;  // alphaCutoff of leaves; 0: bark
  float3 ground;       // from straight below
};
/// A joint's world matrix times its inverse bind matrix.
StructuredBuffer<float4x4> palette : register(t0);
Texture2D<float> snow_heights : register(t1);
Texture2D<float4> bark_color : register(t2);
SamplerState linear_clamp : register(s0);
SamplerState linear_repeat : register(s1);

struct Vertex {
  float3 position : POSITION;
  float3 normal : NORMAL;
  float2 bark_uv : TEXCOORD0;
  float2 snow_uv : TEXCOORD1;
  float level : TEXCOORD2;  // _BRANCH_LEVEL; or level / levels = 1 - the vertex colour's alpha
  uint4 joints : BLENDINDICES;
  float4 weights : BLENDWEIGHT;
  float width : TEXCOORD3;  // _LIMB_WIDTH
};
struct Corner {
  float3 position : POSITION;
  float3 normal : NORMAL;
  float2 bark_uv : TEXCOORD0;
  float2 snow_uv : TEXCOORD1;
  float level : TEXCOORD2;
  float3 rest : TEXCOORD3;
  float width : TEXCOORD4;
};
struct Factors {
  float edges[3] : SV_TessFactor;
  float inside : SV_InsideTessFactor;
};
struct Surface {
  float4 clip : SV_Position;
  float3 position : POSITION;
  float3 normal : NORMAL;
  float2 bark_uv : TEXCOORD0;
  float2 snow_uv : TEXCOORD1;
  float3 rest : TEXCOORD2;
  float4 noise : TEXCOORD3;
  float width : TEXCOORD4;
};

/// Where TEXCOORD_1 lies in the atlas. Half a texel inside its tile, or its neighbours would be mixed in.
float2 atlas_place(float2 uv, int number) {
  float2 inside = clamp(uv, 0.5 / tile_texels, 1.0 - 0.5 / tile_texels);
  return (inside + float2(number % tiles.x, number / tiles.x)) / float2(tiles);
}

/// Metres that the map holds along the normal; below 0 on the back of leaves.
float snow_height(float2 uv) {
  int first = clamp(int(frame), 0, frame_count - 1);
  int second = min(first + 1, frame_count - 1);
  float before = snow_heights.SampleLevel(linear_clamp, atlas_place(uv, first), 0);
  float after = snow_heights.SampleLevel(linear_clamp, atlas_place(uv, second), 0);
  return height_offset + height_scale * lerp(before, after, saturate(frame - float(first)));
}

/// The snow on a place of the tree: the way to its surface, and its height there.
struct ShownSnow {
  float3 offset;
  float height;
};

/// POSITION with z up, as the noise counts.
float3 z_up(float3 at) { return float3(at.x, -at.z, at.y); }

/// The noise of a point: patches, hem, relief and bumps of a SnowPoint. `rest`: its POSITION, with which noise stays.
float4 limb_noise(float3 rest) {
  float3 at = z_up(rest) / max(last_depth, 1e-4);
  SnowPoint here = point_noise(at);
  return float4(here.patches, here.hem, here.relief, bump_noise(at));
}

/// `limb_width`: _LIMB_WIDTH; 0, as on leaves: most of the snow shows. `normal`: the world's.
ShownSnow shown_snow(float4 noise, float limb_width, float2 uv, float3 normal) {
  float held = snow_height(uv);
  float thickness = abs(held);
  float3 out_of = held < 0.0 ? -normal : normal;
  const SnowPoint noises = {noise.x, noise.y, noise.z, noise.w, 0.0, 0.0, 0.0};
  SnowPoint here = on_limb(noises, limb_width, last_depth);
  SnowEdge edge = snow_edge(here, thickness, open_depth, out_of.y);
  float height = limb_height(here, snow_style, edge, thickness, open_depth);
  float3 down = out_of * out_of.y - float3(0.0, 1.0, 0.0);
  float sag = sagging(here, snow_style, edge, thickness, height, out_of.y);
  ShownSnow snow;
  snow.offset = out_of * height + down * (sag / max(length(down), 1e-3));
  snow.height = height;
  return snow;
}

Corner vertex_main(Vertex v) {
  float4x4 skin = v.weights.x * palette[v.joints.x] + v.weights.y * palette[v.joints.y] +
                  v.weights.z * palette[v.joints.z] + v.weights.w * palette[v.joints.w];
  Corner corner;
  corner.position = mul(skin, float4(v.position, 1.0)).xyz;
  corner.normal = normalize(mul((float3x3)skin, v.normal));
  corner.bark_uv = v.bark_uv;
  corner.snow_uv = v.snow_uv;
  corner.level = v.level;
  corner.rest = v.position;
  corner.width = v.width;
  return corner;
}

/// T_p: into how many parts an edge goes by what it covers on the screen.
float parts_on_screen(float3 a, float3 b) {
  float away = max(distance(eye, 0.5 * (a + b)), 0.01);
  return distance(a, b) * pixels_at_one_metre / (away * target_pixels);
}

/// T = T_p * (1 - level / levels), from an edge's own two points alone, so that both its triangles agree.
float edge_level(Corner a, Corner b) {
  float share = 1.0 - min(a.level, b.level) / branch_levels;
  share = max(share, snow_share * max(max(a.normal.y, b.normal.y), 0.0));
  return clamp(parts_on_screen(a.position, b.position) * share, 1.0, highest);
}

Factors patch_factors(InputPatch<Corner, 3> corners) {
  Factors factors;
  factors.edges[0] = edge_level(corners[1], corners[2]);
  factors.edges[1] = edge_level(corners[2], corners[0]);
  factors.edges[2] = edge_level(corners[0], corners[1]);
  factors.inside = max(factors.edges[0], max(factors.edges[1], factors.edges[2]));
  return factors;
}

[domain("tri")]
[partitioning("fractional_odd")]
[outputtopology("triangle_ccw")]
[outputcontrolpoints(3)]
[patchconstantfunc("patch_factors")]
Corner hull_main(InputPatch<Corner, 3> corners, uint number : SV_OutputControlPointID) {
  return corners[number];
}

float3 on_plane(float3 p, Corner corner) { return p - dot(p - corner.position, corner.normal) * corner.normal; }

/// New vertices are rounded by the normals (T. Boubekeur, M. Alexa, Phong Tessellation, 2008), then moved out by snow.
[domain("tri")]
Surface domain_main(Factors factors, float3 t : SV_DomainLocation, const OutputPatch<Corner, 3> c) {
  float3 flat_point = t.x * c[0].position + t.y * c[1].position + t.z * c[2].position;
  float3 round_point = t.x * on_plane(flat_point, c[0]) + t.y * on_plane(flat_point, c[1]) +
                       t.z * on_plane(flat_point, c[2]);
  Surface surface;
  surface.normal = normalize(t.x * c[0].normal + t.y * c[1].normal + t.z * c[2].normal);
  surface.bark_uv = t.x * c[0].bark_uv + t.y * c[1].bark_uv + t.z * c[2].bark_uv;
  surface.snow_uv = t.x * c[0].snow_uv + t.y * c[1].snow_uv + t.z * c[2].snow_uv;
  surface.rest = t.x * c[0].rest + t.y * c[1].rest + t.z * c[2].rest;
  surface.noise = limb_noise(surface.rest);
  surface.width = t.x * c[0].width + t.y * c[1].width + t.z * c[2].width;
  ShownSnow snow = shown_snow(surface.noise, surface.width, surface.snow_uv, surface.normal);
  surface.position = lerp(flat_point, round_point, 0.75) + snow.offset;
  surface.clip = mul(view_projection, float4(surface.position, 1.0));
  return surface;
}

/// Fraction of the light that a leaf transmits.
static const float kThrough = 0.4;
/// Fraction of the snow's own slopes that shows: twigs are only a few texels wide.
static const float kTwigRelief = 0.6;

float4 pixel_main(Surface surface, bool front : SV_IsFrontFace) : SV_Target {
  float4 texel = bark_color.Sample(linear_repeat, surface.bark_uv);
  if (texel.a < alpha_cutoff) discard;
  view.eye = float4(z_up(eye), pixels_at_one_metre);
  view.sun_direction = z_up(normalize(to_sun));
  view.sun_color = (float3)sun;
  view.sky_color = sky;
  view.ground_color = ground;
  float3 at = z_up(surface.position);
  float3 rest = z_up(surface.rest);
  float3 outside = normalize(surface.normal);
  // Leaves are seen from both sides.
  float3 normal = z_up(front ? outside : -outside);
  float facing = dot(normal, view.sun_direction);
  float through = alpha_cutoff > 0.0 ? kThrough : 0.0;
  float lit = sun * (max(facing, 0.0) + through * max(-facing, 0.0));
  float3 bare = texel.rgb * (lit + lerp(ground, sky, 0.5 + 0.5 * normal.z));
  float height = shown_snow(surface.noise, surface.width, surface.snow_uv, outside).height;
  float3 snow_normal = normalize(lerp(normal, with_relief(at, normal, height), kTwigRelief));
  float pixel = distance(view.eye.xyz, at) / pixels_at_one_metre;
  float3 snow = lit_snow(at, snow_normal, height, rest);
  return float4(lerp(bare, snow, snow_cover(height, rest, pixel)), 1.0);
}
