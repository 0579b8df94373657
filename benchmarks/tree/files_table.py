#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Every tree of ../shared/data/trees through the native part, as one Markdown table.

    PYTHONPATH=build/python python3 benchmarks/tree/files_table.py [FOLDER] [--repeats 3] [--blender blender]

One row per file: the form found; branches; correct parents, if a .json of the same name or the sibling of the same tree
has them; the mesh's vertices, components, Euler characteristic of each and whether it is closed; junctions with faces
that cross each other; share of the snow map that the charts fill at 1024; seconds of read_tree and of build_tree_mesh
(surface, weights, both UV maps; best of the repeats) and of Blender's own OBJ importer on the same file, which only
reads (operator only, best of the repeats). All joints are kept (simplify NONE). Times are comparable on an idle machine
only; its load is printed below the table.
"""

import argparse
import json
import os
import pathlib
import time

import numpy as np
import snowbough_native as native
from read_benchmark import read_blender

FOLDER = pathlib.Path(__file__).resolve().parents[2] / ".." / "shared" / "data" / "trees"
RESOLUTION = 1024
COLUMNS = [
    "file",
    "form",
    "branches",
    "parents right",
    "vertices",
    "components",
    "Euler",
    "closed",
    "crossing / junctions",
    "snow UV fill",
    "read s",
    "mesh s",
    "native s",
    "Blender's OBJ s",
]


def true_parents(path, skeleton):
    """(correct, all) of the branches whose parent the .json beside the file has, or None without one."""
    truth = path.with_suffix(".json")
    if not truth.is_file():
        return None
    found = {branch.name: branch for branch in skeleton.branches}
    branches = json.loads(truth.read_text())["branches"]
    right = 0
    for branch in branches:
        mine = found.get(branch["name"])
        if mine is not None:
            parent = skeleton.branches[mine.parent].name if mine.parent >= 0 else None
            right += parent == branch["parent"]
    return right, len(branches)


def sibling_parents(path, skeleton, folder):
    """The same for the tubes of a tree whose squares have a .json: branches are paired by root and tip.

    AL06a has 196 of 199: the other three are twigs that start at a joint of a limb without thickness, which
    is the parent found; the .json, made by distance in radii, puts them on the trunk 20 to 59 mm away.
    """
    for truth in sorted((folder / "squares").glob("*.json")):
        if not path.name.startswith(truth.name.split("_")[0]) or path.parent.name != "tubes":
            continue
        branches = json.loads(truth.read_text())["branches"]
        points = [np.asarray(branch["points"]) for branch in branches]
        # The reference is Y up.
        ends = np.array([np.concatenate((p[0], p[-1])) for p in points])
        ends = ends[:, [0, 2, 1, 3, 5, 4]] * (1, -1, 1, 1, -1, 1)
        mine = np.array([np.concatenate((b.points[0], b.points[-1])) for b in skeleton.branches])
        pair = [int(np.abs(ends - row).max(axis=1).argmin()) for row in mine]
        close = [np.abs(ends[p] - row).max() < 1e-3 * skeleton.height for p, row in zip(pair, mine)]
        right = 0
        for number, branch in enumerate(skeleton.branches):
            parent = branches[pair[branch.parent]]["name"] if branch.parent >= 0 else None
            right += close[number] and parent == branches[pair[number]]["parent"]
        return right, len(branches)
    return None


def fill(mesh):
    """Share of the snow map inside the charts, measured on the faces' UV polygons."""
    uv = np.asarray(mesh.uv_snow, float)
    d1, d2 = uv[:, 2] - uv[:, 0], uv[:, 3] - uv[:, 1]
    return float(0.5 * np.abs(d1[:, 0] * d2[:, 1] - d1[:, 1] * d2[:, 0]).sum())


def best_times(path, repeats):
    """Best seconds of reading and of building, and what was built."""
    read, build = [], []
    for _ in range(repeats):
        start = time.perf_counter()
        skeleton = native.read_tree(str(path))
        middle = time.perf_counter()
        mesh = native.build_tree_mesh(skeleton, snow_resolution=RESOLUTION)
        build.append(time.perf_counter() - middle)
        read.append(middle - start)
    return min(read), min(build), skeleton, mesh


def row(path, folder, repeats, blender):
    read, build, skeleton, mesh = best_times(path, repeats)
    parents = true_parents(path, skeleton) or sibling_parents(path, skeleton, folder)
    check = native.check_mesh(mesh.vertices, mesh.quads)
    euler = sorted(set(int(value) for value in check["euler"]))
    return [
        path.relative_to(folder),
        skeleton.report["form"],
        len(skeleton.branches),
        f"{parents[0]} of {parents[1]}" if parents else "not known",
        len(mesh.vertices),
        check["components"],
        " ".join(map(str, euler)),
        "yes" if check["boundary_edges"] == 0 else "no",
        f"{mesh.report['crossing_junctions']} / {mesh.report['junctions']}",
        f"{fill(mesh):.2f}",
        f"{read:.3f}",
        f"{build:.3f}",
        f"{read + build:.3f}",
        f"{read_blender(blender, str(path), repeats)['seconds']:.3f}" if blender else "-",
    ]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("folder", nargs="?", type=pathlib.Path, default=FOLDER)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--blender", default="blender", help="'' leaves Blender out")
    arguments = parser.parse_args()
    folder = arguments.folder.resolve()
    files = sorted(folder.glob("*/*.obj")) or sorted(folder.glob("*.obj"))
    if not files:
        parser.error(f"no .obj files in {folder} or its folders")
    print("| " + " | ".join(COLUMNS) + " |")
    print("|" + " --- |" * len(COLUMNS))
    before = os.getloadavg()[0]
    for path in files:
        cells = row(path, folder, arguments.repeats, arguments.blender)
        print("| " + " | ".join(map(str, cells)) + " |", flush=True)
    print(
        f"\nLoad of the machine: {before:.1f} before, {os.getloadavg()[0]:.1f} after; "
        f"{os.cpu_count()} cores. Best of {arguments.repeats}."
    )


if __name__ == "__main__":
    main()
