// GLSL only: triangles as the fall meets them, found by triangle_fall.comp.glsl.

/// Three a triangle, its corners: xyz = local pixel and depth. w of the first two: depth that its plane gains
/// in one pixel along the grid's axes; w of the third: facing.
uniform samplerBuffer triangle_corners;
/// x: cosine between the normal and the way to the sky ("facing"), y: area in m2, z: upward part of the
/// normal. All are 0 for a triangle without area.
uniform samplerBuffer triangle_surface;
