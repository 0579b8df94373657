# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes a simulation from a scene's poses: its engine, its grid, and its objects as they appear and change. No ``bpy``.

Used by the bake and the live preview.
"""

import numpy as np

from ..base.names import MIN_RESOLUTION
from ..cache.errors import InputsChanged
from ..scene.pose import TopologyChanged
from . import plan
from .request import NoGpu


def pixel_size(pose, texel_sizes, wanted=0.0):
    """Edge of an occlusion pixel in metres: `wanted`, or if that is 0, a size that suits the receivers' texel sizes and
    the extent of a scene.pose.ScenePose."""
    if wanted:
        return wanted
    filled = [obj.positions for obj in pose.known.values() if len(obj.positions)]
    low = np.min([positions.min(axis=0) for positions in filled], axis=0).tolist()
    high = np.max([positions.max(axis=0) for positions in filled], axis=0).tolist()
    return plan.automatic_pixel_size(texel_sizes, low, high)


def changeable(snow):
    """The settings from settings.simulation.snow_of that a running SnowSimulation's change_settings takes."""
    return {name: value for name, value in snow.items() if name != "mapping"}


def make_simulation(native, snow, pixel_size, engine="AUTO", wait_for_gpu=True):
    """A SnowSimulation of the module snowbough_native. snow: settings.simulation.snow_of. engine: AUTO, GL or CPU."""
    return native.SnowSimulation(pixel_size=pixel_size, engine=engine, wait_for_gpu=wait_for_gpu, **snow)


class Registry:
    """The objects of a native SnowSimulation.

    maps: {key: (resolution, sigma of the blur in metres, sides, half-life of shedding)} of the receivers that have a
    map; all other objects only block snow.
    """

    def __init__(self, simulation, maps):
        self._simulation = simulation
        self._maps = maps
        self._known = set()
        self._unprepared = []
        self._sheds = False

    def register_changes(self, added):
        """Adds the objects of {key: scene.tracker.Registration}, or gives existing ones their new mesh. A receiver's
        snow keeps its place on the map. Needs no engine yet.

        Raises TopologyChanged, naming object and frame, for a new mesh that the map cannot carry.
        """
        for key, registration in added.items():
            topology = registration.topology
            resolution, blur_radius, sides, _ = self._maps.get(key, (MIN_RESOLUTION, None, "POSITIVE", 0.0))
            receives = key in self._maps
            arguments = (
                key,
                topology.triangles,
                topology.corner_uv if receives else np.zeros((len(topology.triangles), 3, 2), np.float32),
            )
            options = {
                "resolution": resolution,
                "receive": receives,
                "occlude": registration.occludes or receives,
                "rest": registration.positions if receives else None,
                "blur_radius": blur_radius,
                "alpha": topology.alpha.argument() if topology.alpha else None,
                "shading": topology.shading if receives else None,
                "sides": sides,
            }
            if key not in self._known:
                self._simulation.add_object(*arguments, **options)
                self._known.add(key)
                if self._sheds:
                    self._shed(key)
                if receives:
                    self._unprepared.append(key)
                continue
            try:
                self._simulation.replace_object(*arguments, **options)
            except ValueError as error:
                raise TopologyChanged(
                    f"The faces of '{registration.label}' change at frame {registration.pose}, and its snow cannot "
                    f"follow ({error}): apply the modifier that changes them, or remove it from the "
                    "list of receivers"
                ) from error

    def set_effects(self, masks, pressers):
        """Sets masks {key: scene.pose.Mask or None} and what objects do to snow {key: scene.pose.ObjectPose.press} from
        the next step on."""
        for key, press in pressers.items():
            self._simulation.set_presser(key, **(press or {"kind": "NONE"}))
        for key, mask in masks.items():
            if key in self._maps:
                self._simulation.set_mask(key, *(() if mask is None else (mask.values, mask.uv)))

    def shed(self, sheds):
        """Lets receivers shed their snow from the next step on, or no longer: what lies there before the first frame
        stays."""
        if sheds == self._sheds:
            return
        self._sheds = sheds
        for key in self._known:
            self._shed(key)

    def _shed(self, key):
        half_life = self._maps[key][3] if key in self._maps else 0.0
        if half_life > 0.0:
            self._simulation.set_shed_half_life(key, half_life if self._sheds else 0.0)

    def prepare(self):
        """Starts the preparation of the maps of new receivers, in parallel to the next steps. Waits for the engine."""
        for key in self._unprepared:
            self._simulation.prepare_output(key)
        self._unprepared.clear()


def driver_text(engine):
    """Everything that affects the last bit of a map: ``CPU, processor, x86-64``. engine: the dict in native.Engine's
    info or SnowSimulation's engine."""
    return f"{engine['name']}, {engine['driver']}"


def engine_info(engine, mapping):
    """The info of a native.Engine for that mapping. Raises NoGpu, saying what to do, if it needs OpenGL and there is
    none."""
    try:
        return engine.info
    except RuntimeError as error:
        instead = "engine CPU, which needs none" if mapping == "COMPUTE" else "mapping COMPUTE"
        raise NoGpu(
            f"Engine GL needs OpenGL, which is unavailable here: {error}. Or choose {instead}"
        ) from error


def probe_engine(native, wanted, mapping):
    """engine_info of the engine that a bake would use. Raises NoGpu, and ValueError for a mapping that the engine does
    not support."""
    with native.Engine(engine=wanted, mapping=mapping) as engine:
        return engine_info(engine, mapping)


def other_engine(before, now):
    """The error for a checkpoint of another engine or driver. before, now: as from driver_text."""
    return InputsChanged(
        f"The checkpoint was made with another engine or driver ({before}; this is {now}), so the maps would differ by "
        "rounding: resume on that machine, choose that engine, or allow another driver"
    )
