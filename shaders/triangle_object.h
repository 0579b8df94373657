// GLSL only: whose triangle it is.

/// The scene's triangles word by word: a vector of words is gathered faster than a vector of triangles.
uniform usamplerBuffer triangle_words;

/// Slot of a triangle's object, with kReceives.
uint object_of(uint triangle) { return texelFetch(triangle_words, int(4u * triangle + 3u)).x; }
