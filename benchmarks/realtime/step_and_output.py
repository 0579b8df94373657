# SPDX-License-Identifier: GPL-3.0-or-later
"""What a step of snow and its output take together, by the size of the map: from moved vertices to smoothed heights and
normals.

    PYTHONPATH=build/python:tests/python/native /usr/bin/python3 benchmarks/realtime/step_and_output.py [--steps 8]

Prints a markdown table. The scene is a waving field of 32,768 triangles that moves as a whole; the map has as many
texels as the occlusion has pixels, as in the thesis. All times are wall times of one of the process's calls, medians:

- step: until the GPU has finished it (its balance is read back, a few bytes a receiver);
- queued: the same number of steps handed over one after the other, waited for once, and divided: what a step takes
  where nobody asks for its balance;
- heights, normals: the output of smoothed heights, then with normals, and its way back to the processor (4 and 16
  bytes a texel);
- GEOMETRY: a step by the thesis's own scatter on the same card.
"""

import argparse
import statistics
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "snow"))
from meshes import native, waving_field  # noqa: E402

EXTENT = 10.0
SLANT = (0.3, 0.0, -1.0)
DEPTH = 0.001


def timed(work):
    started = time.perf_counter()
    work()
    return time.perf_counter() - started


def measure(size, steps, mapping="COMPUTE"):
    """Medians of seconds: {"step", "queued", "heights", "normals"}."""
    positions, triangles, uv = waving_field()
    moved = [{"field": positions + np.float32(0.001 * k)} for k in range(steps + 1)]
    with native.SnowSimulation(
        pixel_size=EXTENT / size, engine="GL", mapping=mapping, blur_radius=2.0, noise_density=0.1
    ) as sim:
        sim.add_object("field", triangles, uv, resolution=size)

        def step(k):
            sim.step(moved[k], DEPTH, SLANT)

        def waited(k):
            step(k)
            sim.statistics()

        waited(0)
        sim.output("field")  # sets up what output needs
        taken = {"step": [timed(lambda k=k: waited(k)) for k in range(1, steps + 1)]}
        sim.snapshot("field", normal=False).output()
        taken["heights"] = [timed(lambda: sim.snapshot("field", normal=False).output()) for _ in range(steps)]
        taken["normals"] = [timed(lambda: sim.output("field")) for _ in range(steps)]

        def several():
            for k in range(1, steps + 1):
                step(k)
            sim.statistics()

        taken["queued"] = [timed(several) / steps]
    return {name: statistics.median(seconds) for name, seconds in taken.items()}


def row(*cells):
    print("| " + " | ".join(str(cell) for cell in cells) + " |", flush=True)


def milliseconds(seconds):
    return f"{seconds * 1e3:.3f}" if seconds < 0.1 else f"{seconds * 1e3:.1f}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--steps", type=int, default=8)
    parser.add_argument("--sizes", default="256,512,1024,2048,4096")
    given = parser.parse_args()
    row("map", "step ms", "queued ms", "heights ms", "normals ms", "step + normals ms", "GEOMETRY step ms")
    row(*["---"] * 7)
    for size in map(int, given.sizes.split(",")):
        try:
            ours, thesis = measure(size, given.steps), measure(size, given.steps, "GEOMETRY")
        except RuntimeError as error:
            print(f"\nthe table ends here: {error}")
            return 1
        cells = [
            ours["step"],
            ours["queued"],
            ours["heights"],
            ours["normals"],
            ours["step"] + ours["normals"],
        ]
        row(f"{size} x {size}", *map(milliseconds, [*cells, thesis["step"]]))
    return 0


if __name__ == "__main__":
    sys.exit(main())
