# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimates the memory of a bake before anything of it is allocated. No ``bpy``.

simulation() has the numbers of the native memory_estimate (native/snow/scene/memory_estimate.cpp), which counts
existing texel tables; a test compares both. estimate() adds the rest of a bake; tests/faults/test_memory.py measures
it.
"""

import math
from dataclasses import dataclass

from ..base.names import sized
from .map_writer import MAX_WAITING_BYTES, max_waiting

# Bytes per texel of a receiver: its map and texel; data of repose; work data of the output of the largest map.
MAP, REPOSE, OUTPUT = 50, 124, 89
# Bytes per texel along the rims of charts, about this many map widths per layout; bytes per triangle.
RIM, RIM_WIDTHS, TRIANGLE = 1536, 6, 235
# Bytes per texel of all receivers: tables of the output, copies of tables, coverage, the state at a checkpoint.
BAKE = 30
# Bytes of the tile of the occlusion render.
TILE = 80 * 2**20


@dataclass(frozen=True)
class MapSize:
    """The size of a receiver."""

    resolution: int
    triangles: int


def output_bytes(resolution, with_normals):
    """Bytes of the output of a map, before it is written."""
    return resolution**2 * (16 if with_normals else 4)


def estimate(maps, repose, with_normals):
    """Bytes that a bake of these MapSizes needs. repose: radians, as in SnowSimulation."""
    if not maps:
        return 0
    waiting = [output_bytes(size.resolution, with_normals) for size in maps]
    kept = BAKE * sum(size.resolution**2 for size in maps)
    return (
        simulation(maps, repose)
        + kept
        + max(min(max_waiting(len(maps)) * max(waiting), MAX_WAITING_BYTES), max(waiting))
    )


def has_repose(repose):
    """Whether lying snow moves at all, on which landing depends. repose: radians, as in SnowSimulation."""
    return repose < math.pi / 2 - 1e-4


def simulation(maps, repose):
    """Bytes that the simulation of these MapSizes needs."""
    if not maps:
        return 0
    texel = MAP + (REPOSE if has_repose(repose) else 0)
    own = sum(
        size.resolution**2 * texel + size.resolution * RIM * RIM_WIDTHS + size.triangles * TRIANGLE
        for size in maps
    )
    return own + OUTPUT * max(size.resolution for size in maps) ** 2 + TILE


def available():
    """Bytes of free memory; 0 if unknown."""
    try:
        with open("/proc/meminfo", encoding="ascii") as stream:
            kibibytes = next(line.split()[1] for line in stream if line.startswith("MemAvailable:"))
    except (OSError, StopIteration):
        return 0
    return int(kibibytes) * 1024


def shortage(maps, repose, with_normals):
    """What to do if a bake of these MapSizes does not fit; empty if it fits or the free memory is unknown."""
    needed, free = estimate(maps, repose, with_normals), available()
    if not free or needed <= free:
        return ""
    return (
        f"The bake needs about {sized(needed)} of memory, but only {sized(free)} are free: lower the resolution of the "
        "largest receivers (half the resolution needs a quarter of the memory), or bake the receivers in several runs"
    )
