#!/usr/bin/env python3
"""Calls the native module with valid, damaged and wrong arguments, in child processes.

    PYTHONPATH=build/python python3 tests/fuzz/fuzz_module.py [--seconds 60] [--seed N] [--calls 200]

Each child makes some random calls, from a seed of its own, and names each call before making it. A child that crashes,
hangs, or gets an error other than those that the module documents ends the run with the seed and the call. To repeat
it: --seed N --seconds 0. The real-time renderer is left out, since it would test the driver.
"""

import argparse
import os
import random
import resource
import subprocess
import sys
import tempfile
import time
import warnings
from pathlib import Path

import numpy as np
import snowbough_native as native

# KeyError: a dict lacks a key. TypeError: pybind11 finds no function for the types.
DOCUMENTED = (ValueError, RuntimeError, TypeError, KeyError, OverflowError, MemoryError)
TREE = Path(__file__).resolve().parents[1] / "data" / "small_maple.obj"
SECONDS_A_CHILD = 120  # of processor time; on a busy machine the clock may go on for ten times as long
MEMORY = 4 << 30

TRIANGLES = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
UV = np.array([[[0, 0], [1, 0], [1, 1]], [[0, 0], [1, 1], [0, 1]]], np.float32)
POINTS = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], np.float32)
HEIGHT = np.full((64, 64), 0.1, np.float32)
NUMBERS = [
    0,
    -1,
    1,
    2,
    63,
    2**31 - 1,
    -(2**31),
    2**32,
    2**63,
    1e-30,
    1e30,
    float("nan"),
    float("inf"),
    -0.5,
    True,
]
TEXTS = ["", "ground", "roof", "\0", "x" * 5000, "\udcff", "/", "/nowhere/at/all", "é", "CPU", "BOTH"]


def any_array(pick):
    """An array of any small shape and type."""
    shape = tuple(pick.choice([0, 1, 2, 3, 4, 64]) for _ in range(pick.randrange(4)))
    kind = pick.choice([np.float32, np.float64, np.int32, np.int64, np.uint8, np.uint16, bool])
    return np.full(shape, pick.choice([0, 1, 2, 3]), kind)


def any_value(pick):
    makers = [
        lambda: pick.choice(NUMBERS),
        lambda: pick.choice(TEXTS),
        lambda: any_array(pick),
        lambda: None,
        lambda: {},
        lambda: [pick.choice(NUMBERS) for _ in range(pick.randrange(5))],
    ]
    return pick.choice(makers)()


def damaged(pick, value):
    """The value with a change inside, of the same type if possible."""
    if isinstance(value, np.ndarray) and value.size and pick.random() < 0.8:
        value = np.array(value)
        at = pick.randrange(value.size)
        number = pick.choice(NUMBERS)
        if value.dtype.kind == "f":
            value.reshape(-1)[at] = np.float64(number)
        elif np.isfinite(number):
            value.reshape(-1)[at] = np.array(int(number) % 2**63).astype(value.dtype)
        return value if pick.random() < 0.8 else value.reshape(-1)[: pick.randrange(value.size)]
    if isinstance(value, dict) and value and pick.random() < 0.8:
        key = pick.choice(list(value))
        other = {name: own for name, own in value.items() if name != key}
        return other if pick.random() < 0.3 else {**other, key: damaged(pick, value[key])}
    return any_value(pick)


class Calls:
    """The objects of a child, and the calls that it may make: {name: (function, valid arguments)}."""

    def __init__(self, folder):
        self.folder = folder
        self.skeleton = native.read_tree(str(TREE), simplify="TOLERANCE")
        self.mesh = native.build_tree_mesh(self.skeleton, snow_resolution=256)
        self.renew()

    def renew(self):
        self.simulation = native.SnowSimulation(engine="CPU", pixel_size=0.05)
        self.simulation.add_object("ground", TRIANGLES, UV, resolution=64)
        self.simulation.step({"ground": POINTS}, depth=0.01)
        self.snapshot = self.simulation.snapshot("ground")
        self.surface = native.SnowSurface(TRIANGLES, UV, POINTS, HEIGHT, HEIGHT, 0.1, most_points=500)

    def all(self):
        sim, n = self.simulation, native
        mesh = {"triangles": TRIANGLES, "uv": UV}
        small = {"resolution": 64, "receive": True, "occlude": True, "rest": POINTS, "blur_radius": 0.01,
                 "shading": TRIANGLES, "sides": "AUTO"}  # fmt: skip
        alpha = {"uv": UV, "image": np.array([0, -1], np.int32), "images": [HEIGHT], "extensions": ["REPEAT"]}
        settings = {"noise_density": 1.0, "flutter": 0.0, "max_depth": 1.0, "slide_half_life": 2.0, "repose": 1.0,
                    "cohesion": 0.0, "seed": 0}  # fmt: skip
        state = n.simulation_state(sim)
        path = str(self.folder / "file")
        exr = {"path": path, "pixels": HEIGHT, "half": False, "attributes": {"a": "b"}}
        quads = {"vertices": POINTS, "quads": np.array([[0, 1, 2, 3]], np.int32)}
        limb = {"name": "a", "level": 0, "parent": -1, "attach_point": POINTS[0], "points": POINTS[:, [2, 0, 1]],
                "radii": np.ones(4, np.float32), "areas": np.ones(4, np.float32)}  # fmt: skip
        return {
            "SnowSimulation": (n.SnowSimulation, {**settings, "pixel_size": 0.05, "engine": "CPU", "tile_size": 64}),
            "add_object": (sim.add_object, {"name": "roof", **mesh, **small}),
            "add_object alpha": (sim.add_object, {"name": "leaf", **mesh, **small, "alpha": alpha}),
            "replace_object": (sim.replace_object, {"name": "ground", **mesh, **small}),
            "step": (sim.step, {"positions": {"ground": POINTS, "roof": POINTS}, "depth": 0.01,
                                "direction": [0.0, 0.0, -1.0], "dt": 0.04}),
            "step ground": (sim.step, {"positions": {"ground": POINTS}, "depth": 0.01}),
            "change_settings": (sim.change_settings, settings),
            "output": (sim.output, {"name": "ground", "normal": True}),
            "height": (sim.height, {"name": "ground"}),
            "texel_area": (sim.texel_area, {"name": "ground"}),
            "snapshot": (sim.snapshot, {"name": "ground"}),
            "prepare_output": (sim.prepare_output, {"name": "ground"}),
            "set_blur_radius": (sim.set_blur_radius, {"name": "ground", "blur_radius": 0.02}),
            "statistics": (sim.statistics, {}),
            "pass_hashes": (sim.pass_hashes, {}),
            "hash_passes": (sim.hash_passes, {"on": True}),
            "memory_estimate": (sim.memory_estimate, {}),
            "close": (sim.close, {}),
            "set_simulation_state": (n.set_simulation_state, {"simulation": sim, "state": state}),
            "write_checkpoint": (n.write_checkpoint, {"path": path, "state": state, "description": "x"}),
            "read_checkpoint": (n.read_checkpoint, {"path": path, "receivers": {"ground": 64}}),
            "snapshot.output": (self.snapshot.output, {}),
            "texel_table": (n.texel_table, {**mesh, "resolution": 64}),
            "point_normals": (n.point_normals, {"points": POINTS, "triangles": TRIANGLES}),
            "wanted_surface_points": (n.wanted_surface_points, {"triangles": TRIANGLES, "positions": POINTS,
                                                                "depth": 0.1, "shading": TRIANGLES}),
            "SnowSurface": (n.SnowSurface, {**mesh, "positions": POINTS, "last": HEIGHT, "highest": HEIGHT,
                                            "depth": 0.1, "shading": TRIANGLES, "scale": 4.0, "most_points": 500,
                                            "wind": [0.1, 0.0]}),
            "surface.points": (self.surface.points, {"height": HEIGHT, "open_depth": 0.1, "positions": POINTS,
                                                     "up": [0.0, 0.0, 1.0], "to_result": np.eye(4)}),
            "surface.set_style": (self.surface.set_style, {"overhang": 1.0, "relief": 1.0}),
            "write_exr": (n.write_exr, exr),
            "read_exr": (n.read_exr, {"path": path}),
            "encode_png": (n.encode_png, {"pixels": (HEIGHT * 255).astype(np.uint8)}),
            "check_mesh": (n.check_mesh, quads),
            "from_branches": (n.Skeleton.from_branches, {"branches": [limb]}),
            "read_tree": (n.read_tree, {"path": str(TREE), "tolerance": 0.5, "levels": "", "height": 0.0,
                                        "unit": 1.0}),
            "build_tree_mesh": (n.build_tree_mesh, {"skeleton": self.skeleton, "detail": "BASE", "snow_resolution": 256,
                                                    "max_influences": 4}),
            "reduce_bones": (n.reduce_bones, {"mesh": self.mesh, "max_bones": 10, "max_bone_level": -1}),
            "layout_leaf_uvs": (n.layout_leaf_uvs, {"skeleton": self.skeleton, "resolution": 256}),
        }  # fmt: skip

    def make_one(self, pick):
        """Makes a random call and prints it before."""
        calls = self.all() if pick.random() < 0.9 else None
        if calls is None:
            kind = getattr(
                native, pick.choice([x for x in dir(native) if isinstance(getattr(native, x), type)])
            )
            name, function, given = f"{kind.__name__}.__new__", lambda: use_uninitialised(kind), {}
        else:
            name = pick.choice(list(calls))
            function, valid = calls[name]
            given = dict(valid)
            for _ in range(pick.choice([0, 1, 1, 1, 2, 3])):
                if given:
                    key = pick.choice(list(given))
                    given[key] = damaged(pick, given[key])
        print(name, {key: summary(value) for key, value in given.items()}, flush=True)
        try:
            function(**given)
        except DOCUMENTED:
            pass
        if name == "close":
            self.renew()


def use_uninitialised(kind):
    """Reads the attributes of an object whose __init__ did not run."""
    made = kind.__new__(kind)
    for name in dir(made):
        if not name.startswith("__"):
            try:
                value = getattr(made, name)
                if callable(value):
                    value()
            except DOCUMENTED:
                pass


def summary(value):
    text = repr(value).replace("\n", " ")
    return text if len(text) < 200 else text[:200] + "..."


def child(seed, calls):
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CPU, (SECONDS_A_CHILD, SECONDS_A_CHILD))
    warnings.simplefilter("ignore")
    pick = random.Random(seed)
    with tempfile.TemporaryDirectory(prefix="snowbough-fuzz-") as folder:
        os.chdir(folder)  # for paths such as "ground"
        of = Calls(Path(folder))
        for _ in range(calls):
            try:
                of.make_one(pick)
            except MemoryError:
                of.renew()


def run_child(seed, calls):
    """Returns the number of calls made, and an error or None."""
    command = [
        sys.executable,
        str(Path(__file__).resolve()),
        "--child",
        "--seed",
        str(seed),
        "--calls",
        str(calls),
    ]
    with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as errors:
        try:
            status = subprocess.run(
                command, stdout=out, stderr=errors, timeout=10 * SECONDS_A_CHILD
            ).returncode
        except subprocess.TimeoutExpired:
            status = "timeout"
        out.seek(0)
        errors.seek(0)
        made = out.read().splitlines()
        if status == 0:
            return len(made), None
        return len(made), f"seed {seed}: {status} in call {len(made)}: {made[-1:]}\n{errors.read()[-2000:]}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--seed", type=int)
    parser.add_argument("--calls", type=int, default=200)
    parser.add_argument("--child", action="store_true", help=argparse.SUPPRESS)
    given = parser.parse_args()
    seed = random.randrange(1 << 30) if given.seed is None else given.seed
    if given.child:
        return child(seed, given.calls)
    print("first seed", seed)
    end = time.monotonic() + given.seconds
    total = 0
    while True:
        made, error = run_child(seed, given.calls)
        total += made
        if error or time.monotonic() > end:
            print(f"stat::number_of_executed_units: {total}")
            print(error or "nothing found")
            return 1 if error else 0
        seed += 1


if __name__ == "__main__":
    sys.exit(main())
