// Bark as a height over a limb's round surface, -1 to 1: furrows along the limb, plates, and grain, one octave each. x
// runs once around the limb and y along it in circumferences, so there is no seam. An octave fades out before the
// sample distance exceeds it, so that it does not pop.

const int kBarkOctaves = 4;
/// Waves of the coarsest octave around a limb; each octave has twice as many.
const int kBarkWaves = 8;
/// Ratio of a furrow's length to its width.
const float kFurrowStretch = 5.0;
/// Samples per wave at which an octave begins to show, and at which it shows fully.
const float kOctaveBegins = 2.0;
const float kOctaveStands = 4.0;

float bark_hash(ivec2 cell, int octave) {
  uint h = uint(cell.x) * 0x8da6b343u ^ uint(cell.y) * 0xd8163841u ^ uint(octave) * 0xcb1ab31fu;
  h = (h ^ (h >> 15)) * 0x2c1b3c6du;
  h = (h ^ (h >> 12)) * 0x297a2d39u;
  return float((h ^ (h >> 15)) & 0xffffffu) / 16777215.0;
}

/// Value noise, 0 to 1, that repeats every `waves` (a power of two) in x, and its slopes in x and y.
vec3 bark_noise(vec2 p, int waves, int octave) {
  const vec2 cell = floor(p);
  const vec2 f = p - cell;
  const vec2 s = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
  const vec2 slope = 30.0 * f * f * (f * (f - 2.0) + 1.0);
  const ivec2 low = ivec2(cell);
  const int left = low.x & (waves - 1);
  const int right = (low.x + 1) & (waves - 1);
  const float a = bark_hash(ivec2(left, low.y), octave);
  const float b = bark_hash(ivec2(right, low.y), octave);
  const float c = bark_hash(ivec2(left, low.y + 1), octave);
  const float d = bark_hash(ivec2(right, low.y + 1), octave);
  const float near = mix(a, b, s.x);
  const float far = mix(c, d, s.x);
  return vec3(mix(near, far, s.y), slope.x * mix(b - a, d - c, s.y), slope.y * (far - near));
}

/// The height, and its slopes in the bark's coordinates. `samples`: number of samples around the limb; `bottom`: width
/// of the furrows' round bottom in samples.
vec3 bark_relief(vec2 bark_uv, float samples, float bottom) {
  vec3 relief = vec3(0.0);
  float weight = 0.5;
  for (int octave = 0; octave < kBarkOctaves; ++octave) {
    const int waves = kBarkWaves << octave;
    const float shown = smoothstep(kOctaveBegins, kOctaveStands, samples / float(waves));
    if (shown > 0.0) {
      const float stretch = octave < 2 ? kFurrowStretch : 1.5;
      const vec2 scale = float(waves) * vec2(1.0, 1.0 / stretch);
      const vec3 noise = bark_noise(bark_uv * scale, waves, octave);
      // Furrows are narrow between broad ridges.
      const float swing = 2.0 * noise.x - 1.0;
      const float least = bottom * float(waves) / samples;
      const float side = max(least > 0.0 ? sqrt(swing * swing + least * least) : abs(swing), 1e-6);
      const float furrow = 1.0 - min(side, 1.0);
      const vec2 wave = octave < 2 ? vec2(1.0 - 2.0 * furrow * furrow, 8.0 * furrow * swing / side) : vec2(swing, 2.0);
      relief += weight * shown * vec3(wave.x, wave.y * scale * noise.yz);
    }
    weight *= 0.5;
  }
  return relief;
}

float bark_height(vec2 bark_uv, float samples) {
  return bark_relief(bark_uv, samples, 0.0).x;
}
