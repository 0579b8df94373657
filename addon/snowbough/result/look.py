# SPDX-License-Identifier: GPL-3.0-or-later
"""Kinds of snow, and sand, dust and ash: values of the sliders of all snow in a scene, and of settings of the scene.

Choosing a kind sets all of them once. Afterwards artists can change them.
"""

import math
from dataclasses import dataclass

from ..base.names import SNOW_GROUP
from .relief_nodes import FRESH_RELIEF, RELIEF_INPUT


@dataclass(frozen=True)
class Look:
    """Values of the inputs with these names (snow_nodes.INPUTS), of the relief, and of settings of the simulation:
    angles in degrees, lengths in metres."""

    color: tuple
    dusting: float
    grain: float
    subsurface: float
    sparkle: float
    relief: float
    repose: float
    cohesion: float
    capacity: float = 1.0
    """Maximum Depth."""
    flutter: float = 10.0
    adhesion: float = 0.0
    rising: float = 0.0
    granular: bool = False
    density: float = 100.0

    def inputs(self):
        return {
            "Color": (*self.color, 1.0),
            "Dusting": self.dusting,
            "Grain": self.grain,
            "Subsurface": self.subsurface,
            "Sparkle": self.sparkle,
            RELIEF_INPUT: self.relief,
        }

    def settings(self):
        """{name: value} of the scene's settings."""
        return {
            "repose": math.radians(self.repose),
            "cohesion": self.cohesion,
            "max_depth": self.capacity,
            "flutter": math.radians(self.flutter),
            "adhesion": self.adhesion,
            "rising": self.rising,
            "granular": self.granular,
            "density": self.density,
            "surface_relief": self.relief / FRESH_RELIEF,
        }


# Grains of wet and old snow are larger: they reflect less light and absorb more, mostly red (S. G. Warren, Optical
# Properties of Snow, Reviews of Geophysics 20, 1982). Powder has little cohesion, wet snow has much. Dry sand rests at
# 34 degrees. Dust comes from the whole sky and sticks to all sides.
# fmt: off
LOOKS = {
    "POWDER": Look((0.92, 0.94, 0.97), 0.006, 1.3, 0.35, 1.0, 0.4, 40.0, 0.002, density=60.0),
    "FRESH": Look((0.90, 0.93, 0.96), 0.004, 1.0, 0.40, 0.6, 0.6, 65.0, 0.005),
    "WET": Look((0.80, 0.86, 0.92), 0.003, 0.5, 0.60, 0.1, 0.4, 80.0, 0.012, density=300.0),
    "OLD": Look((0.80, 0.82, 0.84), 0.005, 1.8, 0.25, 0.3, 1.0, 60.0, 0.004, density=350.0),
    "SAND": Look((0.56, 0.42, 0.25), 0.002, 0.5, 0.0, 0.02, 0.15, 34.0, 0.0, capacity=10.0, granular=True,
                 density=1600.0),
    "DUST": Look((0.33, 0.29, 0.24), 0.0015, 0.3, 0.0, 0.0, 0.1, 90.0, 0.0, capacity=0.004, flutter=90.0,
                 adhesion=0.3, rising=0.1, density=600.0),
    "ASH": Look((0.15, 0.15, 0.155), 0.002, 0.6, 0.0, 0.0, 0.25, 35.0, 0.0, capacity=10.0, flutter=20.0,
                granular=True, density=900.0),
}
# fmt: on


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
    look = LOOKS[kind]
    scene.snowbough.kind = kind
    # Maps of grains keep their crests sharp.
    if look.granular:
        scene.snowbough.blur_radius = 0.0
    elif scene.snowbough.granular:
        scene.snowbough.property_unset("blur_radius")
    for name, value in look.settings().items():
        setattr(scene.snowbough, name, value)
    for obj in scene.objects:
        for slot in obj.material_slots:
            if slot.material is not None and slot.material.library is None:
                for node in group_nodes(slot.material):
                    set_group_inputs(node, look)
