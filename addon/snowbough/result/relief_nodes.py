# SPDX-License-Identifier: GPL-3.0-or-later
"""The relief of lying snow: what wind and settling leave on a surface that maps of millimetres do not hold.

Octaves of noise in the object's own space, in metres, so that relief stays where it is while the object moves and
deforms and knows nothing of UV charts. It fades to nothing on thin snow and so at the snow's edge. The nodes
stand in materials that displace.
"""

from .. import compat_nodes

# The slider of materials that displace; 1 is OCTAVES as they stand, fresh snow has 0.6.
RELIEF_INPUT = "Relief"

# (waves a metre, metres up and down)
OCTAVES = ((9.0, 0.009), (23.0, 0.0045), (60.0, 0.002))
# Thinner snow than this has less relief (metres), and never more than this share of its thickness.
FULL_DEPTH = 0.06
MOST_OF_DEPTH = 0.3
# A wave needs this many faces to be seen as one.
FACES_A_WAVE = 2.0
# Gradient noise hardly ever comes near 0 or 1: so much it is drawn out.
GAIN = 1.7


def octaves_for(face_size):
    """Those octaves that faces of that size (metres) can carry; 0.0 for a surface diced to the pixel."""
    return [octave for octave in OCTAVES if octave[0] * face_size * FACES_A_WAVE <= 1.0]


def highest(thickness, strength=1.0):
    """The bound of the relief in metres, either way, on snow of that thickness (metres)."""
    return min(sum(height for _, height in OCTAVES) * GAIN * strength, MOST_OF_DEPTH * thickness)


def add_relief(builder, position, thickness, strength, octaves):
    """Metres to add to the snow's thickness, a socket.

    position: metres in the object's space. thickness: metres, not negative. strength: what OCTAVES are multiplied by.
    """
    total = None
    for waves, height in octaves:
        noise = builder.node("ShaderNodeTexNoise")
        builder.feed(noise, Vector=position, Scale=waves, Detail=0.0)
        wave = builder.math(
            "MULTIPLY_ADD", compat_nodes.noise_value(noise), 2.0 * GAIN * height, -GAIN * height
        )
        total = wave if total is None else builder.add(total, wave)
    if total is None:
        return None
    faded = builder.multiply(total, builder.smoothstep(thickness, 0.0, FULL_DEPTH))
    bound = builder.multiply(thickness, MOST_OF_DEPTH)
    strong = builder.multiply(faded, strength)
    return builder.math("MAXIMUM", builder.math("MINIMUM", strong, bound), builder.multiply(bound, -1.0))
