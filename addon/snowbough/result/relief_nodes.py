# SPDX-License-Identifier: GPL-3.0-or-later
"""The relief of lying snow, from wind and settling, which is finer than the maps.

Octaves of noise in metres in the object's own space, so the relief stays in place while the object moves and deforms,
and does not depend on UV charts. It fades out on thin snow and therefore at the edge of the snow. These nodes are used
in materials that displace.
"""

from ..base import compat_nodes

# The slider of materials that displace; 1 uses OCTAVES unchanged, fresh snow has 0.6.
RELIEF_INPUT = "Relief"

# (waves per metre, amplitude in metres)
OCTAVES = ((9.0, 0.009), (23.0, 0.0045), (60.0, 0.002))
# Thinner snow than this (metres) has less relief, and at most this share of its thickness.
FULL_DEPTH = 0.06
MOST_OF_DEPTH = 0.3
# Gradient noise rarely comes near 0 or 1; this factor stretches it.
GAIN = 1.7


def add_relief(builder, position, thickness, strength):
    """Metres to add to the thickness of the snow, as a socket.

    position: metres in the object's space. thickness: metres, not negative. strength: factor on OCTAVES.
    """
    total = None
    for waves, height in OCTAVES:
        noise = builder.node("ShaderNodeTexNoise")
        builder.feed(noise, Vector=position, Scale=waves, Detail=0.0)
        wave = builder.math(
            "MULTIPLY_ADD", compat_nodes.noise_value(noise), 2.0 * GAIN * height, -GAIN * height
        )
        total = wave if total is None else builder.add(total, wave)
    faded = builder.multiply(total, builder.smoothstep(thickness, 0.0, FULL_DEPTH))
    bound = builder.multiply(thickness, MOST_OF_DEPTH)
    strong = builder.multiply(faded, strength)
    return builder.math("MAXIMUM", builder.math("MINIMUM", strong, bound), builder.multiply(bound, -1.0))
