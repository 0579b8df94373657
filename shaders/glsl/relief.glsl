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
