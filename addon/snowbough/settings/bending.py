# SPDX-License-Identifier: GPL-3.0-or-later
"""``armature.snowbough.bending``: how a tree bends under snow."""

import bpy
from bpy.props import EnumProperty, FloatProperty

# Identifier -> (name, Young's modulus in GPa, modulus of rupture in MPa) of living limbs with their bark. Our round
# numbers within what was measured: 0.7 to 4.6 GPa on branches and 2.4 to 7.5 GPa on trunks of spruce, pine, larch and
# birch (M. G. R. Cannell, J. Morgan, Young's modulus of sections of living branches and tree trunks, Tree Physiology 3,
# 1987, pages 355-364).
WOODS = {
    "SPRUCE": ("Spruce, Fir", 4.0, 40.0),
    "PINE": ("Pine", 3.0, 40.0),
    "LARCH": ("Larch", 4.5, 50.0),
    "BIRCH": ("Birch", 4.0, 45.0),
    "MAPLE": ("Maple", 5.0, 50.0),
    "OAK": ("Oak, Beech", 6.0, 55.0),
    "WILLOW": ("Willow, Poplar", 2.5, 35.0),
}
OWN_WOOD = "CUSTOM"


class SnowboughBending(bpy.types.PropertyGroup):
    """Used by Bend under Snow; a tree without it stays as it is."""

    weight: FloatProperty(
        name="Weight",
        description="Snow on the whole tree before it bends. Higher values bend it more. 0 is automatic: what a crown "
        "with leaves or needles catches, or the snow that lies on a bare tree (kilograms)",
        default=0.0,
        min=0.0,
        soft_max=1000.0,
    )
    snow_density: FloatProperty(
        name="Density",
        description="Density of the snow, for the automatic weight: about 100 for powder, 250 for wet snow (kilograms "
        "per cubic metre)",
        default=200.0,
        min=10.0,
        max=900.0,
    )
    species: EnumProperty(
        name="Wood",
        description="Wood of the tree: how stiff and how strong it is",
        items=(
            *(
                (name, label, f"Stiffness {stiffness:g} GPa, strength {strength:g} MPa")
                for name, (label, stiffness, strength) in WOODS.items()
            ),
            (OWN_WOOD, "Custom", "Own values of stiffness and strength"),
        ),
        default="SPRUCE",
    )
    wood_stiffness: FloatProperty(
        name="Stiffness",
        description="Young's modulus of the wood. Higher values bend less (gigapascals)",
        default=4.0,
        min=0.01,
        max=1000.0,
        soft_max=10.0,
    )
    wood_strength: FloatProperty(
        name="Strength",
        description="Stress at which the wood breaks. Limbs that would break are reported and bend no further "
        "(megapascals)",
        default=50.0,
        min=0.1,
        max=10000.0,
        soft_max=100.0,
    )

    def wood(self):
        """(Young's modulus, modulus of rupture) in Pa."""
        if self.species == OWN_WOOD:
            stiffness, strength = self.wood_stiffness, self.wood_strength
        else:
            _name, stiffness, strength = WOODS[self.species]
        return stiffness * 1e9, strength * 1e6


register, unregister = bpy.utils.register_classes_factory((SnowboughBending,))
