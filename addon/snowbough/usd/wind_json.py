# SPDX-License-Identifier: GPL-3.0-or-later
"""The tree's joints in wind groups, as the plugin Dynamic Wind of Unreal Engine (5.7 on) imports them from a JSON file.
No ``bpy``.

The keys are the fields of the structs FDynamicWindSkeletalImportData, FDynamicWindJointImportData and
FDynamicWindSimulationGroupData (Epic Games, Unreal Engine API reference, plugin DynamicWind).
"""

import numpy as np

from ..tree import wind


def wind_data(joints, names):
    """The content of the file as plain data. joints: [Joint]; names: their names in the skeleton.

    Each level of limbs is a group, the trunk is group 0. The influence of a group is the angle by which wind bends its
    median limb (tree.wind), as a share of that of the group that bends most.
    """
    parents, connected, lengths, radii = (
        np.array([getattr(joint, name) for joint in joints])
        for name in ("parent", "connected", "length", "radius")
    )
    chains = wind.find_chains(parents, connected, lengths, radii)
    angles = wind.tip_angles(chains.limb_length, chains.limb_radius, wind.WIND_SPEED)
    bends = [np.median(angles[chains.limb_level == n]) for n in range(int(chains.limb_level.max()) + 1)]
    groups = []
    for level, bend in enumerate(bends):
        influence = round(float(bend / max(bends)), 4)
        groups.append(
            {
                "bUseDualInfluence": False,
                "Influence": influence,
                "MinInfluence": 0.0,
                "MaxInfluence": influence,
                "ShiftTop": 0.0,
                "bIsTrunkGroup": level == 0,
            }
        )
    group = chains.limb_level[chains.limb].tolist()
    return {
        "Joints": [{"JointName": name, "SimulationGroupIndex": number} for name, number in zip(names, group)],
        "SimulationGroups": groups,
        "bIsGroundCover": False,
        "GustAttenuation": 0.0,
    }
