# SPDX-License-Identifier: GPL-3.0-or-later
"""From an artist's numbers to snowfall: how much falls on which frame, from where, onto which grid.

Pure numbers, no ``bpy``. Depths are metres on open level ground, angles radians, frames integers.

**When snow falls.** Frame f lays ``(end_depth - start_depth) * rate(f) / sum of all rates``, and the map
of frame f shows the moment after that. ``start_depth`` lies there before the first frame's own snow: it is
laid on the first frame's pose, in PREROLL_STEPS steps or one for each direction. With substeps, frame f's snow
is laid on the poses at the ends of equal parts of the interval from f - 1 to f, the last of them frame f's own
pose; the first frame has no such interval within the shot and takes all its snow on its own pose. The depths are
differences of a running total that ends at ``end_depth`` itself, so rounding cannot gather.

**From how many directions.** Where flakes flutter, every step falls from another direction, and shadows are
soft and even only where there are enough of them. A shot gets at least ``directions``, spread over its frames by
how much falls on each: a still falls from all of them, a shot of 12 frames from 5 on each of the first 8 and 6 on
each of the last 4 (64 together), and one of 250 frames takes one step a frame, as without. Steps of one pose share
its depth alike; its time, in which snow slides and comes to rest, goes to every RUN-th of them and the last, since
that costs more than the fall. Each has its number in the simulation, which picks the direction: resumed and split
bakes count them alike.
"""

import functools
import math
from dataclasses import dataclass

from ..names import MAX_FALL_ANGLE

# The steps of the start depth where all flakes fall from one direction.
PREROLL_STEPS = 32
# Steps on one pose after which what slides may slide.
RUN = 6

MIN_AUTOMATIC_RESOLUTION = 256
MAX_AUTOMATIC_RESOLUTION = 4096

# An automatic pixel size never asks for more occlusion pixels than this for the whole scene: finer
# ground would cost minutes a frame without a GPU.
MAX_AUTOMATIC_PIXELS = 4096 * 4096

# To rest: 64 half-lives leave 5e-20 of an excess.
REST_HALF_LIVES = 64
# Long enough for repose to come to rest, and for walls to shed what stuck to them (seconds).
REST_SECONDS = 4.0


@dataclass(frozen=True)
class Step:
    """One call of the simulation."""

    frame: int
    """The pose is that of time ``frame + subframe``."""
    subframe: float
    depth: float
    """Metres on open level ground."""
    dt: float
    """Seconds."""


@dataclass(frozen=True)
class Snowfall:
    """The snowfall of a whole shot. It does not depend on which part of the shot is baked."""

    frame_start: int
    frame_end: int
    preroll: float
    """Metres that lie before the first frame's own snow."""
    depths: tuple
    """Metres that each frame lays, first to last."""
    totals: tuple
    """Metres that lie on each frame's map, pre-roll included."""


def plan_snowfall(frame_start, frame_end, start_depth, end_depth, rates):
    """Spreads ``end_depth - start_depth`` over the frames as ``rates`` say.

    rates: one number >= 0 for every frame from frame_start to frame_end.
    Raises ValueError for an empty range, an end depth below the start depth, wrong or no rates.
    """
    count = frame_end - frame_start + 1
    if count < 1:
        raise ValueError(f"The last frame ({frame_end}) is before the first ({frame_start})")
    if frame_start < 0:
        raise ValueError(f"The first frame is {frame_start}: image sequences start at frame 0 or later")
    if not (0 <= start_depth <= end_depth):
        raise ValueError(
            f"Snow does not melt here: the end depth ({end_depth:g} m) must not be below the start depth "
            f"({start_depth:g} m), nor either below 0"
        )
    if len(rates) != count:
        raise ValueError(f"{count} frames need {count} rates, got {len(rates)}")
    for frame, rate in zip(range(frame_start, frame_end + 1), rates):
        if not (rate >= 0 and math.isfinite(rate)):
            raise ValueError(f"The rate at frame {frame} is {rate}; it must be a number from 0 up")
    falling = math.fsum(rates)
    if falling == 0 and end_depth > start_depth:
        raise ValueError(
            "The rate is 0 on every frame, so the end depth cannot be reached: "
            "raise the rate somewhere, or set the end depth to the start depth"
        )
    totals = []
    for index in range(1, count + 1):
        share = math.fsum(rates[:index]) / falling if falling else 0.0
        totals.append(start_depth + (end_depth - start_depth) * share)
    totals[-1] = end_depth
    depths = [max(0.0, after - before) for before, after in zip([start_depth] + totals, totals)]
    return Snowfall(frame_start, frame_end, start_depth, tuple(depths), tuple(totals))


def frame_directions(snowfall, frame, directions):
    """The number of directions from which the snow of ``frame`` falls, where the shot has at least ``directions``:
    its share of the depth in whole numbers, 1 at least."""
    return _shared_directions(snowfall, directions)[frame - snowfall.frame_start]


@functools.lru_cache(maxsize=8)
def _shared_directions(snowfall, directions):
    """frame_directions of all frames. What rounding down leaves goes to the last frames, one to each: a round of
    directions is even where those that weigh alike lie in a row, and not where heavy and light ones take turns."""
    falling = snowfall.totals[-1] - snowfall.preroll
    if falling <= 0:
        return (1,) * len(snowfall.depths)
    shares = [directions * depth / falling for depth in snowfall.depths]
    counts = [max(1, math.floor(share + 1e-6)) for share in shares]
    left = directions - sum(counts)
    for index in reversed(range(len(counts))):
        if left > 0 and counts[index] < math.ceil(shares[index] - 1e-6):
            counts[index] += 1
            left -= 1
    return tuple(counts)


def preroll_steps(snowfall, fps, slide_half_life, directions=1):
    """The steps before the first frame's own snow: PREROLL_STEPS or one for each of ``directions``, then one without
    snow until nothing slides any more. Empty when nothing lies there."""
    if snowfall.preroll <= 0:
        return []
    frame = snowfall.frame_start
    count = max(PREROLL_STEPS, directions)
    steps = _steps_on_pose((frame, 0.0), snowfall.preroll, count / fps, count)
    return steps + [Step(frame, 0.0, 0.0, max(REST_SECONDS, REST_HALF_LIVES * slide_half_life))]


def frame_steps(snowfall, frame, fps, substeps=1, directions=1):
    """The steps that lay the snow of ``frame``, in order; the last one is on its own pose.

    substeps: poses. directions: of the whole shot, at least; each pose has equally many.
    """
    on_pose = math.ceil(frame_directions(snowfall, frame, directions) / substeps)
    depth = snowfall.depths[frame - snowfall.frame_start] / substeps
    dt = 1.0 / (fps * substeps)
    if frame == snowfall.frame_start:
        poses = [(frame, 0.0)] * substeps
    else:
        poses = [(frame - 1, index / substeps) for index in range(1, substeps)] + [(frame, 0.0)]
    return [step for pose in poses for step in _steps_on_pose(pose, depth, dt, on_pose)]


def _steps_on_pose(pose, depth, dt, count):
    """Steps that share a depth; every RUN-th and the last one share the time."""
    runs = math.ceil(count / RUN)
    ends = {math.ceil(count * (run + 1) / runs) for run in range(runs)}
    return [Step(*pose, depth / count, dt / runs if index in ends else 0.0) for index in range(1, count + 1)]


def fall_direction(fall_angle, bearing):
    """unit_direction of the falling snow. Raises ValueError for a fall angle that is not from 0 to
    MAX_FALL_ANGLE."""
    if not 0 <= fall_angle <= MAX_FALL_ANGLE + 1e-6:
        raise ValueError(
            f"The fall angle is {math.degrees(fall_angle):.2f} degrees; it must be from 0 to "
            f"{math.degrees(MAX_FALL_ANGLE):g}"
        )
    return unit_direction(fall_angle, bearing)


def unit_direction(fall_angle, bearing):
    """Unit vector at fall_angle radians from straight down, towards bearing: radians clockwise from +Y seen
    from above, where the wind blows to."""
    return (
        math.sin(fall_angle) * math.sin(bearing),
        math.sin(fall_angle) * math.cos(bearing),
        -math.cos(fall_angle),
    )


def metres_per_map(surface_area, uv_area):
    """Length that a map's full width has on the surface, in metres, on average over the layout."""
    if surface_area <= 0:
        raise ValueError("the surface has no area")
    if uv_area <= 0:
        raise ValueError("the UV map has no area: unwrap the object")
    return math.sqrt(surface_area / uv_area)


def automatic_resolution(surface_area, uv_area, texel_size):
    """The smallest power of two whose texels are not larger than texel_size metres, within limits."""
    wanted = metres_per_map(surface_area, uv_area) / texel_size
    resolution = MIN_AUTOMATIC_RESOLUTION
    while resolution < wanted and resolution < MAX_AUTOMATIC_RESOLUTION:
        resolution *= 2
    return resolution


def automatic_pixel_size(texel_sizes, low, high):
    """The finest of texel_sizes, coarsened until a box from low to high (metres) fits the limit of
    MAX_AUTOMATIC_PIXELS seen from any side."""
    if not texel_sizes:
        raise ValueError("there is no receiver")
    extent = sorted(max(0.0, b - a) for a, b in zip(low, high))
    # The shadow of a box is never larger than diagonal x the diagonal of its two longest sides.
    area = math.hypot(*extent) * math.hypot(extent[1], extent[2])
    return max(min(texel_sizes), math.sqrt(area / MAX_AUTOMATIC_PIXELS))


def parse_frames(text, frame_start, frame_end):
    """``"5-20"`` or ``"7"`` as (first, last). Raises ValueError when it is not inside the shot."""
    first, dash, last = text.strip().partition("-")
    try:
        first, last = int(first), int(last if dash else first)
    except ValueError:
        raise ValueError(f"'{text}' is no frame range; write it like 1-48") from None
    if not frame_start <= first <= last <= frame_end:
        raise ValueError(
            f"Frames {first}-{last} are not inside the shot, which is {frame_start}-{frame_end} in the scene"
        )
    return first, last
