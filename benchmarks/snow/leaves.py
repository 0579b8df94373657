# SPDX-License-Identifier: GPL-3.0-or-later
"""Cost of alpha, as a table.

The steps are over 5,000 leaf cards that are opaque, that have an image without a hole, or an image shaped like a leaf.

    PYTHONPATH=build/python python3 benchmarks/snow/leaves.py [--steps 16] [--cards 5000]

Steps of the three take turns. "CPU" is the processor time of a step (all threads), which other load on the machine
affects less than wall time.
"""

import argparse
import statistics
import time

import numpy as np
import snowbough_native as native
from snow_meshes import STAYS

QUAD = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], np.float32)
TRIANGLES = np.array([[0, 1, 2], [0, 2, 3]], np.int32)


def cards(count):
    """Positions, triangles and UVs of cards of 6 cm, turned and tilted at random over 2 x 2 m."""
    random = np.random.default_rng(1)
    centre = random.uniform(-1, 1, (count, 3)) + (0, 0, 1.5)
    turn, tilt = random.uniform(0, 2 * np.pi, count), random.normal(0, 0.4, (2, count))
    x = 0.03 * np.stack([np.cos(turn), np.sin(turn), tilt[0]], axis=1)
    y = 0.03 * np.stack([-np.sin(turn), np.cos(turn), tilt[1]], axis=1)
    corners = np.stack([centre - x - y, centre + x - y, centre + x + y, centre - x + y], axis=1)
    triangles = (TRIANGLES + 4 * np.arange(count)[:, None, None]).reshape(-1, 3)
    uv = np.tile(QUAD[TRIANGLES], (count, 1, 1))
    return corners.reshape(-1, 3).astype(np.float32), triangles.astype(np.int32), uv


def leaf_image(size=256):
    v, u = np.mgrid[0:size, 0:size] / size
    return np.where(np.abs(v - 0.5) < 0.4 * np.sin(np.pi * u), 255, 0).astype(np.uint8)


def simulation(mesh, image):
    positions, triangles, uv = mesh
    ground = np.float32([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)])
    alpha = None
    if image is not None:
        index = np.zeros(len(triangles), np.int32)
        alpha = {"uv": uv, "image": index, "images": [image], "extensions": ["REPEAT"]}
    sim = native.SnowSimulation(repose=STAYS, pixel_size=2 / 1024)
    sim.add_object("ground", TRIANGLES, QUAD[TRIANGLES], resolution=1024)
    sim.add_object("leaves", triangles, np.zeros_like(uv), receive=False, alpha=alpha)
    sim.step({"ground": ground, "leaves": positions}, 0.001)
    sim.statistics()
    return sim


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--steps", type=int, default=16)
    parser.add_argument("--cards", type=int, default=5000)
    options = parser.parse_args()
    mesh, leaf = cards(options.cards), leaf_image()
    kinds = {"opaque": None, "image without a hole": np.full_like(leaf, 255), "leaf": leaf}
    simulations = {name: simulation(mesh, image) for name, image in kinds.items()}
    times = {name: ([], []) for name in kinds}
    for _ in range(options.steps):
        for name, sim in simulations.items():
            wall, cpu = time.perf_counter(), time.process_time()
            sim.step({}, 0.001)
            sim.statistics()  # waits for the GPU
            times[name][0].append(1e3 * (time.perf_counter() - wall))
            times[name][1].append(1e3 * (time.process_time() - cpu))
    print(f"{native.Engine().info['driver']}; {options.cards} cards, 1024 x 1024 pixels\n")
    print("| cards | wall ms a step | CPU ms a step | of opaque | ground seen m2 |")
    print("|---|---|---|---|---|")
    base = statistics.median(times["opaque"][1])
    for name, sim in simulations.items():
        wall, cpu = (statistics.median(values) for values in times[name])
        seen = sim.statistics()["visible_area"]
        print(f"| {name} | {wall:.1f} | {cpu:.1f} | {cpu / base:.2f} | {seen:.3f} |")


if __name__ == "__main__":
    main()
