# SPDX-License-Identifier: GPL-3.0-or-later
"""Time of a step of snow, as tables: by occlusion size, map size, objects and triangles, and by mapping at a noise
density of 10 %.

    PYTHONPATH=build/python:tests/python/native python3 benchmarks/snow/steps.py [--steps 8]

Wall times are medians of the steps; "CPU" is the processor time of a step (all threads), which other load on the
machine affects less.
"""

import argparse
import statistics
import time

import numpy as np
import snowbough_native as native
from snow_meshes import STAYS, sphere

RADIUS = 0.5


def measure(steps, resolution=1024, pixels=1024, objects=1, rings=24, mapping="COMPUTE", density=1.0):
    """Wall and CPU milliseconds of a step on moving spheres; `pixels` across the whole scene."""
    positions, triangles, uv = sphere(RADIUS, 2 * rings, rings)
    side = int(np.ceil(np.sqrt(objects)))
    places = [np.float32((1.1 * (i % side), 1.1 * (i // side), 0.0)) for i in range(objects)]
    pixel_size = 1.1 * side / pixels
    with native.SnowSimulation(
        repose=STAYS, pixel_size=pixel_size, mapping=mapping, noise_density=density
    ) as sim:
        for i in range(objects):
            sim.add_object(f"{i:04}", triangles, uv, resolution=resolution)
        walls, cpus = [], []
        for step in range(steps + 2):
            rise = np.float32((0.0, 0.0, 0.01 * step))
            moved = {f"{i:04}": positions + place + rise for i, place in enumerate(places)}
            wall, cpu = time.perf_counter(), time.process_time()
            sim.step(moved, 0.001, (0.3, 0.2, -1.0))
            sim.statistics()  # waits for the GPU
            walls.append(time.perf_counter() - wall)
            cpus.append(time.process_time() - cpu)
    return 1e3 * statistics.median(walls[2:]), 1e3 * statistics.median(cpus[2:]), len(triangles) * objects


def row(label, wall, cpu, note=""):
    print(f"| {label:<44} | {wall:9.1f} | {cpu:9.1f} | {1e3 / wall:7.1f} | {note:<22} |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--steps", type=int, default=8, help="measured steps a row")
    steps = parser.parse_args().steps
    print(f"{native.Engine().info['driver']}; every object moves in every step\n")
    print(f"| {'case':<44} | {'wall ms':>9} | {'CPU ms':>9} | {'steps/s':>7} | {'':<22} |")
    print(f"|{'-' * 46}|{'-' * 11}|{'-' * 11}|{'-' * 9}|{'-' * 24}|")
    for pixels in (256, 512, 1024, 2048):
        wall, cpu, _ = measure(steps, pixels=pixels)
        row(f"occlusion {pixels} x {pixels}, map 1024", wall, cpu)
    for resolution in (256, 512, 1024, 2048):
        wall, cpu, _ = measure(steps, resolution=resolution, pixels=512)
        row(f"map {resolution}, occlusion 512 x 512", wall, cpu)
    for objects in (1, 10, 100, 1000):
        wall, cpu, triangles = measure(steps, resolution=128, pixels=512, objects=objects, rings=8)
        row(f"{objects} objects with maps of 128, occlusion 512", wall, cpu, f"{triangles} triangles")
    for rings in (16, 50, 104, 300):
        wall, cpu, triangles = measure(steps, resolution=512, pixels=512, rings=rings)
        row(f"{triangles} triangles, map 512, occlusion 512", wall, cpu)
    pair = {}
    for mapping in ("COMPUTE", "GEOMETRY"):
        wall, cpu, _ = measure(steps, mapping=mapping, density=0.1)
        pair[mapping] = (wall, cpu)
        ratios = wall / pair["COMPUTE"][0], cpu / pair["COMPUTE"][1]
        note = "" if mapping == "COMPUTE" else f"{ratios[0]:.1f} x wall, {ratios[1]:.1f} x CPU"
        row(f"{mapping}, density 10 %, map and occlusion 1024", wall, cpu, note)


if __name__ == "__main__":
    main()
