// SPDX-License-Identifier: GPL-3.0-or-later
// The look of snow of a known thickness. tools/engine_rule.py writes this file from shaders/lib: change it there.
// Lengths are in metres; `up` is the upward component of a normal, whichever axis is up.

// Gradient noise on a lattice, for C++ and GLSL. A hash of the lattice point gives the gradient, so that both languages
// give the same noise without a table.
//
// Sources: K. Perlin, Improving Noise, SIGGRAPH 2002 (gradient noise, the fade of degree five); M. Jarzynski,
// M. Olano, Hash Functions for GPU Rendering, JCGT 9 (3), 2020 (pcg3d).

/// The unit gradient at a lattice point.
float3 lattice_gradient(float3 at) {
  // The conversion goes through int, because a negative float has no unsigned value.
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
  const float3 gradient = float3(float(x >> 8u), float(y >> 8u), float(z >> 8u)) * (2.0f / 16777216.0f) - ((float3)(1.0f));
  return gradient * (1.0f / max(length(gradient), 1e-4f));
}

float lattice_share(float3 cell, float3 in_cell, float3 corner) {
  return dot(lattice_gradient(cell + corner), in_cell - corner);
}

/// Noise from about -1 to 1 with a mean of 0. The wavelength is about 1.
float gradient_noise(float3 position) {
  // Farther out, floats have no fractions, and an int no such number.
  const float3 bounded = clamp(position, ((float3)(-1e9f)), ((float3)(1e9f)));
  const float3 cell = floor(bounded);
  const float3 f = bounded - cell;
  const float3 w = f * f * f * (f * (f * 6.0f - ((float3)(15.0f))) + ((float3)(10.0f)));
  float along_z[2];
  for (int k = 0; k < 2; ++k) {
    const float z = float(k);
    const float a = lattice_share(cell, f, float3(0.0f, 0.0f, z));
    const float b = lattice_share(cell, f, float3(1.0f, 0.0f, z));
    const float c = lattice_share(cell, f, float3(0.0f, 1.0f, z));
    const float d = lattice_share(cell, f, float3(1.0f, 1.0f, z));
    const float near = a + w.x * (b - a);
    const float far = c + w.x * (d - c);
    along_z[k] = near + w.y * (far - near);
  }
  return 1.6f * (along_z[0] + w.z * (along_z[1] - along_z[0]));
}

/// Three octaves of gradient noise, scaled to the variance of one octave. `waves`: wavelengths in the unit of
/// `position`; an octave with wavelength 0 is skipped. `gain`: ratio of an octave's amplitude to that of the octave
/// before.
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

/// The artist's settings; 1 is the default look.
struct SnowStyle {
  float overhang;
  float hem_variation;
  float bridging;
  float relief;
};

SnowStyle usual_style() {
  SnowStyle style;
  style.overhang = 1.0f;
  style.hem_variation = 1.0f;
  style.bridging = 1.0f;
  style.relief = 1.0f;
  return style;
}

// The look of snow of a known thickness: the one formula for Blender's mesh, the live preview, Snowbough Realtime and
// the exporters. A point of the surface is its carrier on the receiver plus an offset. Away from rims the offset
// follows the normal (thin_snow, sagging). Near a rim it follows a profile of an upright face, a round shoulder, an
// overhang and a drop (front_offset). All lengths are in metres. All vectors are in the pose for which the surface was
// planned.
//
// Sources: superellipses, A. H. Barr, Superquadrics and Angle-Preserving Transformations, IEEE CG&A 1 (1), 1981; round
// lips and cornices at the edges of snow, P. Fearing, Computer Modelling of Fallen Snow, SIGGRAPH 2000, section 3.

/// Constants of a point away from rims.
struct SnowPoint {
  /// Noise, from about -1 to 1: of the thickness below which no snow shows, of lips and sagging, of the surface noise,
  /// and of bumps.
  float patches;
  float hem;
  float relief;
  float bumps;
  /// Greatest depth of bare parts below the receiver's surface.
  float deepest;
  /// Relative growth of the surface's area per metre along its normals, in 1/m; 0 on flat or concave places.
  float convexity;
  /// 0 on wide ground, 1 on tops and twigs so narrow that the snow is thin for lack of room, not because of shelter.
  float narrow;
};

// Away from rims.
/// Upward components of the normal: a surface is level above the first and steep below the second.
static const float kLevel = 0.93f;
static const float kSteep = 0.45f;
/// Thickness that does not show, as a fraction of the open depth, on steep places and where shelter thins the snow;
/// multiplied by 0.22 + 0.85 noise.
static const float kSteepShare = 0.65f;
static const float kShelterShare = 0.10f;
/// Reduction of these fractions on narrow places.
static const float kNarrowKeeps = 0.85f;
/// Walls are surfaces with a smaller upward component of the normal. They show no snow thinner than this fraction of
/// the open depth: such snow has just slid over a rim, or comes from the neighbouring chart through the map's gutter.
static const float kWall = 0.15f;
static const float kWallShare = 0.1f;
/// Snow thinner than this, in metres and as a fraction of the open depth, is frost and does not show.
static const float kFrost = 0.0025f;
static const float kFrostShare = 0.05f;
/// Until open ground has the first depth, in metres, the threshold is raised by up to the second: without snow, the whole
/// surface must lie clearly below the receiver.
static const float kFirstDepth = 0.001f;
static const float kFirstFrost = 0.0003f;
/// Height of the lip at the edge of the snow, as a fraction of the open depth.
static const float kLip = 0.22f;
static const float kSink = 0.004f;
/// Fractions of the thickness.
static const float kSag = 0.6f;
static const float kSagVariation = 0.5f;
static const float kMaxSag = 1.4f;
static const float kRelief = 0.13f;
static const float kBumps = 0.08f;
static const float kMaxRelief = 0.11f;

/// Smooth step from 0 at `from` to 1 at `to`. `to` may be less than `from`.
float eased(float x, float from, float to) {
  const float t = clamp((x - from) / (to - from), 0.0f, 1.0f);
  return t * t * (3.0f - 2.0f * t);
}

float steepness(float up) { return eased(up, kLevel, kSteep); }

/// Shape of the snow's border.
struct SnowEdge {
  /// Thickness below which no snow shows.
  float threshold;
  float lip;
  /// Depth of bare parts below the receiver's surface.
  float sink;
};

/// `thickness`: thickness from the map at this point; `open_depth`: snow depth on open level ground in this frame;
/// `up`: upward component of the normal.
SnowEdge snow_edge(const SnowPoint place_of, float thickness, float open_depth,
                                             float up) {
  const float depth = max(open_depth, 1e-5f);
  const float steep = steepness(up);
  const float sheltered = eased(thickness / depth, 0.75f, 0.25f);
  const float share = max(kSteepShare * steep, kShelterShare * sheltered) * (1.0f - kNarrowKeeps * place_of.narrow);
  const float threshold = share * depth * clamp(0.22f + 0.85f * place_of.patches, 0.0f, 1.4f) +
                          kWallShare * depth * eased(up, kWall, 0.0f) +
                          min(kFrost, kFrostShare * depth) * (1.0f - kNarrowKeeps * place_of.narrow) +
                          kFirstFrost * max(1.0f - open_depth / kFirstDepth, 0.0f);
  const float lip = kLip * depth * (0.05f + 0.95f * steep) * clamp(0.8f + 0.5f * place_of.hem, 0.3f, 1.5f);
  const float sink = min(min(kSink, 0.3f * depth + 0.0008f), place_of.deepest);
  const SnowEdge made = {threshold, lip, sink};
  return made;
}

/// Greatest shown height for a thickness, without the surface noise.
float most_shown(float thickness) { return 1.5f * thickness + 0.004f; }

/// Height of the shown snow above the receiver's surface. It is negative where no snow shows, so that the snow ends
/// where two surfaces intersect. The caller smooths it over the surface to limit its slope.
float thin_snow(const SnowEdge edge, float thickness) {
  const float x = thickness - edge.threshold;
  if (x < 0.0f) return -edge.sink * (1.0f - exp(x / (0.25f * edge.sink + 0.1f * edge.lip + 1e-6f)));
  const float lip = sqrt(x * x + 2.0f * edge.lip * x * exp(-x / (2.5f * edge.lip)));
  const float kept = edge.threshold * (1.0f - exp(-x / edge.threshold));
  return min(lip + kept, most_shown(thickness));
}

/// Height of a layer on a convex surface with the same volume of snow as a layer of `height` on a flat surface. The
/// area of the layer grows with its height.
float swept_height(const SnowPoint place_of, float height) {
  if (height <= 0.0f || place_of.convexity * height < 1e-4f) return height;
  return (sqrt(1.0f + 2.0f * place_of.convexity * height) - 1.0f) / place_of.convexity;
}

/// Height of the surface noise.
float surface_relief(const SnowPoint place_of, const SnowStyle style,
                                               float height, float open_depth) {
  const float wave = clamp(kRelief * place_of.relief + kBumps * place_of.bumps, -kMaxRelief, kMaxRelief);
  return style.relief * wave * min(max(height, 0.0f), open_depth);
}

/// Distance that snow hangs down the slope at its border on a steep place.
float sagging(const SnowPoint place_of, const SnowStyle style,
                                        const SnowEdge edge, float thickness, float height, float up) {
  const float x = max(thickness - edge.threshold, 0.0f);
  const float amount = clamp(kSag + style.hem_variation * kSagVariation * place_of.hem, 0.0f, kMaxSag);
  return style.overhang * max(height, 0.0f) * amount * exp(-x / (1.5f * edge.lip)) * steepness(up) *
         eased(up, -0.2f, 0.2f);
}

// The constants of a point of the snow surface, from its position and the thickness of its carrier.

/// Greatest depth of bare places below the receiver's surface, as a fraction of the carrier's thickness.
static const float kSinkPart = 0.45f;
/// A carrier thicker than the first fraction of the snow depth is wide; one thinner than the second fraction is narrow.
static const float kWide = 0.8f;
static const float kNarrow = 0.3f;

/// Noise of the relief. `place`: as for point_noise.
float relief_noise(float3 place) {
  return layered_noise(place + 21.0f, float3(4.0f, 1.7f, 0.8f), 0.65f);
}

/// The noise of a point, without its bumps. `place`: position divided by the snow depth at the shot's end, so that the
/// noise is the same at any scale.
SnowPoint point_noise(float3 place) {
  SnowPoint place_of;
  place_of.patches = layered_noise(place + 50.0f, float3(2.2f, 1.0f, 0.45f), 0.8f);
  place_of.hem = layered_noise(place, float3(3.0f, 1.5f, 0.6f), 0.7f);
  place_of.relief = relief_noise(place);
  place_of.bumps = 0.0f;
  place_of.deepest = 1e9f;
  place_of.convexity = 0.0f;
  place_of.narrow = 0.0f;
  return place_of;
}

/// Noise of the bumps. `place`: position on the shown surface, in the same unit as for point_noise.
float bump_noise(float3 place) {
  return layered_noise(place + 70.0f, float3(1.1f, 0.5f, 0.0f), 0.6f);
}

/// Adds the carrier's constants to a point. `thickness`: thickness of the carrier; `depth`: snow depth at the shot's
/// end, both in metres.
SnowPoint on_carrier(const SnowPoint place_of, float thickness, float depth) {
  SnowPoint made = place_of;
  made.deepest = max(kSinkPart * thickness, 1e-5f);
  made.narrow = eased(thickness, kWide * depth, kNarrow * depth);
  return made;
}

/// Adds the constants of a round limb to a point. `width`: width of the limb in metres. At 0 the limb counts as flat
/// and as narrow, so that most snow shows.
SnowPoint on_limb(const SnowPoint place_of, float width, float depth) {
  SnowPoint made = on_carrier(place_of, width, depth);
  made.convexity = width > 0.0f ? 2.0f / width : 0.0f;
  return made;
}

/// Height of the shown snow on a limb; 0 if no snow shows.
float limb_height(const SnowPoint place_of, const SnowStyle style,
                                            const SnowEdge edge, float thickness, float open_depth) {
  const float height = max(thin_snow(edge, thickness), 0.0f);
  return swept_height(place_of, height + surface_relief(place_of, style, height, open_depth));
}

/// Upper bound of the distance between a point away from rims and its carrier, for snow up to `thickness` in the map.
float farthest_offset(float thickness, const SnowStyle style) {
  const float height = (1.0f + style.relief * kMaxRelief) * most_shown(thickness);
  return thickness > 0.0f ? height * length(float3(1.0f, style.overhang * kMaxSag, 0.0f)) : 0.0f;
}
