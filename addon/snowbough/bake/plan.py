# SPDX-License-Identifier: GPL-3.0-or-later
"""Converts settings to snowfall: how much snow falls on which frame, from where, and onto which grid.

Pure numbers, no ``bpy``. Depths are metres on open, level ground, angles radians, frames integers.

**When snow falls.** Frame f adds ``(end_depth - start_depth) * rate(f) / sum of all rates``, and the map of frame f
shows the snow after that. ``start_depth`` falls before the first frame's own snow, on the first frame's pose, in
PREROLL_STEPS steps or one per direction. With substeps, the snow of frame f falls on the poses at the ends of equal
parts of the interval from f - 1 to f, the last of which is the pose of frame f. The first frame has no such interval in
the shot, so all its snow falls on its own pose. The depths are differences of a running total that ends exactly at
``end_depth``, so rounding errors do not accumulate.

**Thaw.** With an end depth below the start depth, frames lose snow instead, in one step for each pose.

**How many directions.** With flutter, each step has another direction, and shadows are soft and even only with many
directions. A shot gets at least ``directions``, distributed over its frames by their snow: a still gets all of them, a
shot of 12 frames gets 5 on each of the first 8 frames and 6 on each of the last 4 (64 together), and a shot of 250
frames takes one step per frame, as without this rule. Steps on one pose have equal depths. The time of the pose, in
which snow slides and comes to rest, goes to every RUN-th step and the last, since it costs more than the fall. The
simulation counts the steps and picks the direction by the count, so resumed and split bakes get the same directions.

**Continued shots.** If frames were added to a finished bake, its frames keep their depths and steps: each part of the
shot is planned alone. Later parts get as many directions per metre of snow as the first one with snow.
"""

import functools
import itertools
import math
import re
from dataclasses import dataclass, replace
from fractions import Fraction

from ..base.names import MAX_FALL_ANGLE

# Steps of the start depth without flutter.
PREROLL_STEPS = 32
# Steps on one pose after which snow may slide.
RUN = 6

MIN_AUTOMATIC_RESOLUTION = 256
MAX_AUTOMATIC_RESOLUTION = 4096

# Limit of the occlusion pixels of the whole scene for an automatic pixel size: with more, large ground would take
# minutes per frame without a GPU.
MAX_AUTOMATIC_PIXELS = 4096 * 4096

# 64 half-lives leave 5e-20 of an excess.
REST_HALF_LIVES = 64
# Seconds in which repose comes to rest and walls shed their snow.
REST_SECONDS = 4.0


@dataclass(frozen=True)
class Step:
    """One step of the simulation."""

    frame: int
    """The pose is that of time ``frame + subframe``."""
    subframe: float
    depth: float
    """Metres on open, level ground; negative for snow that thaws."""
    dt: float
    """Seconds."""
    sheds: bool = True
    """Whether leaves and boughs shed, and snow drifts."""


@dataclass(frozen=True)
class Snowfall:
    """The snowfall of a whole shot, whichever part of it is baked."""

    frame_start: int
    frame_end: int
    preroll: float
    """Metres before the first frame's own snow."""
    depths: tuple
    """Metres that each frame adds, first to last; negative where snow thaws."""
    totals: tuple
    """Total metres after each frame, pre-roll included."""
    parts: tuple = ()
    """Last frames of the parts before the last one."""


def plan_snowfall(frame_start, frame_end, start_depth, end_depth, rates, parts=()):
    """Distributes ``end_depth - start_depth`` over the frames in proportion to ``rates``.

    rates: one number >= 0 for every frame from frame_start to frame_end. parts: of a continued shot, (last frame, depth
    after it) of each part that was baked before. Below the start depth, snow thaws. Raises ValueError for an empty
    range, a negative depth, and wrong or missing rates.
    """
    count = frame_end - frame_start + 1
    if parts and len(rates) == count:
        (last, depth), split = parts[-1], parts[-1][0] - frame_start + 1
        if not frame_start <= last < frame_end:
            raise ValueError(
                f"Frames {frame_start}-{last} are baked: to continue, set the last frame ({frame_end}) after them"
            )
        if end_depth < depth:
            raise ValueError(
                f"{depth:g} m of snow lie at frame {last}, and added frames do not thaw: to continue, set the end "
                f"depth ({end_depth:g} m) to at least that"
            )
        before = plan_snowfall(frame_start, last, start_depth, depth, rates[:split], parts[:-1])
        after = plan_snowfall(last + 1, frame_end, depth, end_depth, rates[split:])
        return Snowfall(
            frame_start,
            frame_end,
            start_depth,
            before.depths + after.depths,
            before.totals + after.totals,
            (*before.parts, last),
        )
    if count < 1:
        raise ValueError(f"The last frame ({frame_end}) is before the first ({frame_start})")
    if frame_start < 0:
        raise ValueError(f"The first frame is {frame_start}: image sequences start at frame 0 or later")
    if not (0 <= start_depth and 0 <= end_depth):
        raise ValueError(
            f"The start depth ({start_depth:g} m) and the end depth ({end_depth:g} m) must be at least 0"
        )
    if len(rates) != count:
        raise ValueError(f"{count} frames need {count} rates, got {len(rates)}")
    for frame, rate in zip(range(frame_start, frame_end + 1), rates):
        if not (rate >= 0 and math.isfinite(rate)):
            raise ValueError(f"The rate at frame {frame} is {rate}: it must be a number from 0 up")
    falling = math.fsum(rates)
    if falling == 0 and end_depth != start_depth:
        raise ValueError(
            "The rate is 0 on every frame, so the end depth cannot be reached: raise the rate on a frame, or set the "
            "end depth to the start depth"
        )
    totals = []
    # Fractions add without error, so equal rates share the depth equally.
    for fallen in itertools.accumulate(map(Fraction, rates)):
        share = float(fallen) / falling if falling else 0.0
        totals.append(start_depth + (end_depth - start_depth) * share)
    totals[-1] = end_depth
    least, most = (-math.inf, 0.0) if end_depth < start_depth else (0.0, math.inf)
    depths = [min(max(least, after - before), most) for before, after in zip([start_depth] + totals, totals)]
    return Snowfall(frame_start, frame_end, start_depth, tuple(depths), tuple(totals))


def frame_directions(snowfall, frame, directions):
    """The number of directions for the snow of ``frame`` if the shot has at least ``directions``: a whole number in
    proportion to its depth, at least 1."""
    return _shared_directions(snowfall, directions)[frame - snowfall.frame_start]


@functools.lru_cache(maxsize=8)
def _shared_directions(snowfall, directions):
    """frame_directions of all frames."""
    counts, reached, pace = [], snowfall.preroll, None
    for last in (*snowfall.parts, snowfall.frame_end):
        end = last - snowfall.frame_start + 1
        falling, reached = snowfall.totals[end - 1] - reached, snowfall.totals[end - 1]
        wanted = directions if pace is None else math.ceil(pace * falling - 1e-6)
        counts += _counts(snowfall.depths[len(counts) : end], falling, wanted)
        if pace is None and falling > 0:
            pace = directions / falling
    return tuple(counts)


def _counts(depths, falling, directions):
    """Directions of the frames of a part of a shot. The remainder after rounding down goes to the last frames, one
    each: shadows are even if frames with equal counts lie in a row, and not if they alternate."""
    if falling <= 0:
        return [1] * len(depths)
    shares = [directions * depth / falling for depth in depths]
    counts = [max(1, math.floor(share + 1e-6)) for share in shares]
    left = directions - sum(counts)
    for index in reversed(range(len(counts))):
        if left > 0 and counts[index] < math.ceil(shares[index] - 1e-6):
            counts[index] += 1
            left -= 1
    return counts


def preroll_steps(snowfall, fps, slide_half_life, directions=1):
    """The steps before the first frame's own snow: PREROLL_STEPS or one per direction, then one without snow until
    nothing slides any more. Empty without pre-roll."""
    if snowfall.preroll <= 0:
        return []
    frame = snowfall.frame_start
    count = max(PREROLL_STEPS, directions)
    steps = _steps_on_pose((frame, 0.0), snowfall.preroll, count / fps, count)
    steps.append(Step(frame, 0.0, 0.0, max(REST_SECONDS, REST_HALF_LIVES * slide_half_life)))
    return [replace(step, sheds=False) for step in steps]


def frame_steps(snowfall, frame, fps, substeps=1, directions=1):
    """The steps for the snow of ``frame``, in order; the last one is on its own pose.

    substeps: number of poses. directions: minimum for the whole shot; each pose has equally many.
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
    """Steps with equal depths; every RUN-th and the last one share the time."""
    runs = math.ceil(count / RUN)
    ends = {math.ceil(count * (run + 1) / runs) for run in range(runs)}
    return [Step(*pose, depth / count, dt / runs if index in ends else 0.0) for index in range(1, count + 1)]


def poses_of_frame(request, snowfall, frame):
    """[((frame, subframe), [Step, ...]), ...]: the poses and steps that lead to the map of ``frame`` of a
    BakeRequest's shot. snowfall: from plan_snowfall."""
    directions = request.directions if request.snow["flutter"] > 0 else 1
    steps = frame_steps(snowfall, frame, request.fps, request.substeps, directions)
    if frame == request.frame_start:
        half_life = request.snow["slide_half_life"]
        steps = preroll_steps(snowfall, request.fps, half_life, directions) + steps
    poses = []
    for step in steps:
        at = (step.frame, step.subframe)
        if not poses or poses[-1][0] != at:
            poses.append((at, []))
        poses[-1][1].append(step)
    return poses


def fall_direction(fall_angle, bearing):
    """unit_direction of the falling snow. Raises ValueError unless the fall angle is from 0 to MAX_FALL_ANGLE."""
    if not 0 <= fall_angle <= MAX_FALL_ANGLE + 1e-6:
        raise ValueError(
            f"The fall angle is {math.degrees(fall_angle):.2f} degrees: it must be from 0 to "
            f"{math.degrees(MAX_FALL_ANGLE):g}"
        )
    return unit_direction(fall_angle, bearing)


def weather(pose, blows=True):
    """Further arguments of the native step for a scene.pose.ScenePose. blows: whether snow may drift."""
    sun = {"sun": pose.sun} if any(pose.sun) else {}
    return {**sun, "wind": unit_direction(math.pi / 2, pose.bearing)[:2]} if blows else sun


def unit_direction(fall_angle, bearing):
    """Unit vector at fall_angle radians from straight down, towards bearing: radians clockwise from +Y seen from above,
    the direction that the wind blows to."""
    return (
        math.sin(fall_angle) * math.sin(bearing),
        math.sin(fall_angle) * math.cos(bearing),
        -math.cos(fall_angle),
    )


def metres_per_map(surface_area, uv_area):
    """Length on the surface, in metres, of a map's full width, averaged over the layout."""
    if surface_area <= 0:
        raise ValueError("the surface has no area")
    if uv_area <= 0:
        raise ValueError("the UV map has no area: unwrap the object")
    return math.sqrt(surface_area / uv_area)


def automatic_resolution(surface_area, uv_area, texel_size):
    """The smallest power of two whose texels are at most texel_size metres, within limits."""
    wanted = metres_per_map(surface_area, uv_area) / texel_size
    resolution = MIN_AUTOMATIC_RESOLUTION
    while resolution < wanted and resolution < MAX_AUTOMATIC_RESOLUTION:
        resolution *= 2
    return resolution


def automatic_pixel_size(texel_sizes, low, high):
    """The smallest of texel_sizes, or larger if a box from low to high (metres), seen from any side, would have more
    than MAX_AUTOMATIC_PIXELS."""
    if not texel_sizes:
        raise ValueError("there is no receiver")
    extent = sorted(max(0.0, b - a) for a, b in zip(low, high))
    # The projection of a box is at most its diagonal times the diagonal of its two longest sides.
    area = math.hypot(*extent) * math.hypot(extent[1], extent[2])
    return max(min(texel_sizes), math.sqrt(area / MAX_AUTOMATIC_PIXELS))


def parse_names(text):
    """The names in a list with commas, empty for None. Raises ValueError for a list without a name."""
    names = [name.strip() for name in (text or "").split(",") if name.strip()]
    if text is not None and not names:
        raise ValueError(f"'{text}' names no receiver: write them like Ground,Bench")
    return names


def parse_frames(text, frame_start, frame_end):
    """(first, last) from ``"5-20"``, ``"-3-7"`` or ``"7"``. Raises ValueError unless it is inside the shot."""
    match = re.fullmatch(r"\s*(-?\d+)(?:-(-?\d+))?\s*", text, re.ASCII)
    if not match:
        raise ValueError(f"'{text}' is not a frame range: write it like 1-48")
    first, last = int(match[1]), int(match[2] or match[1])
    if not frame_start <= first <= last <= frame_end:
        raise ValueError(
            f"Frames {first}-{last} are not inside the shot: the scene's range is {frame_start}-{frame_end}"
        )
    return first, last
