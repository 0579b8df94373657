// GLSL only: limit of a link between two points of the bare surface, for repose.

/// Steepest slope of snow, as a tangent, and cohesion in metres.
uniform float slope_at_rest;
uniform float cohesion;

/// `curvature` and `steep`: of the bare surface between the points. `leads_down`: see link_limit.
float limit_between(vec3 a, vec3 b, float curvature, float steep, float leads_down) {
  const vec2 across = b.xy - a.xy;
  return link_limit(length(across), held_slope(slope_at_rest, cohesion, curvature), b.z - a.z, steep, leads_down);
}
