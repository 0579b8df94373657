# SPDX-License-Identifier: GPL-3.0-or-later
"""What each pass that moves lying snow costs, alone: processor time of a step on a ground of 3.2 m, 1024 x 1024 texels.

    python3 benchmarks/snow/reacting.py [--steps 9] [--only tyre,blade]

Each row is the median of its steps, less two that set up, beside a plain step of the same moment, without snowfall
where none falls; `adds` is what it takes more than that, as a part of a plain step while 3 mm fall, as in most shots.
The rows take turns with plain steps, so that a change of load affects all. 15 cm of snow lie there first; where it
snows, 3 mm fall a step.
"""

import argparse
import math
import sys
import time
from contextlib import ExitStack
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tests" / "python" / "native"))
from meshes import grid, native  # noqa: E402
from snow_meshes import box, rotated  # noqa: E402

SIZE, SIDE, DEPTH, DT = 3.2, 1024, 0.15, 1.0 / 24.0


def tyre(radius=0.3, width=0.14, around=96):
    turn = np.arange(around) * 2.0 * math.pi / around
    ring = np.stack([radius * np.cos(turn), np.zeros(around), radius * np.sin(turn)], axis=1)
    side = np.array([0.0, 0.5 * width, 0.0])
    points = np.concatenate([ring - side, ring + side, [-side, side]]).astype(np.float32)
    faces = []
    for i in range(around):
        j = (i + 1) % around
        faces += [(i, i + around, j + around), (i, j + around, j)]
        faces += [(2 * around, i, j), (2 * around + 1, j + around, i + around)]
    return points, np.array(faces, np.int32)


class Case:
    """A row: settings of the simulation, arguments of a step, and a tool that moves over the snow."""

    def __init__(self, name, tool=None, kind="NONE", over=0.0, speed=0.0, sheds=0.0, mask=False, **options):
        self.name, self.tool, self.kind, self.over, self.speed = name, tool, kind, over, speed
        self.sheds, self.mask = sheds, mask
        self.step = {key: options.pop(key) for key in ("sun", "wind") if key in options}
        self.falls = options.pop("falls", 0.003)
        self.settings = options

    def begin(self):
        sim = native.SnowSimulation(
            **{"pixel_size": SIZE / SIDE, "repose": math.radians(65.0), "engine": "CPU", **self.settings}
        )
        points, triangles, uv = grid(SIZE, SIZE, 4)
        sim.add_object("ground", triangles, uv, resolution=SIDE)
        poses = {"ground": points}
        if self.tool is not None:
            blank = np.zeros((len(self.tool[1]), 3, 2), np.float32)
            sim.add_object("tool", self.tool[1], blank, receive=False, occlude=self.kind == "NONE")
            sim.set_presser("tool", self.kind)
            poses["tool"] = self.pose(0)
        if self.mask:
            sim.set_mask("ground", np.full((len(triangles), 3), 0.5, np.float32))
        sim.step(poses, DEPTH, dt=0.0)
        if self.sheds:
            sim.set_shed_half_life("ground", self.sheds)
        return sim

    def pose(self, number):
        way = np.float32([-1.2 + self.speed * DT * number, 0.0, self.over])
        return (self.tool[0] + way).astype(np.float32)

    def timed(self, sim, number):
        poses = {"tool": self.pose(number)} if self.speed else {}
        begun = time.process_time()
        sim.step(poses, self.falls, dt=DT, **self.step)
        return time.process_time() - begun


def cases():
    blade = box(1.0, 0.4)
    slanting = rotated(blade[0] * np.float32([0.03, 1.0, 1.0]), "z", 30.0), blade[1]
    wall = box(1.0, 0.8)
    fence = wall[0] * np.float32([0.05, 1.6, 1.0]), wall[1]
    sunny = {"falls": -0.003, "sun": (0.5, 0.0, -1.0)}
    return [
        Case("a mask of one half", mask=True),
        Case("a tyre above the snow", tyre(), "PRESS", 0.6, 1.5),
        Case("a tyre in the snow", tyre(), "PRESS", 0.36, 1.5),
        Case("a tyre as a broom", tyre(), "CLEAR", 0.36, 1.5),
        Case("a blade with its heap", slanting, "PLOUGH", 0.01, 1.4),
        Case("shedding in 5 s", sheds=5.0),
        Case("thaw in the sun", **sunny),
        Case("thaw with Wet Ground", wet=True, **sunny),
        Case("rain with Wet Ground", falls=0.0, wet=True, rain=0.01),
        Case("drifts", drift=0.5, wind=(1.0, 0.0)),
        Case("drifts behind a wall", fence, over=0.0, drift=0.5, wind=(1.0, 0.0)),
        Case("Granular", granular=True),
        Case("dust, with Rising", flutter=math.pi / 2, repose=math.pi / 2, adhesion=0.3, rising=0.1),
    ]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--steps", type=int, default=9)
    parser.add_argument("--only", default="", help="rows whose names contain one of these texts")
    options = parser.parse_args()
    wanted = [text for text in options.only.split(",") if text]
    print("| a step with | ms | plain step, ms | ratio | adds |\n|---|---|---|---|---|")
    for case in cases():
        if wanted and not any(text in case.name for text in wanted):
            continue
        rows = [case, Case("plain", falls=max(case.falls, 0.0)), Case("snowing")]
        with ExitStack() as stack:
            sims = [stack.enter_context(row.begin()) for row in rows]
            taken = [[row.timed(sim, n) for row, sim in zip(rows, sims)] for n in range(1, options.steps + 3)]
        one, base, usual = (1e3 * float(np.median(times)) for times in zip(*taken[2:]))
        adds = (one - base) / usual
        print(f"| {case.name} | {one:.0f} | {base:.0f} | {one / base:.2f} | {adds:.2f} |", flush=True)


if __name__ == "__main__":
    main()
