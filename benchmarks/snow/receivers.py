# SPDX-License-Identifier: GPL-3.0-or-later
"""First steps of a scene of many receivers: processor time of each part, and memory.

    python3 benchmarks/snow/receivers.py [--count 1000] [--resolution 256] [--mesh square|hill|ball] [--steps 2] [--own]

The receivers are copies of one mesh of about 200 triangles, half a metre wide, side by side. --own: meshes of their
own, which share no texel table. 1 mm of snow falls per step, with a flutter of 10 degrees, repose in every step, engine
CPU. The last line is a hash of all maps.
"""

import argparse
import hashlib
import resource
import time

import numpy as np
from meshes import grid, native, sphere

WIDTH = 0.5


def mesh(kind):
    if kind == "ball":
        return sphere(0.5 * WIDTH, 14, 8)
    positions, triangles, uv = grid(WIDTH, WIDTH, cells=10)
    if kind == "hill":
        positions[:, 2] = 0.06 * np.cos(positions[:, 0] * 20.0) * np.cos(positions[:, 1] * 15.0)
    return positions, triangles, uv


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--resolution", type=int, default=256)
    parser.add_argument("--mesh", default="square", choices=["square", "hill", "ball"])
    parser.add_argument("--steps", type=int, default=2)
    parser.add_argument("--own", action="store_true")
    arguments = parser.parse_args()
    positions, triangles, uv = mesh(arguments.mesh)
    started = time.process_time()

    def report(part):
        nonlocal started
        memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1000.0
        print(f"{part:<12} {time.process_time() - started:8.2f} s, {memory:8.0f} MB", flush=True)
        started = time.process_time()

    side = int(np.ceil(np.sqrt(arguments.count)))
    placed = {
        f"{i:05}": positions + np.float32((1.2 * WIDTH * (i % side), 1.2 * WIDTH * (i // side), 0.0))
        for i in range(arguments.count)
    }
    settings = {"pixel_size": 0.01, "flutter": np.radians(10.0), "engine": "CPU"}
    with native.SnowSimulation(**settings) as sim:
        for i, (name, rest) in enumerate(placed.items()):
            own = (uv * np.float32(1.0 - 1e-5 * i)) if arguments.own else uv
            sim.add_object(name, triangles, own, resolution=arguments.resolution, rest=rest)
        report("add")
        for step in range(arguments.steps):
            sim.step(placed if step == 0 else {}, 0.001, dt=1.0 / 24.0)
            report(f"step {step + 1}")
        digest = hashlib.sha256()
        for name in placed:
            digest.update(sim.height(name).tobytes())
    print(digest.hexdigest())


if __name__ == "__main__":
    main()
