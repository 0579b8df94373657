# SPDX-License-Identifier: GPL-3.0-or-later
"""Time of a step of snow, in tables like the thesis's table 4.2 and figure 4.13; ratios are from one run.

    python3 benchmarks/snow/speed.py [--steps 6] [--tables mapping,occlusion,maps,objects,triangles]

The thesis's figures: 103 to 112 frames per second with 1024 x 1024 maps on a GTX 580; scenes of 1,106 to 42,918 base
polygons within 10 % of each other (D. T. Reynolds, Real-Time Rendering and Simulation of Trees and Snow, 2014, chapter
4). Every row is the median of its steps. The extent of the occlusion stays the same, its pixel varies. GPU ms are those
of the passes by the GPU's own clock, "-" for the engine CPU; processor ms are the sum over threads, and are comparable
on a busy machine.
"""

import argparse
import os
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
from meshes import grid, native, waving_field  # noqa: E402

EXTENT = 10.0
SLANT = (0.3, 0.0, -1.0)


def median_step(meshes, resolution, pixel_size, steps, density=1.0, **settings):
    """Medians of a step with everything moving, after one that sets up, in seconds: on the wall, the processor's, and
    the GPU's (None on the CPU engine)."""
    with native.SnowSimulation(pixel_size=pixel_size, noise_density=density, **settings) as sim:
        for name, (_, triangles, uv) in meshes.items():
            sim.add_object(name, triangles, uv, resolution=resolution)
        sim.measure_passes(True)
        wall, processor, gpu = [], [], []
        for step in range(steps + 1):
            moved = {name: mesh[0] + np.float32(0.001 * step) for name, mesh in meshes.items()}
            started = time.perf_counter(), time.process_time()
            sim.step(moved, 0.001, SLANT)
            sim.statistics()  # waits for the GPU
            wall.append(time.perf_counter() - started[0])
            processor.append(time.process_time() - started[1])
            gpu.append(sum(cost["gpu_seconds"] for cost in sim.pass_costs().values()))
        has_gpu = sim.engine["name"] == "GL"
        medians = [float(np.median(taken[1:])) for taken in (wall, processor, gpu)]
        return (*medians[:2], medians[2] if has_gpu else None)


def columns(wall, processor, gpu):
    """The cells of a step's times."""
    of_gpu = "-" if gpu is None else f"{gpu * 1e3:.3f}"
    return of_gpu, f"{wall * 1e3:.1f}", f"{processor * 1e3:.1f}", f"{1 / wall:.1f}"


TIMES = ("GPU ms a step", "wall ms", "processor ms", "steps a second")


def line(*cells):
    print("| " + " | ".join(str(cell) for cell in cells) + " |", flush=True)


def head(title, *cells):
    print(f"\n{title}\n")
    line(*cells)
    line(*("---" for _ in cells))


def mapping_table(steps):
    head(
        "Engines, and the thesis's own scatter, noise density 10 %, maps and occlusion of one size",
        "size",
        "CPU wall ms",
        "GL GPU ms",
        "GL wall ms",
        "GEOMETRY GPU ms",
        "GEOMETRY wall ms",
        "GL / CPU",
        "GEOMETRY / GL",
    )
    field = {"field": waving_field()}
    for size in (256, 512, 1024, 2048):
        kinds = ({"engine": "CPU"}, {"engine": "GL"}, {"engine": "GL", "mapping": "GEOMETRY"})
        taken = [[], [], []]
        for _ in range(2):  # take turns, so that a change of load affects all
            for kind, times in zip(kinds, taken, strict=True):
                times.append(median_step(field, size, EXTENT / size, steps, 0.1, **kind))
        (cpu, *_), (gl, _, gl_gpu), (geometry, _, geometry_gpu) = (min(times) for times in taken)
        line(
            size,
            *(f"{seconds * 1e3:.1f}" for seconds in (cpu, gl_gpu, gl, geometry_gpu, geometry)),
            f"{gl / cpu:.2f}",
            f"{geometry / gl:.2f}",
        )


def occlusion_table(steps):
    head("Occlusion size, one map of 1024, 32,768 triangles", "occlusion", *TIMES)
    for size in (256, 512, 1024, 2048, 4096):
        taken = median_step({"field": waving_field()}, 1024, EXTENT / size, steps)
        line(f"{size} x {size}", *columns(*taken))


def map_table(steps):
    head("Map size, occlusion 1024 x 1024, 32,768 triangles", "map", *TIMES)
    for size in (256, 512, 1024, 2048, 4096):
        taken = median_step({"field": waving_field()}, size, EXTENT / 1024, steps)
        line(f"{size} x {size}", *columns(*taken))


def object_table(steps):
    head(
        "Object count, maps of 256, 2,048 triangles each, occlusion 1024 x 1024",
        "objects",
        *TIMES,
        "processor ms an object",
    )
    for count in (1, 4, 16, 64, 256):
        side = int(np.ceil(np.sqrt(count)))
        patch = grid(EXTENT / side * 0.9, EXTENT / side * 0.9, 32)
        placed = {}
        for i in range(count):
            shift = np.float32((EXTENT / side * (i % side), EXTENT / side * (i // side), 0.0))
            placed[f"{i:04}"] = (patch[0] + shift, *patch[1:])
        taken = median_step(placed, 256, EXTENT / 1024, steps)
        line(count, *columns(*taken), f"{taken[1] / count * 1e3:.2f}")


def triangle_table(steps):
    head(
        "Triangle count, one map of 1024, occlusion 1024 x 1024 (thesis: within 10 % up to 42,918)",
        "triangles",
        *TIMES,
        "processor's, against the first",
    )
    first = None
    for cells in (23, 70, 146, 300, 700):
        taken = median_step({"field": waving_field(cells)}, 1024, EXTENT / 1024, steps)
        first = first or taken[1]
        line(f"{2 * cells * cells:,}", *columns(*taken), f"{taken[1] / first:.2f}")


TABLES = {
    "mapping": mapping_table,
    "occlusion": occlusion_table,
    "maps": map_table,
    "objects": object_table,
    "triangles": triangle_table,
}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--steps", type=int, default=6)
    parser.add_argument("--tables", default=",".join(TABLES))
    given = parser.parse_args()
    print(f"{native.Engine().info}; GL: {native.Engine('GL').info['driver']}; {os.cpu_count()} cores")
    for name in given.tables.split(","):
        try:
            TABLES[name](given.steps)
        except RuntimeError as error:
            print(f"the table ends here: {error}")


if __name__ == "__main__":
    main()
