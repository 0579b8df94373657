// SPDX-License-Identifier: GPL-3.0-or-later
// How snow of a known thickness looks. Written by tools/engine_rule.py from shaders/lib: change it there. Metres;
// `up` is the upward part of a normal, whichever axis is up.

// Gradient noise on a lattice whose gradients come from a hash of its points, so that C++ and GLSL need no table and
// agree. For C++ and GLSL.
//
// Sources: K. Perlin, Improving Noise, SIGGRAPH 2002 (gradient noise, the fade of degree five); M. Jarzynski,
// M. Olano, Hash Functions for GPU Rendering, JCGT 9 (3), 2020 (pcg3d).

/// A unit vector for a point of the lattice.
float3 lattice_gradient(float3 at) {
  // Through int: a negative float has no unsigned value.
  uint x = uint(int(at.x)) * 1664525u + 1013904223u;
  uint y = uint(int(at.y)) * 1664525u + 1013904223u;
  uint z = uint(int(at.z)) * 1664525u + 1013904223u;
  x += y * z;
  y += z * x;
  z += x * y;
  x ^= x >> 16u;
  y ^= y >> 16u;
  z ^= z >> 16u;
  x += y * z;
  y += z * x;
  z += x * y;
  const float3 way = float3(float(x >> 8u), float(y >> 8u), float(z >> 8u)) * (2.0f / 16777216.0f) - ((float3)(1.0f));
  return way * (1.0f / max(length(way), 1e-4f));
}

float lattice_share(float3 cell, float3 in_cell, float3 corner) {
  return dot(lattice_gradient(cell + corner), in_cell - corner);
}

/// From about -1 to 1, with a mean of 0; one wave is about 1 long.
float gradient_noise(float3 position) {
  const float3 cell = floor(position);
  const float3 f = position - cell;
  const float3 w = f * f * f * (f * (f * 6.0f - ((float3)(15.0f))) + ((float3)(10.0f)));
  float along_z[2];
  for (int k = 0; k < 2; ++k) {
    const float z = float(k);
    const float a = lattice_share(cell, f, float3(0.0f, 0.0f, z));
    const float b = lattice_share(cell, f, float3(1.0f, 0.0f, z));
    const float c = lattice_share(cell, f, float3(0.0f, 1.0f, z));
    const float d = lattice_share(cell, f, float3(1.0f, 1.0f, z));
    const float front = a + w.x * (b - a);
    const float back = c + w.x * (d - c);
    along_z[k] = front + w.y * (back - front);
  }
  return 1.6f * (along_z[0] + w.z * (along_z[1] - along_z[0]));
}

/// Three octaves of it, scaled so that they vary as much as one; a wave of 0 is left out. `waves`: their lengths in
/// the unit of `position`; `gain`: what each is worth beside the one before.
float layered_noise(float3 position, float3 waves, float gain) {
  float sum = gradient_noise(position * (1.0f / waves.x));
  float squares = 1.0f;
  if (waves.y > 0.0f) {
    sum += gain * gradient_noise(position * (1.0f / waves.y) + ((float3)(17.3f)));
    squares += gain * gain;
  }
  if (waves.z > 0.0f) {
    sum += gain * gain * gradient_noise(position * (1.0f / waves.z) + ((float3)(34.6f)));
    squares += gain * gain * gain * gain;
  }
  return sum / sqrt(squares);
}

// How snow of a known thickness looks: the one rule for Blender's mesh, the live preview, Snowbough Realtime and the
// exporters. A point of the surface is its carrier on the receiver plus an offset; away from rims the offset goes along
// the normal (thin_snow, sagging), near a rim it follows a profile: upright, a round shoulder, an overhang, a drop
// (front_offset). All lengths are metres, all vectors are in the pose that the surface was planned in.
//
// Sources: superellipses, A. H. Barr, Superquadrics and Angle-Preserving Transformations, IEEE CG&A 1 (1), 1981; how
// snow ends in round lips and cornices, P. Fearing, Computer Modelling of Fallen Snow, SIGGRAPH 2000, section 3.

/// What an artist sets; 1 is snow as it usually lies.
struct SnowStyle {
  float overhang;
  float hem_variation;
  float bridging;
  float relief;
};

/// Constants of a point away from rims.
struct SnowPoint {
  /// Noise, from about -1 to 1: of the thickness below which no snow shows, of lips and sagging, of the relief, of bumps.
  float patches;
  float hem;
  float relief;
  float bumps;
  /// How far below the receiver's surface bare parts may lie.
  float deepest;
  /// By how much more the surface's area grows with each metre along its normals, in 1/m; 0 where it is flat or hollow.
  float convexity;
  /// 0 on wide ground, 1 on tops and twigs so narrow that snow is thin there for want of room, not for shelter.
  float narrow;
};

// Away from rims.
/// From this upward part of the normal on a surface is level, to this one it is steep.
static const float kLevel = 0.93f;
static const float kSteep = 0.45f;
/// Part of the open depth that does not show on steep places and where shelter thins the snow, times 0.22 + 0.85 noise.
static const float kSteepShare = 0.65f;
static const float kShelterShare = 0.10f;
/// Of these shares, what narrow places do without.
static const float kNarrowKeeps = 0.85f;
/// Walls, of a smaller upward part of the normal, show no snow thinner than this part of the open depth: what has just
/// slid over a rim, or what comes through a map's gutter from the chart beside it.
static const float kWall = 0.15f;
static const float kWallShare = 0.1f;
/// Thinner snow, in metres and as a part of the open depth, is frost and does not show.
static const float kFrost = 0.0025f;
static const float kFrostShare = 0.05f;
/// Height of the lip in which snow ends, as part of the open depth.
static const float kLip = 0.22f;
static const float kSink = 0.004f;
/// Parts of the thickness.
static const float kSag = 0.6f;
static const float kSagVariation = 0.5f;
static const float kMostSag = 1.4f;
static const float kRelief = 0.13f;
static const float kBumps = 0.08f;
static const float kMostRelief = 0.11f;

/// 0 at `from`, 1 at `to`, which may be the smaller one.
float eased(float x, float from, float to) {
  const float t = clamp((x - from) / (to - from), 0.0f, 1.0f);
  return t * t * (3.0f - 2.0f * t);
}

float steepness(float up) { return eased(up, kLevel, kSteep); }

/// Where snow ends.
struct SnowEdge {
  /// Thickness below which no snow shows.
  float threshold;
  float lip;
  /// How far below the receiver's surface bare parts lie.
  float sink;
};

/// `thickness`: what the map holds here, `open_depth`: what lies on open level ground in this frame; `up`: upward part
/// of the normal.
SnowEdge snow_edge(const SnowPoint place_of, float thickness, float open_depth,
                                             float up) {
  const float depth = max(open_depth, 1e-5f);
  const float steep = steepness(up);
  const float sheltered = eased(thickness / depth, 0.75f, 0.25f);
  const float share = max(kSteepShare * steep, kShelterShare * sheltered) * (1.0f - kNarrowKeeps * place_of.narrow);
  const float threshold = share * depth * clamp(0.22f + 0.85f * place_of.patches, 0.0f, 1.4f) +
                          kWallShare * depth * eased(up, kWall, 0.0f) +
                          min(kFrost, kFrostShare * depth) * (1.0f - kNarrowKeeps * place_of.narrow);
  const float lip = kLip * depth * (0.05f + 0.95f * steep) * clamp(0.8f + 0.5f * place_of.hem, 0.3f, 1.5f);
  const float sink = min(min(kSink, 0.3f * depth + 0.0008f), place_of.deepest);
  const SnowEdge made = {threshold, lip, sink};
  return made;
}

/// Most that shows of a thickness, relief aside.
float most_shown(float thickness) { return 1.5f * thickness + 0.004f; }

/// Height of the shown snow's surface above the receiver's, negative where none shows, so that snow ends where two
/// surfaces intersect. Its slope is bounded by smoothing it afterwards over the surface.
float thin_snow(const SnowEdge edge, float thickness) {
  const float x = thickness - edge.threshold;
  if (x < 0.0f) return -edge.sink * (1.0f - exp(x / (0.25f * edge.sink + 0.1f * edge.lip + 1e-6f)));
  const float lip = sqrt(x * x + 2.0f * edge.lip * x * exp(-x / (2.5f * edge.lip)));
  const float kept = edge.threshold * (1.0f - exp(-x / edge.threshold));
  return min(lip + kept, most_shown(thickness));
}

/// Height of a layer that lies on a convex surface and holds as much snow as one of `height` on a flat surface: the
/// layer's area grows with its height.
float swept_height(const SnowPoint place_of, float height) {
  if (height <= 0.0f || place_of.convexity * height < 1e-4f) return height;
  return (sqrt(1.0f + 2.0f * place_of.convexity * height) - 1.0f) / place_of.convexity;
}

/// What relief adds to a height.
float surface_relief(const SnowPoint place_of, const SnowStyle style,
                                               float height, float open_depth) {
  const float wave = clamp(kRelief * place_of.relief + kBumps * place_of.bumps, -kMostRelief, kMostRelief);
  return style.relief * wave * min(max(height, 0.0f), open_depth);
}

/// How far snow that ends on a steep place hangs down the slope.
float sagging(const SnowPoint place_of, const SnowStyle style,
                                        const SnowEdge edge, float thickness, float height, float up) {
  const float x = max(thickness - edge.threshold, 0.0f);
  const float amount = clamp(kSag + style.hem_variation * kSagVariation * place_of.hem, 0.0f, kMostSag);
  return style.overhang * max(height, 0.0f) * amount * exp(-x / (1.5f * edge.lip)) * steepness(up) *
         eased(up, -0.2f, 0.2f);
}

// The constants of a point of the snow's surface, from its place and from how thick that is which carries it.

/// Part of the thickness below a point that bare places may sink into.
static const float kSinkPart = 0.45f;
/// What is thicker than the first part of the depth is wide, what is thinner than the second narrow.
static const float kWide = 0.8f;
static const float kNarrow = 0.3f;

/// The noise of a point, without its bumps. `place`: in parts of the depth at the shot's end, so that noise is the same
/// at any scale.
SnowPoint point_noise(float3 place) {
  SnowPoint place_of;
  place_of.patches = layered_noise(place + 50.0f, float3(2.2f, 1.0f, 0.45f), 0.8f);
  place_of.hem = layered_noise(place, float3(3.0f, 1.5f, 0.6f), 0.7f);
  place_of.relief = layered_noise(place + 21.0f, float3(4.0f, 1.7f, 0.8f), 0.65f);
  place_of.bumps = 0.0f;
  place_of.deepest = 1e9f;
  place_of.convexity = 0.0f;
  place_of.narrow = 0.0f;
  return place_of;
}

/// Noise of bumps; `place`: of the shown surface, as above.
float bump_noise(float3 place) {
  return layered_noise(place + 70.0f, float3(1.1f, 0.5f, 0.0f), 0.6f);
}

/// The same point on something that is `thickness` thick, under snow that is `depth` deep at the shot's end. Metres.
SnowPoint on_carrier(const SnowPoint place_of, float thickness, float depth) {
  SnowPoint made = place_of;
  made.deepest = max(kSinkPart * thickness, 1e-5f);
  made.narrow = eased(thickness, kWide * depth, kNarrow * depth);
  return made;
}

/// The same point on a round limb of that width in metres; 0: as if the limb were flat, and so thin that most shows.
SnowPoint on_limb(const SnowPoint place_of, float width, float depth) {
  SnowPoint made = on_carrier(place_of, width, depth);
  made.convexity = width > 0.0f ? 2.0f / width : 0.0f;
  return made;
}

/// Height of the snow that shows on a limb, 0 where none does.
float limb_height(const SnowPoint place_of, const SnowStyle style,
                                            const SnowEdge edge, float thickness, float open_depth) {
  const float height = max(thin_snow(edge, thickness), 0.0f);
  return swept_height(place_of, height + surface_relief(place_of, style, height, open_depth));
}

/// How far from its carrier a point away from rims may be at most, under a map that holds `thickness` at most and in
/// the usual style.
float farthest_offset(float thickness) {
  const float height = (1.0f + kMostRelief) * most_shown(thickness);
  return thickness > 0.0f ? height * length(float3(1.0f, kMostSag, 0.0f)) : 0.0f;
}
