# SPDX-License-Identifier: GPL-3.0-or-later
"""The relief of lying snow, from wind and settling, which is finer than the maps and than the mesh of a surface.

Octaves of noise in metres in the object's own space, so the relief stays in place while the object moves and deforms,
and does not depend on UV charts. It fades out on thin snow and therefore at the edge of the snow. `add_relief` is for
materials that displace, `add_waves` for the bumps of all materials.
"""

from ..base import compat_nodes

# The slider of both; 1 uses OCTAVES unchanged, fresh snow has 0.6.
RELIEF_INPUT = "Relief"
# Relief of fresh snow, at which the slider of the surface is 1.
FRESH_RELIEF = 0.6

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


# Bumps that shade: their length in metres, or in depths of open ground; their height from hollow to crest in metres at
# most, and as a share of the local depth. The heights hold for fresh snow.
LUMP, LUMP_HEIGHT, LUMP_SHARE = 0.06, 0.008, 0.12
CROWN, CROWN_SHARE = 3.0, 0.2
DRIFT, DRIFT_SHARE = 18.0, 1.0
RIPPLE, RIPPLE_HEIGHT, RIPPLE_SHARE = 0.13, 0.011, 0.12
# A ripple is so many times longer than its wavelength, and drifts bend it by so many of these.
RIPPLE_LENGTH, RIPPLE_BEND = 2.5, 4.0
# Open ground: the upward component of the normal, and the thickness as a share of the depth there.
LEVEL, OPEN = (0.85, 0.97), (0.4, 0.85)


def _wave(builder, position, scale, **properties):
    """Gradient noise, stretched to about -0.5 to 0.5."""
    noise = builder.node("ShaderNodeTexNoise", **properties)
    builder.feed(noise, Vector=position, Scale=scale, Detail=0.0)
    return builder.math("MULTIPLY_ADD", compat_nodes.noise_value(noise), GAIN, -0.5 * GAIN)


def _ramp(builder, value, low, high):
    """From 0 at low to 1 at high, in a single node: a bump evaluates its nodes three times."""
    return builder.math("MULTIPLY_ADD", value, 1.0 / (high - low), -low / (high - low), clamp=True)


def add_lumps(builder, position):
    """Noise of 6 and 3 cm, about -0.5 to 0.5."""
    noise = builder.node("ShaderNodeTexNoise")
    builder.feed(noise, Vector=position, Scale=1.0 / LUMP, Detail=1.0)
    return builder.math("MULTIPLY_ADD", compat_nodes.noise_value(noise), GAIN, -0.5 * GAIN)


def add_waves(builder, position, lumps, normal, thickness, depth, wind, strength):
    """(metres, crests) of the bumps, as sockets. crests: about -0.5 in hollows to 0.5 on crests.

    Lumps of 2 to 6 cm lie everywhere, slow waves on crowns too; broad drifts and ripples across the wind on open level
    ground. position: metres in the object's space. lumps: result of add_lumps. normal: in the world. thickness: local
    depth in metres; depth: that of open ground at the end of the shot. wind: level direction in the object's space, as
    long as its strength (0 to 1). strength: RELIEF_INPUT.
    """
    per_depth = builder.divide(1.0, builder.math("MAXIMUM", depth, 0.005))
    crowns = _wave(builder, position, builder.divide(per_depth, CROWN))
    drifts = _wave(builder, position, builder.divide(per_depth, DRIFT))
    full = _ramp(builder, builder.multiply(thickness, per_depth), *OPEN)
    is_open = builder.multiply(full, _ramp(builder, builder.components(normal)[2], *LEVEL))
    drifts = builder.multiply(drifts, is_open)

    along = builder.vector("NORMALIZE", wind)
    across = builder.vector("CROSS_PRODUCT", along, (0.0, 0.0, 1.0))
    along = builder.vector("DOT_PRODUCT", position, builder.scale(along, 1.0 / RIPPLE))
    across = builder.vector("DOT_PRODUCT", position, builder.scale(across, 1.0 / (RIPPLE * RIPPLE_LENGTH)))
    place = builder.combine(builder.math("MULTIPLY_ADD", drifts, RIPPLE_BEND, along), across, 0.0)
    ripples = _wave(builder, place, 1.0, noise_dimensions="2D")
    # Wind leaves calm patches.
    blowing = builder.multiply(is_open, builder.vector("LENGTH", wind))
    ripples = builder.multiply(
        ripples, builder.multiply(blowing, builder.smoothstep(drifts, -0.3, 0.15, 0.3))
    )

    strong = builder.divide(strength, FRESH_RELIEF)
    shares = builder.math("MULTIPLY_ADD", crowns, CROWN_SHARE, builder.multiply(drifts, DRIFT_SHARE))
    total = builder.multiply(builder.math("MINIMUM", thickness, depth), shares)
    for wave, share, most in ((lumps, LUMP_SHARE, LUMP_HEIGHT), (ripples, RIPPLE_SHARE, RIPPLE_HEIGHT)):
        bound = builder.math("MINIMUM", builder.multiply(thickness, share), most)
        total = builder.math("MULTIPLY_ADD", wave, bound, total)
    crests = builder.add(ripples, builder.multiply(builder.add(lumps, builder.add(crowns, drifts)), 0.6))
    seen = builder.multiply(
        builder.math("MINIMUM", strong, 1.5), builder.smoothstep(thickness, 0.0, FULL_DEPTH)
    )
    return builder.multiply(total, strong), builder.multiply(crests, seen)
