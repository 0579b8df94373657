# SPDX-License-Identifier: GPL-3.0-or-later
"""The relief of lying snow, from wind and settling, which is finer than the maps and than the mesh of a surface.

Octaves of noise in metres in the object's own space, so the relief stays in place while the object moves and deforms,
and does not depend on UV charts. It fades out on thin snow and therefore at the edge of the snow. `add_relief` is for
materials that displace, `add_waves` for the bumps of all materials.
"""

import math

from ..base import compat_nodes

# The slider of both; 1 uses AMPLITUDE unchanged, fresh snow has 0.6.
RELIEF_INPUT = "Relief"
# Relief of fresh snow, at which the slider of the surface is 1.
FRESH_RELIEF = 0.6

# Waves per metre, amplitude in metres, and octaves after the first.
WAVES, AMPLITUDE, MORE_OCTAVES = 11.0, 0.0155, 2.0
# Thinner snow than this (metres) has less relief, and at most this share of its thickness.
FULL_DEPTH = 0.06
MAX_OF_DEPTH = 0.3
# Gradient noise rarely comes near 0 or 1; these factors stretch it, of one or two octaves and of three.
GAIN, GAIN_OF_THREE = 1.7, 2.4


def _noise(builder, position, scale, more_octaves, height):
    """Gradient noise from about -height / 2 to height / 2 once it is stretched by one of the gains."""
    noise = builder.node("ShaderNodeTexNoise")
    builder.feed(noise, Vector=position, Scale=scale, Detail=more_octaves, Roughness=0.6)
    return builder.math("MULTIPLY_ADD", compat_nodes.noise_value(noise), height, -0.5 * height)


def add_relief(builder, position, thickness, strength):
    """Metres to add to the thickness of the snow, as a socket.

    position: metres in the object's space. thickness: metres, not negative. strength: factor on AMPLITUDE.
    """
    waves = _noise(builder, position, WAVES, MORE_OCTAVES, 2.0 * GAIN_OF_THREE * AMPLITUDE)
    faded = builder.multiply(waves, builder.smoothstep(thickness, 0.0, FULL_DEPTH))
    bound = builder.multiply(thickness, MAX_OF_DEPTH)
    strong = builder.multiply(faded, strength)
    return builder.math("MAXIMUM", builder.math("MINIMUM", strong, bound), builder.multiply(bound, -1.0))


# Bumps that shade. A bump evaluates its nodes three times, and the compiler of a graphics card expands each noise every
# time, so there are few: one for lumps, one for drifts and the slow waves of crowns. Both bend ripples, a sine.
# Lengths in metres, or in depths of open ground; heights from hollow to crest in metres at most, and as a share of the
# local depth, for fresh snow.
FINE_HEIGHT, FINE_SHARE = 0.008, 0.12
LUMP = 0.06
DRIFT, DRIFT_OCTAVES = 14.0, 2.0
# Wavelength; height as a multiple of lumps'; radians by which drifts and lumps shift the crests.
RIPPLE, RIPPLE_HEIGHT, BENT_BY_DRIFTS, BENT_BY_LUMPS = 0.13, 0.4, 22.0, 2.2
# Open ground: the upward component of the normal, and the thickness as a share of the depth there.
LEVEL, OPEN = (0.85, 0.97), (0.4, 0.85)


def _ramp(builder, value, low, high):
    """From 0 at low to 1 at high, in a single node."""
    return builder.math("MULTIPLY_ADD", value, 1.0 / (high - low), -low / (high - low), clamp=True)


def add_lumps(builder, position):
    """Noise of 6 and 3 cm, about -0.5 to 0.5."""
    return _noise(builder, position, 1.0 / LUMP, 1.0, GAIN)


def add_waves(builder, position, lumps, normal, thickness, depth, wind, strength):
    """(metres, crests) of the bumps, as sockets. crests: about -0.5 in hollows to 0.5 on crests.

    Lumps of 2 to 6 cm and waves 14 to 3.5 depths long lie everywhere, ripples across the wind on open level ground.
    position: metres in the object's space. lumps: result of add_lumps. normal: in the world. thickness: local depth in
    metres; depth: that of open ground at the end of the shot. wind: level direction in the object's space, as long as
    its strength (0 to 1). strength: RELIEF_INPUT.
    """
    depth = builder.math("MAXIMUM", depth, 0.005)
    drifts = _noise(builder, position, builder.divide(1.0 / DRIFT, depth), DRIFT_OCTAVES, GAIN_OF_THREE)

    along = builder.vector("DOT_PRODUCT", position, builder.vector("NORMALIZE", wind))
    bend = builder.math("MULTIPLY_ADD", lumps, BENT_BY_LUMPS, builder.multiply(drifts, BENT_BY_DRIFTS))
    ripples = builder.math("SINE", builder.math("MULTIPLY_ADD", along, 2.0 * math.pi / RIPPLE, bend))
    full = _ramp(builder, builder.divide(thickness, depth), *OPEN)
    is_open = builder.multiply(full, _ramp(builder, builder.components(normal)[2], *LEVEL))
    blowing = builder.multiply(is_open, builder.vector("LENGTH", wind))
    # Wind leaves calm patches.
    windy = builder.smoothstep(drifts, -0.25, 0.25, 0.1 * RIPPLE_HEIGHT, RIPPLE_HEIGHT)
    fine = builder.math("MULTIPLY_ADD", ripples, builder.multiply(blowing, windy), lumps)

    strong = builder.multiply(strength, 1.0 / FRESH_RELIEF)
    bound = builder.math("MINIMUM", builder.multiply(thickness, FINE_SHARE), FINE_HEIGHT)
    broad = builder.multiply(drifts, builder.math("MINIMUM", thickness, depth))
    total = builder.math("MULTIPLY_ADD", fine, bound, broad)
    seen = builder.multiply(
        builder.math("MINIMUM", strong, 1.5), builder.smoothstep(thickness, 0.0, FULL_DEPTH)
    )
    crests = builder.math("MULTIPLY_ADD", drifts, full, fine)
    return builder.multiply(total, strong), builder.multiply(crests, seen)
