# SPDX-License-Identifier: GPL-3.0-or-later
"""How a scene's poses become a simulation: its grid, and its objects as they come and change. No ``bpy``.

The bake and the live preview both go this way.
"""

import numpy as np

from ..names import MIN_RESOLUTION
from ..scene.pose import TopologyChanged
from . import plan


def pixel_size(pose, texel_sizes, wanted=0.0):
    """Edge of an occlusion pixel in metres: `wanted`, or where that is 0 what suits the receivers' texel
    sizes and the extent of a scene.pose.ScenePose."""
    if wanted:
        return wanted
    filled = [obj.positions for obj in pose.objects.values() if len(obj.positions)]
    low = np.min([positions.min(axis=0) for positions in filled], axis=0).tolist()
    high = np.max([positions.max(axis=0) for positions in filled], axis=0).tolist()
    return plan.automatic_pixel_size(texel_sizes, low, high)


def changeable(snow):
    """What of settings.simulation.snow_of a SnowSimulation takes while it runs, for its change_settings."""
    return {name: value for name, value in snow.items() if name != "mapping"}


def make_simulation(native, snow, pixel_size, engine="AUTO", wait_for_gpu=True):
    """A SnowSimulation of the module snowbough_native. snow: settings.simulation.snow_of. engine: AUTO, GL or
    CPU."""
    return native.SnowSimulation(pixel_size=pixel_size, engine=engine, wait_for_gpu=wait_for_gpu, **snow)


class Registry:
    """The objects that a native SnowSimulation has.

    maps: {key: (resolution, sigma of the blur in metres, sides)} of the receivers that it keeps a map of; all
    else only shelters them.
    """

    def __init__(self, simulation, maps):
        self._simulation = simulation
        self._maps = maps
        self._known = set()
        self._unprepared = []

    def register_changes(self, added):
        """Adds the objects of {key: scene.tracker.Registration}, or gives those that are there their new
        mesh. A receiver's snow stays where it lies on its map. Needs no engine yet.

        Raises TopologyChanged, naming object and frame, for a new mesh that its map cannot carry.
        """
        for key, registration in added.items():
            topology = registration.topology
            resolution, blur_radius, sides = self._maps.get(key, (MIN_RESOLUTION, None, "FRONT"))
            receives = key in self._maps
            arguments = (
                key,
                topology.triangles,
                topology.corner_uv if receives else np.zeros((len(topology.triangles), 3, 2), np.float32),
            )
            options = {
                "resolution": resolution,
                "receive": receives,
                "rest": registration.positions if receives else None,
                "blur_radius": blur_radius,
                "alpha": topology.alpha.argument() if topology.alpha else None,
                "shading": topology.shading if receives else None,
                "sides": sides,
            }
            if key not in self._known:
                self._simulation.add_object(*arguments, **options)
                self._known.add(key)
                if receives:
                    self._unprepared.append(key)
                continue
            try:
                self._simulation.replace_object(*arguments, **options)
            except ValueError as error:
                raise TopologyChanged(
                    f"'{registration.label}' has other faces at frame {registration.pose} than before, and its "
                    f"snow cannot go on there ({error}): apply the modifier that changes it, or take it off the "
                    "list of receivers"
                ) from error

    def prepare(self):
        """Begins with what the maps of new receivers take, beside the next steps. Waits for the engine."""
        for key in self._unprepared:
            self._simulation.prepare_output(key)
        self._unprepared.clear()
