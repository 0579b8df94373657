# SPDX-License-Identifier: GPL-3.0-or-later
"""From the scene's settings to a bake: where its cache is, and what it is asked to do.

make_request turns the settings into plain data, in Blender's main thread, before anything starts.
"""

from dataclasses import fields
from pathlib import Path

import bpy

from .. import compat, native
from ..cache import versions
from ..scene import physics_caches
from ..scene.pose import metres_per_unit
from ..scene.receivers import receiver_specs
from ..settings.preferences import preferred_engine
from ..settings.scene import SnowboughSceneSettings
from ..settings.simulation import snow_of
from .engine import RunningBake
from .job import BakeJob
from .request import BakeRequest

# Fields of a request that are settings of the scene as they are.
_OWN_SETTINGS = sorted(
    {field.name for field in fields(BakeRequest)}
    & SnowboughSceneSettings.__annotations__.keys() - {"receivers"}
)


def cache_directory(scene):
    """Absolute folder of the scene's cache. Raises ValueError where the .blend was never saved."""
    path = scene.snowbough.cache_directory
    if not path.strip():
        raise ValueError("The cache folder is empty: choose one in the Snowbough panel")
    if path.startswith("//") and not bpy.data.filepath:
        raise ValueError(
            "Save the .blend first: its cache lies beside it. Or choose an absolute cache folder in the panel"
        )
    return str(Path(bpy.path.abspath(path)).resolve())


def existing_cache(scene):
    """The scene's folder in the cache that holds its bakes: the one the settings say, else, after Save As
    elsewhere, the one that the last bake wrote to. Returns a Path that need not exist."""
    try:
        root = versions.scene_folder(cache_directory(scene), scene.name)
    except ValueError:
        root = None
    if root is None or not versions.versions(root):
        used = scene.snowbough.cache_used
        if used and versions.versions(versions.scene_folder(used, scene.name)):
            return versions.scene_folder(used, scene.name)
    return root


def constant_values(scene, name, frame_start, frame_end):
    """The value of a setting on every frame as a tuple, or None where only evaluating the scene can tell (drivers,
    NLA)."""
    settings, animation = scene.snowbough, scene.animation_data
    frames = range(frame_start, frame_end + 1)
    if animation is not None:
        if any(driver.data_path == f"snowbough.{name}" for driver in animation.drivers):
            return None
        if animation.use_nla and len(animation.nla_tracks):
            return None
        for curve in compat.curves_of(scene):
            if curve.data_path == f"snowbough.{name}" and not curve.mute:
                return tuple(curve.evaluate(frame) for frame in frames)
    return (getattr(settings, name),) * len(frames)


def constant_rates(scene, frame_start, frame_end):
    """The rate of every frame as a tuple, none below 0, or None where only evaluating the scene can tell."""
    rates = constant_values(scene, "rate", frame_start, frame_end)
    return None if rates is None else tuple(max(0.0, rate) for rate in rates)


def make_request(scene, resume=False, first=None, last=None, objects=(), directory=None,
                 allow_other_driver=False, engine=None, strict=False):  # fmt: skip
    """Everything a bake of the scene needs to know, without references into it. Raises ValueError.

    engine: AUTO, GL or CPU; None takes what the preferences say. strict: a receiver that cannot be baked stops
    the others."""
    if bpy.app.autoexec_fail:
        raise ValueError(
            f"Blender has disabled scripts in this file ({bpy.app.autoexec_fail_message or 'drivers'}), so it "
            "would not move as it should: start Blender with -y, or allow Auto Run Python Scripts and reload"
        )
    settings, render = scene.snowbough, scene.render
    frame_start, frame_end = settings.frame_start, settings.frame_end
    return BakeRequest(
        scene_name=scene.name,
        cache=str(Path(directory).absolute()) if directory else cache_directory(scene),
        first=frame_start if first is None else first,
        last=frame_end if last is None else last,
        fps=render.fps / render.fps_base,
        rates=constant_rates(scene, frame_start, frame_end),
        snow=snow_of(settings),
        receivers=tuple(receiver_specs(scene)),
        objects=tuple(objects),
        resume=resume,
        strict=strict,
        allow_other_driver=allow_other_driver,
        engine=preferred_engine() if engine is None else engine,
        **{name: getattr(settings, name) for name in _OWN_SETTINGS},
    )


def prepare_bake(scene, request, on_frame=None):
    """A RunningBake for engine.run or start. Raises what make_request and native.load raise, and
    ValueError for a simulation that is not baked and would not move."""
    physics_caches.require_cached(scene)
    job = BakeJob(request, native.load())
    return RunningBake(job, request.receivers, metres_per_unit(scene), on_frame)
