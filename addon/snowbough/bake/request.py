# SPDX-License-Identifier: GPL-3.0-or-later
"""What goes into a bake and what comes out of it, as plain data. No ``bpy``."""

from dataclasses import dataclass, field

# What of a request decides about the maps of the whole shot, besides the depth of each frame.
SHOT_SETTINGS = (
    "frame_start", "frame_end", "fps", "start_depth", "end_depth", "flutter", "max_depth",
    "slide_half_life", "blur_radius", "substeps", "seed", "noise_density", "mapping",
    "write_normals", "checkpoint_interval",
)  # fmt: skip


class BakeCancelled(Exception):
    """The artist stopped the bake; everything up to the last whole frame is there and resumable."""


class NoGpu(RuntimeError):
    """There is no EGL or no driver; says what the native module said."""


class TopologyChanged(ValueError):
    """An object's vertices or triangles are others than before, and its snow cannot go on with them."""


@dataclass(frozen=True)
class BakeRequest:
    """All that a bake needs to know besides poses."""

    scene_name: str
    cache: str
    """Absolute folder; the scene's folder is made inside."""
    frame_start: int
    frame_end: int
    """The shot."""
    first: int
    last: int
    """The part of the shot to bake."""
    fps: float
    start_depth: float
    end_depth: float
    rates: tuple
    """One a frame of the shot; None: to be read from the poses, because a driver gives them."""
    flutter: float
    """Degrees."""
    max_depth: float
    slide_half_life: float
    texel_size: float
    pixel_size: float
    """Metres; 0 is automatic."""
    blur_radius: float
    """Texels."""
    substeps: int
    seed: int
    checkpoint_interval: int
    write_normals: bool
    noise_density: float
    mapping: str
    receivers: tuple
    """scene_reader.ReceiverSpec of the scene's list, disabled ones included."""
    objects: tuple = ()
    """Names of the receivers to bake; empty: all that are enabled."""
    resume: bool = False
    allow_other_driver: bool = False


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
    the maps; gpu: both, and the simulation's state where a checkpoint is due; files: what the thread that
    makes, packs and writes maps was busy with since the frame before; total: from the frame before to this
    one. evaluate, gpu and files run beside each other, so total is less than their sum."""
