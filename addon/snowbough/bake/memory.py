# SPDX-License-Identifier: GPL-3.0-or-later
"""How much memory a bake takes, before anything of it is made. No ``bpy``.

The figures are those of the native memory_estimate (native/snow/scene/memory_estimate.cpp), which counts texel tables
that are there; a test holds both together.
"""

import math
from dataclasses import dataclass

# Bytes a texel of a receiver: its map and texel; what repose keeps; what the output of the largest map works with.
MAP, REPOSE, OUTPUT = 50, 92, 89
# Bytes a texel along the rims of charts, of which a layout has about so many map widths; bytes a triangle.
RIM, RIM_WIDTHS, TRIANGLE = 1536, 6, 235
# The tile of the occlusion render.
TILE = 80 * 2**20


@dataclass(frozen=True)
class MapSize:
    """What counts of a receiver."""

    resolution: int
    triangles: int


def estimate(maps, repose):
    """Bytes that the simulation of these MapSizes takes. repose: radians, as SnowSimulation takes it."""
    if not maps:
        return 0
    texel = MAP + (REPOSE if repose < math.pi / 2 - 1e-4 else 0)
    own = sum(
        size.resolution**2 * texel + size.resolution * RIM * RIM_WIDTHS + size.triangles * TRIANGLE
        for size in maps
    )
    return own + OUTPUT * max(size.resolution for size in maps) ** 2 + TILE


def available():
    """Bytes of the computer's memory that are free; 0 where that is not known."""
    try:
        with open("/proc/meminfo", encoding="ascii") as stream:
            kibibytes = next(line.split()[1] for line in stream if line.startswith("MemAvailable:"))
    except (OSError, StopIteration):
        return 0
    return int(kibibytes) * 1024


def text(count):
    """``3.2 GiB`` or ``40 MiB``."""
    return f"{count / 2**30:.1f} GiB" if count >= 2**30 else f"{max(1, round(count / 2**20))} MiB"


def shortage(maps, repose):
    """What to do where a bake of these MapSizes does not fit; empty where it does, or that is not known."""
    needed, free = estimate(maps, repose), available()
    if not free or needed <= free:
        return ""
    return (
        f"The snow takes about {text(needed)} of memory and {text(free)} are free: lower the resolution of the largest "
        "receivers (half of it takes a quarter), or bake the receivers in several runs"
    )
