# SPDX-License-Identifier: GPL-3.0-or-later
"""Input and output of a bake, as plain data. No ``bpy``."""

from dataclasses import dataclass, field, fields

from ..base.map_kinds import ON_REQUEST


class BakeCancelled(Exception):
    """The user stopped the bake; it can be resumed after the last complete frame."""


class NoGpu(RuntimeError):
    """Engine GL is asked for, but OpenGL is unavailable; the message has the native module's reason."""


def _for_all_maps():
    """A field that affects all maps of the shot, besides the depth of each frame."""
    return field(metadata={"for_all_maps": True})


@dataclass(frozen=True)
class BakeRequest:
    """All that a bake needs, besides poses.

    A field with the name of a scene setting (snowbough.settings) holds that setting.
    """

    scene_name: str
    cache: str
    """Absolute folder, in which the scene's folder is made."""
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
    """One per frame of the shot; None if a driver sets the rate, which is then read from the poses."""
    snow: dict
    """Arguments of the simulation, from settings.simulation.snow_of. Metres, seconds, radians."""
    texel_size: float
    pixel_size: float
    """Metres; 0 is automatic."""
    blur_radius: float = _for_all_maps()
    """Texels."""
    substeps: int = _for_all_maps()
    directions: int = _for_all_maps()
    """Least number of flutter directions over the shot."""
    checkpoint_interval: int = _for_all_maps()
    maps: dict
    """{name: bool} of the maps on request (map_kinds)."""
    receivers: tuple
    """scene.pose.ReceiverSpec of the scene's list, disabled ones included."""
    time_stretching: float = 1.0
    """Frames of animation per rendered frame."""
    baked_as: str = ""
    """The scene's name at its first bake, which its folder keeps; empty for its current name."""
    cache_id: str = ""
    """Identity of the cache (cache.versions.scene_folder)."""
    blend: str = ""
    """The .blend that becomes the owner of the scene's folder; empty for none."""
    objects: tuple = ()
    """Names of the receivers to bake; empty for all enabled ones."""
    resume: bool = False
    extend: bool = False
    """Adds frames to a finished bake, whose frames keep their bytes (bake.continuing)."""
    parts: tuple = ()
    """(last frame, depth after it) of each part of the shot that was baked before frames were added. The job reads them
    from the cache."""
    strict: bool = False
    """A receiver that cannot be baked is an error."""
    allow_other_driver: bool = False
    units: dict = field(default_factory=dict)
    """{name: unit} of the settings, for messages."""
    engine: str = "AUTO"
    """AUTO, GL or CPU, as in SnowSimulation. Not part of the shot: checkpoints store the engine that ran."""

    @property
    def known_as(self):
        return self.baked_as or self.scene_name

    @property
    def may_resume(self):
        """Whether the bake may continue a stopped one."""
        return self.resume or self.first > self.frame_start

    def is_checkpoint(self, frame):
        """Whether the bake of the shot writes a checkpoint after this frame, stopped or not."""
        return (frame - self.frame_start + 1) % self.checkpoint_interval == 0 and frame < self.frame_end

    def shot(self):
        """{name: value} of all that affects all maps of the shot, except the depth of each frame and the size of an
        occlusion pixel, which may be automatic."""
        own = {one.name: getattr(self, one.name) for one in fields(self) if "for_all_maps" in one.metadata}
        if self.time_stretching != 1.0:  # bakes of earlier versions lack it
            own["time_stretching"] = self.time_stretching
        if self.parts:
            own["parts"] = [list(part) for part in self.parts]
        return {**own, **{kind.setting: self.maps[kind.name] for kind in ON_REQUEST}, **self.snow}


@dataclass
class FrameResult:
    """The job's report after each frame."""

    frame: int
    first: int
    last: int
    depth: float
    """Metres on open ground."""
    volume: float
    """m3 of snow on the baked receivers."""
    slid: float
    """m3 that slid off them since the first frame."""
    seconds: dict = field(default_factory=dict)
    """evaluate: Blender's evaluation of the poses; snow and maps: the steps, and reading back the data for the maps;
    gpu: both, in either engine, and the simulation's state at checkpoints; files: work of the thread that makes, packs
    and writes maps since the frame before; total: time since the frame before. evaluate, gpu and files run in parallel,
    so total is less than their sum."""
