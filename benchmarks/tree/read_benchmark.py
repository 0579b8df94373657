"""Trees from OBJ: our whole native part against Blender's own OBJ importer, on the same files in one run.

    PYTHONPATH=build/python python3 benchmarks/tree/read_benchmark.py [FILE.obj ...] [--megabytes 50]
        [--repeats 3] [--blender blender] [--large]

Prints a table: size of the file; seconds of read_tree, and of build_tree_mesh with the leaves' charts beside it
(surface, weights, UV maps, as the import operator calls them; best of the repeats); seconds of Blender's importer in
C++ (wm.obj_import of 3.2 on, not import_scene.obj in Python), which only reads (operator only, best of the repeats,
factory settings); read_tree and the whole divided by it, the whole also by processor time, summed over threads, which
is comparable on a busy machine; and read_tree's peak memory divided by the file's size. Our runs and Blender's take
turns. Without files, a tree of tubes of about the given size is generated. --large also reads a generated file of one
gigabyte once, without Blender and without the mesh.
"""

import argparse
import json
import math
import os
import random
import subprocess
import sys
import tempfile

TURNS = 2  # times that ours and Blender's importer take turns

READ = """
import json, sys, time
from concurrent.futures import ThreadPoolExecutor
import snowbough_native

def high_water():
    with open("/proc/self/status") as status:
        return next(int(line.split()[1]) for line in status if line.startswith("VmHWM"))

before = high_water()
times, mesh_times, processor = [], [], []
for _ in range(int(sys.argv[2])):
    start, used = time.perf_counter(), time.process_time()
    skeleton = snowbough_native.read_tree(sys.argv[1], simplify="TOLERANCE")
    read = time.perf_counter()
    times.append(read - start)
    if len(times) == 1:
        peak = high_water()
    if sys.argv[3] == "mesh":
        with ThreadPoolExecutor(1) as worker:
            leaves = worker.submit(snowbough_native.layout_leaf_uvs, skeleton, 1024)
            mesh = snowbough_native.build_tree_mesh(skeleton)
            if len(skeleton.foliage.vertices):
                snowbough_native.leaf_bones(skeleton, mesh)
            leaves.result()
        mesh_times.append(time.perf_counter() - read)
        processor.append(time.process_time() - used)
print(json.dumps({"seconds": min(times), "mesh": min(mesh_times, default=None),
                  "processor": min(processor, default=None), "peak": (peak - before) * 1024,
                  "branches": sum(skeleton.report["branches_per_level"]), "form": skeleton.report["form"]}))
"""

BLENDER = """
import bpy, json, sys, time
path, repeats = sys.argv[sys.argv.index("--") + 1:]
times, processor = [], []
for _ in range(int(repeats)):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    start, used = time.perf_counter(), time.process_time()
    bpy.ops.wm.obj_import(filepath=path)
    times.append(time.perf_counter() - start)
    processor.append(time.process_time() - used)
print("RESULT " + json.dumps({"seconds": min(times), "processor": min(processor)}))
"""


def write_tree(path, megabytes, seed=1):
    """Writes a merged tree of six-sided quad tubes, Y up, until the file has the requested size."""
    rng = random.Random(seed)
    limit = megabytes * 1e6
    with open(path, "w", encoding="ascii") as file:
        written = 0
        first = 1
        spine = [(0.0, 0.1 * i, 0.0) for i in range(101)]
        lines = [(spine, 0.3)]
        while written < limit:
            line, radius = lines.pop(0)
            text = []
            for i, (x, y, z) in enumerate(line):
                r = radius * (1.0 - i / len(line))
                for side in range(6):
                    angle = side * math.pi / 3
                    u, v = side / 6, i / len(line)
                    text.append(
                        f"v {x + r * math.cos(angle):.6f} {y:.6f} {z + r * math.sin(angle):.6f}\n"
                        f"vt {u:.6f} {v:.6f}\n"
                    )
            for i in range(len(line) - 1):
                for side in range(6):
                    a = first + i * 6 + side
                    b = first + i * 6 + (side + 1) % 6
                    text.append(f"f {a}/{a} {b}/{b} {b + 6}/{b + 6} {a + 6}/{a + 6}\n")
            first += 6 * len(line)
            text = "".join(text)
            written += len(text)
            file.write(text)
            for _ in range(4):
                x, y, z = rng.choice(line[5:])
                dx, dy, dz = (rng.uniform(-1, 1) for _ in range(3))
                step = 0.6 * 0.1
                lines.append(
                    (
                        [
                            (x + step * i * dx, y + step * i * abs(dy), z + step * i * dz)
                            for i in range(rng.randint(20, 80))
                        ],
                        radius * rng.uniform(0.3, 0.7),
                    )
                )


def read_native(path, repeats, mesh=True):
    run = subprocess.run(
        [sys.executable, "-c", READ, path, str(repeats), "mesh" if mesh else ""],
        check=True,
        text=True,
        capture_output=True,
    )
    return json.loads(run.stdout)


def read_blender(blender, path, repeats):
    run = subprocess.run(
        [
            blender,
            "-b",
            "--factory-startup",
            "--python-exit-code",
            "1",
            "--python-expr",
            BLENDER,
            "--",
            path,
            str(repeats),
        ],
        check=True,
        text=True,
        capture_output=True,
    )
    return json.loads(next(line for line in run.stdout.splitlines() if line.startswith("RESULT "))[7:])


def best(runs):
    """The smallest figures of the runs; figures other than times are the same in all runs."""
    first = runs[0]
    return {
        key: min(run[key] for run in runs) if isinstance(first[key], float) else first[key] for key in first
    }


def print_row(path, native, blender):
    size = os.path.getsize(path)
    read, mesh = native["seconds"], native["mesh"]
    seconds = blender and blender["seconds"]

    def cell(value, width, digits):
        return f"{'-':>{width}}" if value is None else f"{value:{width}.{digits}f}"

    print(
        f"{os.path.basename(path)[:28]:28} {size / 1e6:6.1f} {native['branches']:8} {native['form'][:15]:15} "
        f"{cell(read, 7, 3)} {cell(mesh, 7, 3)} {cell(seconds, 9, 3)} "
        f"{cell(seconds and read / seconds, 6, 2)} {cell(seconds and (read + mesh) / seconds, 6, 2)} "
        f"{cell(blender and native['processor'] / blender['processor'], 6, 2)} "
        f"{native['peak'] / size:9.1f}",
        flush=True,
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("files", nargs="*")
    parser.add_argument("--megabytes", type=float, default=50)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--blender", default="blender")
    parser.add_argument("--large", action="store_true", help="also read a generated file of a gigabyte")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        files = arguments.files
        if not files:
            files = [os.path.join(folder, "generated.obj")]
            write_tree(files[0], arguments.megabytes)
        print(
            f"{'file':28} {'MB':>6} {'branches':>8} {'form':15} {'read s':>7} {'mesh s':>7} {'Blender s':>9} "
            f"{'read/B':>6} {'all/B':>6} {'cpu/B':>6} {'peak/file':>9}"
        )
        for path in files:
            runs = [
                (
                    read_native(path, arguments.repeats),
                    read_blender(arguments.blender, path, arguments.repeats),
                )
                for _turn in range(TURNS)
            ]
            print_row(path, *map(best, zip(*runs)))
        if arguments.large:
            path = os.path.join(folder, "large.obj")
            write_tree(path, 1000)
            print_row(path, read_native(path, 1, mesh=False), None)


if __name__ == "__main__":
    main()
