// Snow on a mesh from its height map, without displacement: its cover and its normal.

/// Metres along the surface's normal; negative on the back.
uniform sampler2D snow_heights;

const vec3 kPaintedSnow = vec3(0.86, 0.88, 0.91);
/// Depth in metres at which snow fully hides the surface below.
const float kCoveringDepth = 0.01;

struct Snow {
  /// 0 to 1.
  float cover;
  vec3 normal;
};

/// Source of the normal: M. S. Mikkelsen, Bump Mapping Unparametrized Surfaces on the GPU, 2010.
Snow lying_snow(vec2 uv, vec3 position, vec3 normal, vec3 face) {
  const float height = texture(snow_heights, uv).x;
  // Use the map's own slope over a texel: screen-space derivatives of a filtered map would show its texels.
  const vec2 texel = 1.0 / vec2(textureSize(snow_heights, 0));
  const float du = texture(snow_heights, uv + vec2(texel.x, 0.0)).x - texture(snow_heights, uv - vec2(texel.x, 0.0)).x;
  const float dv = texture(snow_heights, uv + vec2(0.0, texel.y)).x - texture(snow_heights, uv - vec2(0.0, texel.y)).x;
  const vec2 slope = 0.5 * vec2(du, dv) / texel;
  const float rise_x = dot(slope, dFdx(uv));
  const float rise_y = dot(slope, dFdy(uv));
  const vec3 x = dFdx(position);
  const vec3 y = dFdy(position);
  const vec3 r1 = cross(y, normal);
  const vec3 r2 = cross(normal, x);
  const float det = dot(x, r1);
  vec3 raised = abs(det) * normal - sign(det) * (rise_x * r1 + rise_y * r2);
  raised = dot(raised, face) > 0.0 ? normalize(raised) : normal;
  return Snow(smoothstep(0.0, kCoveringDepth, abs(height)), raised);
}
