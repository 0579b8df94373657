# SPDX-License-Identifier: GPL-3.0-or-later
"""The encoding of the renderer's frames: 24 bits in the float of a one-channel texture. No ``bpy``.

The bits of a pixel are 0x3F000000 plus one byte each for red, green and blue. The byte of a linear value c is
255 * (c / (1 + c))^(1 / 2.2). shaders/lib/frame_code.h packs them and gives the reason.
"""

import numpy as np

GAMMA = 2.2

# Arguments of base.view_drawing.make_shader, and a triangle that covers the region.
INPUTS = {"attributes": {"position": "VEC2"}, "varying": ("VEC2", "uv"), "samplers": ("frame",)}
CORNERS = ((-1.0, -1.0), (3.0, -1.0), (-1.0, 3.0))

VERTEX = """
void main()
{
  uv = 0.5 * position + 0.5;
  gl_Position = vec4(position, 0.0, 1.0);
}
"""

# A frame may have fewer pixels than the region: bilinear interpolation of the linear values.
FRAGMENT = """
vec3 light_at(ivec2 place)
{
  ivec2 inside = clamp(place, ivec2(0), textureSize(frame, 0) - 1);
  uint word = floatBitsToUint(texelFetch(frame, inside, 0).x) - 0x3F000000u;
  vec3 bytes = vec3(float((word >> 16u) & 255u), float((word >> 8u) & 255u), float(word & 255u));
  vec3 share = pow(bytes / 255.0, vec3(2.2));
  return share / (vec3(1.0) - share);
}

void main()
{
  vec2 at = uv * vec2(textureSize(frame, 0)) - 0.5;
  ivec2 low = ivec2(floor(at));
  vec2 part = at - vec2(low);
  vec3 below = mix(light_at(low), light_at(low + ivec2(1, 0)), part.x);
  vec3 above = mix(light_at(low + ivec2(0, 1)), light_at(low + ivec2(1, 1)), part.x);
  color = vec4(mix(below, above, part.y), 1.0);
}
"""


def light(frame):
    """Decodes a packed frame, (H, W) float32, to linear colours, (H, W, 3) float32."""
    words = np.ascontiguousarray(frame, dtype=np.float32).view(np.uint32) - np.uint32(0x3F000000)
    shifts = np.array([16, 8, 0], np.uint32)
    share = (((words[..., None] >> shifts) & np.uint32(255)) / 255.0) ** GAMMA
    return (share / (1.0 - share)).astype(np.float32)
