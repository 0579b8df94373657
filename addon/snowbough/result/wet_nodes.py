# SPDX-License-Identifier: GPL-3.0-or-later
"""Wet surfaces: darker, because light that enters a film of water is mirrored back into the ground and absorbed
(J. Lekner and M. Dorf, Why some things are darker when wet, Applied Optics 27, 1988), and glossy as water."""

from ..base import compat_nodes

# Share of the light that soaked ground loses, and soaked snow.
DARK, DARK_SNOW = 0.5, 0.12
# Refractive index of water, and roughness of its film.
WATER, FILM = 1.33, 0.12
# Wetness from which the film mirrors.
SHINES = 0.35


def add_wet(builder, shader, wet, coverage, is_surface):
    """The shader under water. wet: 0 (dry) to 1 (soaked); coverage: of the surface by snow, 0 to 1. is_surface: 1 for
    snow above its receiver, whose gaps show what the receiver's own material has made wet, else 0."""
    wet = builder.multiply(wet, builder.math("MAXIMUM", coverage, builder.subtract(1.0, is_surface)))
    black = builder.feed(builder.node("ShaderNodeBsdfDiffuse"), Color=(0.0, 0.0, 0.0, 1.0)).outputs[0]
    snow = builder.math("MAXIMUM", coverage, is_surface)
    loss = builder.math("MULTIPLY_ADD", snow, DARK_SNOW - DARK, DARK)
    dark = builder.mixed(builder.multiply(wet, loss), shader, black)
    mirror = compat_nodes.glossy(builder)
    builder.feed(mirror, Roughness=FILM, Color=(1.0, 1.0, 1.0, 1.0))
    fresnel = builder.feed(builder.node("ShaderNodeFresnel"), IOR=WATER).outputs[0]
    film = builder.smoothstep(wet, SHINES, 1.0)
    return builder.mixed(builder.multiply(fresnel, film), dark, mirror.outputs[0])
