"""Time to draw a forest: a few grown trees in many places.

    PYTHONPATH=build/python /usr/bin/python3 benchmarks/realtime/forest.py [--trees 1000] [--apart 64] [--size 1280 720]

Prints markdown tables for the current driver: triangles, calls to OpenGL, times and memory of a frame by the number of
trees. `instances`: each of the four grown trees is added once and stands in many places. `own bases`: each tree is
added with a base of its own, up to `--apart` trees. Each frame is drawn from another place and draws its shadow map.

`submit ms` is the time in which the processor passes on the calls of a frame; a software renderer draws within it.
`processor ms` is the sum over threads, and is comparable on a busy machine. `buffers MiB` is the memory of all buffers
on the GPU, without textures.
"""

import argparse
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import snowbough_native as native

ROOT = Path(__file__).resolve().parents[2]
SPECIES = (("maple", 1), ("maple", 2), ("spruce", 1), ("spruce", 2))
#: Metres between neighbours.
SPACING = 5.0
#: Views of the forest: metres of the eye from its edge (negative: within it) and above the ground.
VIEWS = {"from above": (25.0, 30.0), "from within": (-12.0, 1.7)}
SEED = 1


def grown(levels):
    """Bases of the four trees."""
    meshes = []
    with tempfile.TemporaryDirectory(prefix="snowbough-forest-") as folder:
        for species, seed in SPECIES:
            path = Path(folder) / f"{species}{seed}.obj"
            script = ROOT / "blend_samples" / "grow_tree.py"
            options = ["--species", species, "--seed", str(seed), "--levels", str(levels)]
            subprocess.run([sys.executable, script, *options, path], check=True, stdout=subprocess.DEVNULL)
            meshes.append(native.build_tree_mesh(native.read_tree(path)))
    return meshes


def places(count):
    """(N, 4, 4) float32: a square of trees that are turned and of different sizes."""
    random = np.random.default_rng(SEED)
    side = int(np.ceil(np.sqrt(count)))
    number = np.arange(count)
    at = SPACING * (np.stack([number % side, number // side], axis=1) - 0.5 * (side - 1))
    at += random.uniform(-0.3 * SPACING, 0.3 * SPACING, at.shape)
    turn, size = random.uniform(0, 2 * np.pi, count), random.uniform(0.8, 1.2, count)
    matrices = np.tile(np.eye(4), (count, 1, 1))
    matrices[:, 0, 0] = matrices[:, 1, 1] = size * np.cos(turn)
    matrices[:, 1, 0], matrices[:, 0, 1] = size * np.sin(turn), -size * np.sin(turn)
    matrices[:, 2, 2] = size
    matrices[:, :2, 3] = at
    return matrices.astype(np.float32)


def plant(renderer, meshes, count, apart):
    """Adds the trees. apart: each with a base of its own."""
    matrices = places(count)
    for kind, mesh in enumerate(meshes[:count]):
        own = matrices[kind :: len(meshes)]
        if not apart:
            renderer.add_tree(f"tree {kind}", mesh)
            renderer.set_instances(f"tree {kind}", own)
            continue
        bones = len(mesh.bone_heads)
        for number, matrix in enumerate(own):
            renderer.add_tree(f"tree {kind} {number}", mesh)
            renderer.set_pose(f"tree {kind} {number}", np.tile(matrix, (bones, 1, 1)))


def camera_at(view, count, frame, size):
    """A camera that moves by 0.2 m a frame."""
    beyond, height = VIEWS[view]
    edge = 0.5 * SPACING * np.sqrt(count)
    eye = (0.2 * frame, -edge - beyond, height)
    return native.Camera(
        eye=eye, target=(0.2 * frame, 0, 2), width=size[0], height=size[1], field_of_view=0.8
    )


def measured(renderer, view, count, arguments):
    """The statistics of a frame, with medians over frames, the first of which compiles shaders and does not count."""
    found = []
    for frame in range(arguments.frames + 1):
        began = time.process_time()
        renderer.render(camera_at(view, count, frame, arguments.size))
        taken = time.process_time() - began
        one = renderer.statistics()
        submitted = sum(each["wall_seconds"] for each in one["passes"].values())
        found.append({**one, "processor_seconds": taken, "submit_seconds": submitted})
    keys = ("submit_seconds", "gpu_seconds", "wall_seconds", "processor_seconds")
    return {**found[-1], **{key: statistics.median(one[key] for one in found[1:]) for key in keys}}


def row(*cells):
    print("| " + " | ".join(str(cell) for cell in cells) + " |", flush=True)


def table(view, meshes, arguments):
    """Prints a row for each way and number of trees."""
    counts = {count for count in (1, 10, 100, arguments.apart) if 0 < count < arguments.trees}
    ways = {"instances": {*counts, arguments.trees}, "own bases": {arguments.apart} - {0}}
    heads = ("way", "trees", "patches", "triangles", "dispatches", "draws", "submit ms", "GPU ms", "wall ms")
    row(*heads, "processor ms", "buffers MiB")
    row(*["---"] * (len(heads) + 2))
    for way, its_counts in ways.items():
        for count in sorted(its_counts):
            with native.Renderer() as renderer:
                plant(renderer, meshes, count, way == "own bases")
                one = measured(renderer, view, count, arguments)
            keys = ("submit_seconds", "gpu_seconds", "wall_seconds", "processor_seconds")
            times = [f"{1e3 * one[key]:.2f}" for key in keys]
            patches = one["dropped"] + one["plain"] + one["tessellated"]
            calls = (one["triangles"], one["dispatches"], one["draws"])
            row(way, count, patches, *calls, *times, f"{one['buffer_bytes'] / 2**20:.1f}")
    print()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--trees", type=int, default=1000)
    parser.add_argument("--apart", type=int, default=64, help="0: none")
    parser.add_argument("--size", nargs=2, type=int, default=(1280, 720), metavar=("WIDTH", "HEIGHT"))
    parser.add_argument("--frames", type=int, default=8)
    parser.add_argument("--levels", type=int, default=4, choices=(1, 2, 3, 4), help="levels of branches")
    arguments = parser.parse_args()
    meshes = grown(arguments.levels)
    with native.Renderer() as renderer:
        driver = renderer.driver
    print(f"{len(meshes)} trees of {', '.join(str(len(mesh.quads)) for mesh in meshes)} patches; ", end="")
    print(f"{arguments.size[0]} x {arguments.size[1]}, {arguments.frames} frames; {driver}\n")
    for view in VIEWS:
        print(f"The forest seen {view}:\n")
        table(view, meshes, arguments)


if __name__ == "__main__":
    main()
