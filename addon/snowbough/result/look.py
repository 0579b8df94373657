# SPDX-License-Identifier: GPL-3.0-or-later
"""Kinds of snow: values of the sliders of all snow in a scene, and of the scene's repose and cohesion.

Choosing a kind sets the sliders once. Afterwards artists can change them.
"""

import math
from dataclasses import dataclass

from ..base.names import SNOW_GROUP, SNOW_KINDS
from .relief_nodes import FRESH_RELIEF, RELIEF_INPUT


@dataclass(frozen=True)
class Look:
    """Values of the inputs with these names (snow_nodes.INPUTS), of the relief, of the repose in degrees, and of the
    cohesion in metres."""

    color: tuple
    dusting: float
    grain: float
    subsurface: float
    sparkle: float
    relief: float
    repose: float
    cohesion: float

    def inputs(self):
        return {
            "Color": (*self.color, 1.0),
            "Dusting": self.dusting,
            "Grain": self.grain,
            "Subsurface": self.subsurface,
            "Sparkle": self.sparkle,
            RELIEF_INPUT: self.relief,
        }


# Grains of wet and old snow are larger: they reflect less light and absorb more, mostly red (S. G. Warren, Optical
# Properties of Snow, Reviews of Geophysics 20, 1982). Powder has little cohesion, wet snow has much.
LOOKS = dict(
    zip(
        (kind for kind, *_ in SNOW_KINDS),
        (
            Look((0.92, 0.94, 0.97), 0.006, 1.3, 0.35, 1.0, 0.4, 40.0, 0.002),
            Look((0.90, 0.93, 0.96), 0.004, 1.0, 0.40, 0.6, 0.6, 65.0, 0.005),
            Look((0.80, 0.86, 0.92), 0.003, 0.5, 0.60, 0.1, 0.4, 80.0, 0.012),
            Look((0.80, 0.82, 0.84), 0.005, 1.8, 0.25, 0.3, 1.0, 60.0, 0.004),
        ),
    )
)


def of(scene):
    """The Look of the scene's kind of snow."""
    return LOOKS[scene.snowbough.kind]


def set_group_inputs(node, look):
    """Sets the sliders of a group node."""
    for name, value in look.inputs().items():
        if name in node.inputs:
            node.inputs[name].default_value = value


def group_nodes(material):
    """The snow nodes of a material, which may be None."""
    nodes = material.node_tree.nodes if material is not None and material.node_tree else ()
    return [
        node
        for node in nodes
        if node.type == "GROUP" and node.node_tree and node.node_tree.name == SNOW_GROUP
    ]


def apply(scene, kind):
    """Gives all snow of the scene, and snow that is added later, the look of that kind."""
    settings, look = scene.snowbough, LOOKS[kind]
    settings.kind = kind
    settings.repose = math.radians(look.repose)
    settings.cohesion = look.cohesion
    settings.surface_relief = look.relief / FRESH_RELIEF
    for obj in scene.objects:
        for slot in obj.material_slots:
            if slot.material is not None and slot.material.library is None:
                for node in group_nodes(slot.material):
                    set_group_inputs(node, look)
