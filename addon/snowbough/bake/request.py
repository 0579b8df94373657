# SPDX-License-Identifier: GPL-3.0-or-later
"""What goes into a bake and what comes out of it, as plain data. No ``bpy``."""

from dataclasses import dataclass, field, fields


class BakeCancelled(Exception):
    """The artist stopped the bake; everything up to the last whole frame is there and resumable."""


class NoGpu(RuntimeError):
    """The engine GL is asked for and OpenGL is not to be had; says what the native module said."""


def _for_all_maps():
    """A field that decides about the maps of the whole shot, besides the depth of each frame."""
    return field(metadata={"for_all_maps": True})


@dataclass(frozen=True)
class BakeRequest:
    """All that a bake needs to know besides poses.

    A field with the name of a scene setting (snowbough.settings) holds that setting.
    """

    scene_name: str
    cache: str
    """Absolute folder; the scene's folder is made inside."""
    frame_start: int = _for_all_maps()
    frame_end: int = _for_all_maps()
    """The shot."""
    first: int
    last: int
    """The part of the shot to bake."""
    fps: float = _for_all_maps()
    start_depth: float = _for_all_maps()
    end_depth: float = _for_all_maps()
    rates: tuple
    """One a frame of the shot; None: to be read from the poses, because a driver gives them."""
    snow: dict
    """What the simulation takes: settings.simulation.snow_of. Metres, seconds, radians."""
    texel_size: float
    pixel_size: float
    """Metres; 0 is automatic."""
    blur_radius: float = _for_all_maps()
    """Texels."""
    substeps: int = _for_all_maps()
    directions: int = _for_all_maps()
    """Of flutter, over the shot, at least."""
    checkpoint_interval: int = _for_all_maps()
    write_normals: bool = _for_all_maps()
    receivers: tuple
    """scene.pose.ReceiverSpec of the scene's list, disabled ones included."""
    cache_id: str = ""
    """Which of the scenes of that name (cache.versions.scene_folder)."""
    blend: str = ""
    """The .blend that takes the scene's folder for its own; empty: none does."""
    objects: tuple = ()
    """Names of the receivers to bake; empty: all that are enabled."""
    resume: bool = False
    strict: bool = False
    """A receiver that cannot be baked stops the others."""
    allow_other_driver: bool = False
    engine: str = "AUTO"
    """AUTO, GL or CPU, as the native SnowSimulation takes it. No part of the shot: what ran is noted in checkpoints."""

    def shot(self):
        """{name: value} of all that decides about the maps of the whole shot, besides the depth of each frame
        and the size of an occlusion pixel, which may be automatic."""
        own = {one.name: getattr(self, one.name) for one in fields(self) if "for_all_maps" in one.metadata}
        return {**own, **self.snow}


@dataclass
class FrameResult:
    """What the job reports after each frame."""

    frame: int
    first: int
    last: int
    depth: float
    """Metres on open ground."""
    volume: float
    """m3 that lie on the receivers that are baked."""
    slid: float
    """m3 that slid off them since the first frame."""
    seconds: dict = field(default_factory=dict)
    """evaluate: Blender's evaluation of the poses; snow and maps: steps, and reading back what they leave for
    the maps; gpu: both, whichever engine does them, and the simulation's state where a checkpoint is due;
    files: what the thread that makes, packs and writes maps was busy with since the frame before; total: from
    the frame before to this one. evaluate, gpu and files run beside each other, so total is less than their sum."""
