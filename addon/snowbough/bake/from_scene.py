# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the request of a bake from the scene's settings, as plain data, in Blender's main thread."""

import time
from dataclasses import fields

import bpy

from ..base import compat, native
from ..base.map_kinds import ON_REQUEST
from ..base.names import unit_of
from ..result import displacement
from ..scene import masks, physics_caches
from ..scene.pose import metres_per_unit
from ..scene.receivers import note_baked_names, receiver_specs
from ..settings.preferences import preferred_engine
from ..settings.scene import SnowboughSceneSettings
from ..settings.simulation import snow_of
from .cache_place import bake_place, known_as
from .engine import RunningBake
from .job import BakeJob
from .request import BakeRequest

# Fields of a request that are settings of the scene.
_OWN_SETTINGS = sorted(
    {field.name for field in fields(BakeRequest)}
    & SnowboughSceneSettings.__annotations__.keys() - {"receivers"}
)


def constant_values(scene, name, frame_start, frame_end):
    """The value of a setting on every frame as a tuple, or None if it is only known by evaluating the scene (drivers,
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
                return tuple(curve.evaluate(frame * compat.frame_length(scene)) for frame in frames)
    return (getattr(settings, name),) * len(frames)


def constant_rates(scene, frame_start, frame_end):
    """The rate of every frame as a tuple, at least 0, or None if it is only known by evaluating the scene."""
    rates = constant_values(scene, "rate", frame_start, frame_end)
    return None if rates is None else tuple(max(0.0, rate) for rate in rates)


def make_request(scene, resume=False, first=None, last=None, objects=(), directory=None,
                 allow_other_driver=False, engine=None, strict=False, extend=False):  # fmt: skip
    """All data that a bake of the scene needs, without references into it. Raises ValueError.

    directory: the cache that the command line names; None for that of the settings. engine: AUTO, GL or CPU; None for
    that of the preferences. strict: a receiver that cannot be baked is an error. extend: add frames to a finished
    bake."""
    if bpy.app.autoexec_fail:
        raise ValueError(
            f"Blender has disabled scripts in this file ({bpy.app.autoexec_fail_message or 'drivers'}), so its "
            "animation would be wrong: start Blender with -y, or allow Auto Run Python Scripts and reload"
        )
    settings, render = scene.snowbough, scene.render
    frame_start, frame_end = settings.frame_start, settings.frame_end
    first = frame_start if first is None else first
    cache, cache_id = bake_place(scene, resume or extend or first > frame_start, directory)
    return BakeRequest(
        scene_name=scene.name,
        baked_as=known_as(scene),
        cache=cache,
        cache_id=cache_id,
        blend=bpy.data.filepath if cache_id and directory is None else "",
        first=first,
        last=frame_end if last is None else last,
        fps=render.fps / render.fps_base,
        time_stretching=compat.frame_length(scene),
        rates=constant_rates(scene, frame_start, frame_end),
        snow=snow_of(settings),
        maps={kind.name: getattr(settings, kind.setting) for kind in ON_REQUEST},
        units={prop.identifier: unit_of(prop.description) for prop in settings.bl_rna.properties},
        receivers=tuple(receiver_specs(scene, as_baked=True)),
        objects=tuple(objects),
        resume=resume,
        extend=extend,
        strict=strict,
        allow_other_driver=allow_other_driver,
        engine=preferred_engine() if engine is None else engine,
        **{name: getattr(settings, name) for name in _OWN_SETTINGS},
    )


def prepare_bake(scene, request, on_frame=None):
    """A RunningBake for engine.run or start. Raises the errors of make_request and native.load, and ValueError for a
    physics simulation that is not baked and would not move, and for Time Stretching that materials do not follow."""
    begun = time.monotonic()
    physics_caches.require_cached(scene)
    displacement.require_frames(scene)
    note_baked_names(scene, request.receivers)
    scene.snowbough.cache_scene = request.baked_as
    masks.load_sequences(request.receivers, request.frame_start, request.frame_end)
    job = BakeJob(request, native.load())
    return RunningBake(job, request.receivers, metres_per_unit(scene), on_frame, begun)
