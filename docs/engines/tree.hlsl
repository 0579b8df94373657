// SPDX-License-Identifier: GPL-3.0-or-later
// The same as tree.{vert,tesc,tese,frag}.glsl for Direct3D 11 and later: vertex_main, hull_main, domain_main, pixel_main.
// Matrices are column-major, as Direct3D's default has them.

#include "snow_rule.hlsl"

cbuffer SnowAtlas : register(b0) {
  int2 tiles;           // columns, rows
  float tile_texels;    // tile
  int frame_count;      // how many frames there are
  float height_scale;   // height.scale
  float height_offset;  // height.offset
  float frame;          // which frame, counted from 0 in the list; between two of them both are mixed
  float open_depth;     // openDepths of that frame
  float last_depth;     // lastDepth
  float limb_width;     // how thick the limbs are that carry snow, in metres; 0: not known, most of it shows
};
cbuffer Tessellation : register(b1) {
  float3 eye;
  float branch_levels;        // branch_levels in the scene's extras
  float pixels_at_one_metre;  // height of the picture / (2 tan(field of view / 2))
  float target_pixels;        // what a part of an edge shall cover
  float highest;              // at most so many parts, up to 64
  float snow_share;           // 0: no snow; 1: what faces up is as fine as the trunk
};
cbuffer View : register(b2) { float4x4 view_projection; };
cbuffer Light : register(b3) {
  float3 to_sun;
  float sun;
  float3 sky;
  float alpha_cutoff;  // alphaCutoff of leaves; 0: bark
};
/// A joint's world matrix times its inverse bind matrix.
StructuredBuffer<float4x4> palette : register(t0);
Texture2D<float> snow_heights : register(t1);
Texture2D<float4> snow_normals : register(t2);
Texture2D<float4> bark_color : register(t3);
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
};
struct Corner {
  float3 position : POSITION;
  float3 normal : NORMAL;
  float2 bark_uv : TEXCOORD0;
  float2 snow_uv : TEXCOORD1;
  float level : TEXCOORD2;
  float3 rest : TEXCOORD3;
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
  float snow : TEXCOORD2;
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

/// `rest`: POSITION, which noise stays with; `normal`: the world's.
ShownSnow shown_snow(float2 uv, float3 rest, float3 normal) {
  const SnowStyle usual = {1.0, 1.0, 1.0, 1.0};
  float held = snow_height(uv);
  float thickness = abs(held);
  float3 out_of = held < 0.0 ? -normal : normal;
  float depth = max(last_depth, 1e-4);
  // Noise counts z upwards.
  float3 at = float3(rest.x, -rest.z, rest.y) / depth;
  SnowPoint here = on_limb(point_noise(at), limb_width, depth);
  here.bumps = bump_noise(at);
  SnowEdge edge = snow_edge(here, thickness, open_depth, out_of.y);
  float height = limb_height(here, usual, edge, thickness, open_depth);
  float3 down = out_of * out_of.y - float3(0.0, 1.0, 0.0);
  float sag = sagging(here, usual, edge, thickness, height, out_of.y);
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
  float3 rest = t.x * c[0].rest + t.y * c[1].rest + t.z * c[2].rest;
  ShownSnow snow = shown_snow(surface.snow_uv, rest, surface.normal);
  surface.snow = snow.height;
  surface.position = lerp(flat_point, round_point, 0.75) + snow.offset;
  surface.clip = mul(view_projection, float4(surface.position, 1.0));
  return surface;
}

/// The world's normal from one in the tangent space of UVs, without tangents in the mesh.
/// M. S. Mikkelsen, Bump Mapping Unparametrized Surfaces on the GPU, JGT 15 (1), 2010.
float3 from_tangent_space(float3 tangent_normal, float3 normal, float3 place, float2 uv) {
  float3 across = cross(ddy(place), normal);
  float3 along = cross(normal, ddx(place));
  float3 tangent = across * ddx(uv).x + along * ddy(uv).x;
  float3 bitangent = -(across * ddx(uv).y + along * ddy(uv).y);
  // Where the screen's y runs downwards, both gradients point backwards.
  float turned = dot(cross(ddx(place), ddy(place)), normal) < 0.0 ? -1.0 : 1.0;
  float size = turned * rsqrt(max(max(dot(tangent, tangent), dot(bitangent, bitangent)), 1e-20));
  return normalize(tangent * size * tangent_normal.x + bitangent * size * tangent_normal.y + normal * tangent_normal.z);
}

float4 pixel_main(Surface surface, bool front : SV_IsFrontFace) : SV_Target {
  // Leaves are seen from both sides, and carry snow on that which is up.
  float3 normal = normalize(surface.normal) * (front ? 1.0 : -1.0);
  float covered = smoothstep(0.0, 0.004, surface.snow);
  int number = clamp(int(frame + 0.5), 0, frame_count - 1);
  float3 flake = snow_normals.SampleLevel(linear_clamp, atlas_place(surface.snow_uv, number), 0).rgb * 2.0 - 1.0;
  float3 snow = from_tangent_space(flake, normal, surface.position, surface.snow_uv);
  normal = normalize(lerp(normal, snow, covered));
  float4 texel = bark_color.Sample(linear_repeat, surface.bark_uv);
  if (texel.a < alpha_cutoff) discard;
  float3 base = lerp(texel.rgb, float3(0.86, 0.89, 0.93), covered);
  float lit = max(dot(normal, normalize(to_sun)), 0.0);
  float wrapped = max((dot(normal, normalize(to_sun)) + 0.4) / 1.4, 0.0);
  return float4(base * (sun * lerp(lit, wrapped, covered) + sky * (0.5 + 0.5 * normal.y)), 1.0);
}
