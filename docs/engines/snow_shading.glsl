// SPDX-License-Identifier: GPL-3.0-or-later
// The light of snow. tools/engine_rule.py writes this file from shaders/glsl: change it there.
// Lengths are in metres; z is up.

/// The camera and the light. The caller sets `view`.
struct SnowView {
  /// w: pixels that a metre covers at one metre's distance.
  vec4 eye;
  /// Unit vector towards the sun.
  vec3 sun_direction;
  /// Linear light of the sun, and from straight above and straight below.
  vec3 sun_color;
  vec3 sky_color;
  vec3 ground_color;
};
SnowView view;

/// Fraction of the sun's light that reaches a point: put your engine's shadows in its place.
float sunlit(vec3 position, vec3 normal, float reach) { return 1.0; }

// Bump mapping from a height per pixel.

/// Least cosine between the normal and the drawn face's normal that the gradient uses. At smaller cosines the
/// differences between pixels would outweigh the normal.
const float kMinFacing = 0.2;

/// `rise`: differences of the height to the next pixels in x and y.
/// Source: M. S. Mikkelsen, Bump Mapping Unparametrized Surfaces on the GPU, 2010.
vec3 with_rise(vec3 position, vec3 normal, vec2 rise) {
  const vec3 x = dFdx(position);
  const vec3 y = dFdy(position);
  const vec3 r1 = cross(y, normal);
  const vec3 r2 = cross(normal, x);
  const float det = dot(x, r1);
  const vec3 gradient = sign(det) * (rise.x * r1 + rise.y * r2);
  const vec3 raised = max(abs(det), kMinFacing * length(cross(x, y))) * normal - gradient;
  return dot(raised, raised) > 0.0 ? normalize(raised) : normal;
}

vec3 with_relief(vec3 position, vec3 normal, float height) {
  return with_rise(position, normal, vec2(dFdx(height), dFdy(height)));
}

// Shading of snow on any object: subsurface scattering, fine bumps, grains and glinting crystals. All patterns are
// fixed to the object's first pose and fade out before they are finer than pixels.

/// Linear colour.
const vec3 kSnowAlbedo = vec3(0.85, 0.885, 0.93);
/// Wrap lighting: how far light extends past the terminator, per colour. Snow absorbs red first.
const vec3 kWrap = vec3(0.16, 0.22, 0.30);
/// Depth of snow in metres at which 1 / e of the sunlight remains. Light through thin snow makes rims glow and hides
/// the edges of facets at the terminator.
const float kReach = 0.02;
/// Depth of snow in metres at which 1 / e of the ground's colour shows through.
const float kOpaqueDepth = 0.0022;
/// Bump octaves: waves per metre, heights in metres, and the snow depth in metres at which they reach full height.
const int kReliefOctaves = 4;
const float kReliefWaves[kReliefOctaves] = float[kReliefOctaves](7.0, 21.0, 57.0, 150.0);
const float kReliefHeights[kReliefOctaves] = float[kReliefOctaves](0.011, 0.0038, 0.0015, 0.0006);
const float kReliefDepth = 0.06;
/// Waves per metre of the grains in thin snow.
const float kGrainWaves = 140.0;
/// Cell size of the smallest crystals and of the largest that still glint, in metres, and the brightness of a glint.
const float kCrystal = 0.0005;
const float kLargestCrystal = 0.004;
const float kGlint = 8.0;

uint mixed(uint h) {
  h = (h ^ (h >> 15)) * 0x2c1b3c6du;
  h = (h ^ (h >> 12)) * 0x297a2d39u;
  return h ^ (h >> 15);
}

uint cell_hash(ivec3 cell) {
  return mixed(uint(cell.x) * 0x8da6b343u ^ uint(cell.y) * 0xd8163841u ^ uint(cell.z) * 0xcb1ab31fu);
}

float unit_hash(uint h) {
  return float(h & 0xffffffu) / 16777215.0;
}

/// Value noise, 0 to 1.
float snow_noise(vec3 p) {
  const vec3 low = floor(p);
  const vec3 f = p - low;
  const vec3 s = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
  const ivec3 cell = ivec3(low);
  vec4 far;
  vec4 near;
  for (int k = 0; k < 4; ++k) {
    const ivec3 corner = cell + ivec3(k & 1, k >> 1, 0);
    near[k] = unit_hash(cell_hash(corner));
    far[k] = unit_hash(cell_hash(corner + ivec3(0, 0, 1)));
  }
  const vec4 at = mix(near, far, s.z);
  const vec2 row = mix(at.xz, at.yw, s.x);
  return mix(row.x, row.y, s.y);
}

/// Visible fraction of a pattern: 1 if its waves are many pixels long, 0 at two pixels.
float shown(float waves, float pixel) {
  return 1.0 - smoothstep(0.12, 0.45, waves * pixel);
}

/// Height (m) of the fine bumps of an even snow cover.
float snow_relief(vec3 place, float depth, float pixel) {
  float height = 0.0;
  for (int octave = 0; octave < kReliefOctaves; ++octave) {
    const float share = shown(kReliefWaves[octave], pixel);
    if (share > 0.0) {
      height += share * kReliefHeights[octave] * snow_noise(place * kReliefWaves[octave]);
    }
  }
  return height * smoothstep(0.0, kReliefDepth, depth);
}

/// Fraction of the ground that snow of a depth (m) hides. A thin cover consists of grains.
float snow_cover(float depth, vec3 place, float pixel) {
  const float hidden = 1.0 - exp(-depth / kOpaqueDepth);
  float grain = 0.5;
  const float share = shown(kGrainWaves, pixel);
  if (hidden > 0.0 && hidden < 0.99 && share > 0.0) {
    const float noise = 0.6 * snow_noise(place * kGrainWaves) + 0.4 * snow_noise(place * 2.7 * kGrainWaves);
    grain = mix(grain, noise, share);
  }
  return smoothstep(0.0, 1.0, (hidden - 0.55 * grain) / 0.45);
}

/// Brightness of the crystal in a cell, whose facet has a random orientation.
float glint(vec3 place, float cell, vec3 normal, vec3 between) {
  const vec3 at = place / cell;
  const ivec3 of = ivec3(floor(at));
  const uint h = cell_hash(of);
  const vec3 tilt = vec3(unit_hash(h), unit_hash(mixed(h + 1u)), unit_hash(mixed(h + 2u))) * 2.0 - 1.0;
  const vec3 middle = 0.3 + 0.4 * vec3(unit_hash(mixed(h + 3u)), unit_hash(mixed(h + 4u)), unit_hash(mixed(h + 5u)));
  const float round_part = 1.0 - smoothstep(0.15, 0.4, distance(at - vec3(of), middle));
  return round_part * smoothstep(0.965, 0.995, dot(normalize(normal + 1.1 * tilt), between));
}

/// Crystals about as large as pixels. Two sizes are blended, so that none appears or vanishes suddenly.
float sparkle(vec3 place, vec3 normal, vec3 between, float pixel) {
  const float size = log2(max(1.6 * pixel / kCrystal, 1.0));
  const float cell = kCrystal * exp2(floor(size));
  const float larger = size - floor(size);
  const float left = 1.0 - smoothstep(0.25 * kLargestCrystal, kLargestCrystal, pixel);
  if (left <= 0.0) {
    return 0.0;
  }
  return left * mix(glint(place, cell, normal, between), glint(place, 2.0 * cell, normal, between), larger);
}

/// Linear light of a snow pixel. `normal`: of the snow surface without fine bumps; `depth`: in metres; `place`:
/// position in the first pose.
vec3 lit_snow(vec3 position, vec3 normal, float depth, vec3 place) {
  const vec3 to_eye = normalize(view.eye.xyz - position);
  const float pixel = distance(view.eye.xyz, position) / view.eye.w;
  const vec3 bumped = with_relief(position, normal, snow_relief(place, depth, pixel));
  const float facing = dot(bumped, view.sun_direction.xyz);
  const vec3 wrapped = max((vec3(facing) + kWrap) / (1.0 + kWrap), 0.0);
  float open = 0.0;
  if (max(max(wrapped.r, wrapped.g), wrapped.b) > 0.0) {
    open = sunlit(position, dot(normal, view.sun_direction.xyz) < 0.0 ? -normal : normal, kReach);
  }
  const vec3 sky = mix(view.ground_color.rgb, view.sky_color.rgb, 0.5 + 0.5 * bumped.z);
  // Light reflected by the surrounding snow reaches hollows from below.
  const vec3 around = 0.25 * kSnowAlbedo * (0.5 - 0.5 * bumped.z) * (view.sky_color.rgb + 0.3 * view.sun_color.rgb);
  vec3 light = kSnowAlbedo * (open * wrapped * view.sun_color.rgb + sky + around);
  if (open > 0.0 && facing > 0.0) {
    const vec3 between = normalize(to_eye + view.sun_direction.xyz);
    light += kGlint * open * sparkle(place, bumped, between, pixel) * smoothstep(0.0, 0.01, depth) * view.sun_color.rgb;
  }
  return light;
}
