# SPDX-License-Identifier: GPL-3.0-or-later
"""Time of a step of snow and its output, by the size of the map: from moved vertices to smoothed heights and normals.

    PYTHONPATH=build/python:tests/python/native /usr/bin/python3 benchmarks/realtime/step_and_output.py [--steps 8]

Prints a markdown table. The scene is a waving field of 32,768 triangles that moves as a whole. The map has as many
texels as the occlusion has pixels, as in the thesis; smoothing has a radius of two texels. All figures are medians of
calls. GPU times are those of the passes by the GPU's own clock, wall times those of the call:

- step: until the GPU has finished it (its balance is read back, a few bytes per receiver);
- queued: the same number of steps queued together, waited for once, and divided by their number;
- GPU output: the smoothed map as the texture that the renderer draws from, with normals per pixel;
- step + output: both on the GPU;
- heights, normals: the output of a bake, made by the processor, with the transfer (4 and 16 bytes per texel);
- GEOMETRY: a step with the thesis's scatter on the same card.
"""

import argparse
import statistics
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "snow"))
from meshes import native, waving_field  # noqa: E402

MAPLE = Path(__file__).resolve().parents[2] / "tests" / "data" / "small_maple.obj"
EXTENT = 10.0
SLANT = (0.3, 0.0, -1.0)
DEPTH = 0.001


def timed(work):
    started = time.perf_counter()
    work()
    return time.perf_counter() - started


def gpu_seconds(sim):
    """Time of the passes since the last call, by the GPU's clock."""
    return sum(cost["gpu_seconds"] for cost in sim.pass_costs().values())


def measure(size, steps, mapping="COMPUTE"):
    """Medians of seconds by name."""
    positions, triangles, uv = waving_field()
    moved = [{"field": positions + np.float32(0.001 * k)} for k in range(steps + 1)]
    texel = EXTENT / size
    with (
        native.SnowSimulation(
            pixel_size=texel, engine="GL", mapping=mapping, blur_radius=2 * texel, noise_density=0.1
        ) as sim,
        native.Renderer() as renderer,
    ):
        sim.add_object("field", triangles, uv, resolution=size)
        # A renderer takes maps for trees; which one and how large it is changes nothing.
        renderer.add_tree("tree", native.build_tree_mesh(native.read_tree(MAPLE), snow_resolution=256))

        def step(k):
            sim.step(moved[k], DEPTH, SLANT)

        def waited(k):
            step(k)
            sim.statistics()

        def shared():
            if not renderer.take_snow("tree", sim, DEPTH, object="field"):
                raise RuntimeError("the map did not stay on the GPU")

        waited(0)
        shared()  # prepares the output
        sim.output("field")
        taken = {"step": [timed(lambda k=k: waited(k)) for k in range(1, steps + 1)]}
        sim.snapshot("field", normal=False).output()
        taken["heights"] = [timed(lambda: sim.snapshot("field", normal=False).output()) for _ in range(steps)]
        taken["normals"] = [timed(lambda: sim.output("field")) for _ in range(steps)]

        def several():
            for k in range(1, steps + 1):
                step(k)
            sim.statistics()

        taken["queued"] = [timed(several) / steps]
        # Reading the GPU's clock takes time, so wall time is measured separately.
        sim.measure_passes(True)
        taken["GPU step"], taken["GPU output"], taken["output"] = [], [], []
        for k in range(1, steps + 1):
            waited(k)
            taken["GPU step"].append(gpu_seconds(sim))
            taken["output"].append(timed(shared))
            taken["GPU output"].append(gpu_seconds(sim))
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
    names = ("GPU step", "step", "queued", "GPU output", "output")
    heads = ("step GPU", "step wall", "queued wall", "output GPU", "output wall")
    row(
        "map",
        *(f"{head} ms" for head in heads),
        "step + output GPU ms",
        "GEOMETRY GPU ms",
        "GEOMETRY wall ms",
    )
    row(*["---"] * 9)
    baked = []
    for size in map(int, given.sizes.split(",")):
        try:
            ours, thesis = measure(size, given.steps), measure(size, given.steps, "GEOMETRY")
        except RuntimeError as error:
            print(f"\nthe table ends here: {error}")
            return 1
        cells = [*(ours[name] for name in names), ours["GPU step"] + ours["GPU output"]]
        row(f"{size} x {size}", *map(milliseconds, [*cells, thesis["GPU step"], thesis["step"]]))
        baked.append((size, ours))
    print()
    row("map", "a bake's heights, wall ms", "with normals, wall ms")
    row(*["---"] * 3)
    for size, ours in baked:
        row(f"{size} x {size}", milliseconds(ours["heights"]), milliseconds(ours["normals"]))
    return 0


if __name__ == "__main__":
    sys.exit(main())
