# SPDX-License-Identifier: GPL-3.0-or-later
"""A small bake of the snow on a tree, on one pose: all snow of the shot, on maps of at most RESOLUTION texels a side.

Always on the processor, so that a bend does not depend on the graphics card. No ``bpy``.
"""

import math
from dataclasses import replace

import numpy as np

from ..bake import baked_receiver, plan, simulation
from ..scene.pose import TopologyAlpha
from ..scene.tracker import Registration

RESOLUTION = 512
STEPS = 16
# Occlusion pixels over the tree; more would take minutes and change loads by less than a percent.
MAX_PIXELS = 1 << 20
# The flattest snow for which shelter is looked for, in radians from the vertical.
FLATTEST = math.radians(80.0)


def box_of(positions):
    """(low, high) corners of all arrays (V, 3)."""
    return np.min([own.min(axis=0) for own in positions], axis=0), np.max(
        [own.max(axis=0) for own in positions], axis=0
    )


def shelters(triangles, positions, low, high, fall_angle):
    """(T,) bool: triangles that may keep snow off a box from low to high, if the snow falls within `fall_angle` of the
    vertical, whichever way the wind blows."""
    corners = positions[triangles]
    least, most = corners.min(axis=1), corners.max(axis=1)
    rise = most[:, 2] - low[2]
    reach = np.maximum(rise, 0.0)[:, None] * math.tan(min(fall_angle, FLATTEST))
    beside = (least[:, :2] - reach <= high[:2]) & (most[:, :2] + reach >= low[:2])
    return (rise > 0.0) & beside.all(axis=1)


def _cut(topology, keep):
    """The topology with some of its triangles, as an occluder."""
    alpha = topology.alpha
    if alpha is not None:
        alpha = TopologyAlpha(alpha.uv[keep], alpha.image[keep], alpha.images)
    return replace(
        topology,
        triangles=topology.triangles[keep],
        corner_uv=topology.corner_uv[:0],
        alpha=alpha,
        shading=None,
    )


def bake_heights(native, pose, keys, snow, texel_size, depth, seconds):
    """{key: heights (H, H) in metres, negative on the back} of the receivers `keys` of a scene.pose.ScenePose.

    snow: settings.simulation.snow_of; texel_size: of automatic resolutions, metres; depth: metres on open, level
    ground; seconds: of the shot.
    """
    resolutions, texels, added = {}, [], {}
    low, high = box_of([pose.objects[key].positions for key in keys])
    slant = pose.fall_angle + snow["flutter"]
    for key, obj in pose.objects.items():
        topology = obj.topology
        if key in keys:
            measured = baked_receiver.measure(obj, texel_size)
            resolutions[key] = min(measured.resolution, RESOLUTION)
            texels.append(measured.texel * measured.resolution / resolutions[key])
        else:
            keep = shelters(topology.triangles, obj.positions, low, high, slant)
            if not keep.any():
                continue
            topology = _cut(topology, keep)
        added[key] = Registration(obj.label, "", topology, obj.positions)
    pixel = max(min(texels), float(np.linalg.norm(high - low)) / math.sqrt(MAX_PIXELS))
    maps = {
        key: (resolution, 0.0, pose.objects[key].receiver.sides, 0.0)
        for key, resolution in resolutions.items()
    }
    # What falls off the tree does not matter here.
    settings = {**snow, "landing": False, "mapping": "COMPUTE"}
    direction = plan.fall_direction(pose.fall_angle, pose.bearing)
    with simulation.make_simulation(native, settings, pixel, "CPU") as running:
        simulation.Registry(running, maps).register_changes(added)
        positions = {key: registration.positions for key, registration in added.items()}
        for depth_of_step, dt in [(depth / STEPS, seconds / STEPS)] * STEPS + [(0.0, plan.REST_SECONDS)]:
            running.step(positions, depth=depth_of_step, direction=direction, dt=dt)
            positions = {}
        return {key: running.height(key) for key in keys}
