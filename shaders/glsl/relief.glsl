// Bump mapping from a height per pixel.

/// Source: M. S. Mikkelsen, Bump Mapping Unparametrized Surfaces on the GPU, 2010.
vec3 with_relief(vec3 position, vec3 normal, float height) {
  const vec3 x = dFdx(position);
  const vec3 y = dFdy(position);
  const vec3 r1 = cross(y, normal);
  const vec3 r2 = cross(normal, x);
  const float det = dot(x, r1);
  const vec3 gradient = sign(det) * (dFdx(height) * r1 + dFdy(height) * r2);
  return normalize(abs(det) * normal - gradient);
}
