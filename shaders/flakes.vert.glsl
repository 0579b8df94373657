// Falling flakes as cards that face the eye, six vertices each, stretched along their motion while the shutter is open.
#include "glsl/tree_view.glsl"
#include "lib/flake_fall.h"

layout(std140) uniform FallBlock { FlakeFall fall; };
out vec2 on_card;
out float visible;

/// Flakes thinner than this many pixels are drawn that wide, and as much paler.
const float kMinPixels = 1.2;
/// Fraction of the box at its border within which flakes fade, and metres in front of the eye.
const float kFade = 0.15;
const float kNearest = 0.25;

uint mixed(uint h) {
  h = (h ^ (h >> 16)) * 0x7feb352du;
  h = (h ^ (h >> 15)) * 0x846ca68bu;
  return h ^ (h >> 16);
}

float unit_hash(uint h) {
  return float(h & 0xffffffu) / 16777216.0;
}

/// A flake's sideways offset at a time: two oscillations across the fall, out of phase.
vec3 fluttered(uint h, float time) {
  const vec3 down = fall.velocity.xyz / max(length(fall.velocity.xyz), 1e-6);
  const vec3 one = normalize(cross(down, abs(down.x) < 0.9 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0)));
  const vec3 other = cross(down, one);
  const float rate = 6.2831853 * fall.flutter.y * (0.6 + 0.8 * unit_hash(mixed(h + 11u)));
  const float phase = 6.2831853 * unit_hash(mixed(h + 12u));
  const float size = fall.flutter.x * (0.5 + unit_hash(mixed(h + 13u)));
  return size * (sin(rate * time + phase) * one + sin(0.83 * rate * time + 2.0 * phase) * other);
}

void main() {
  const uint flake = uint(gl_VertexID / 6);
  const uint h = mixed(flake + mixed(fall.counts.x));
  const float box = fall.drift.w;
  const vec3 start = box * vec3(unit_hash(mixed(h + 1u)), unit_hash(mixed(h + 2u)), unit_hash(mixed(h + 3u)));
  const vec3 at = start + fall.drift.xyz + fluttered(h, fall.flutter.w);
  // The copy of the lattice's cell that is nearest to the eye.
  const vec3 from_eye = at - view.eye.xyz - box * round((at - view.eye.xyz) / box);
  const vec3 middle = view.eye.xyz + from_eye;
  const vec3 tail = fluttered(h, fall.flutter.w - fall.flutter.z) - fluttered(h, fall.flutter.w) -
                    fall.velocity.xyz * fall.flutter.z;
  const float away = max(length(from_eye), 1e-4);
  const float radius = fall.velocity.w * (0.6 + 0.8 * unit_hash(mixed(h + 4u)));
  const float drawn = max(radius, 0.5 * kMinPixels * away / view.eye.w);
  const vec3 to_eye = -from_eye / away;
  vec3 along = tail - to_eye * dot(tail, to_eye);
  const float streak = length(along);
  along = streak > 1e-6 ? along / streak : normalize(cross(to_eye, vec3(0.37, 0.81, 0.45)));
  const vec3 across = cross(along, to_eye);
  const int corner = gl_VertexID % 6;
  const vec2 side = vec2(corner == 1 || corner == 2 || corner == 4 ? 1.0 : -1.0, corner == 2 || corner > 3 ? 1.0 : -1.0);
  const vec3 place = middle + across * (side.x * drawn) + along * (side.y * drawn + (side.y > 0.0 ? streak : 0.0));
  on_card = side;
  const vec3 border = abs(from_eye) / (0.5 * box);
  const float within = 1.0 - smoothstep(1.0 - kFade, 1.0, max(border.x, max(border.y, border.z)));
  const float paler = radius * radius / (drawn * (drawn + 0.5 * streak));
  visible = flake < fall.counts.y ? within * smoothstep(kNearest, 3.0 * kNearest, away / fall.scale.x) * min(paler, 1.0) : 0.0;
  gl_Position = view.clip_from_world * vec4(place, 1.0);
}
