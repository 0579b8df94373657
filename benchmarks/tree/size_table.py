#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Growth of the native part's time with the size of a tree, as Markdown tables.

    PYTHONPATH=build/python python3 benchmarks/tree/size_table.py [--branches 2000,10000] [--corners 2000,10000]
        [--detail DRAFT]

The first table: seconds of Skeleton.from_branches, with one name for all branches, and of build_tree_mesh (defaults:
four-sided; or with a detail) for trees with that many branches:

    one limb   all on one trunk of 100 m with 101 joints, 2 mm thick
    crowded    the same, 2 cm thick: without room, so their bases are shortened and narrowed
    joints     one limb whose trunk has a joint for every second branch
    spread     on 100 limbs that leave the trunk

The second table: seconds of read_tree for a six-sided trunk and beside it a tube, or a leaf, of polygons with that many
corners: a leaf of one polygon; two polygons back to back; a tube closed by two polygons whose vertices are in random
order in the file.

If time grows in proportion to the size, all rows of a column have about the same microseconds per branch or corner.
Times are comparable on an idle machine only; its load is printed below the tables.
"""

import argparse
import math
import os
import random
import tempfile
import time

import numpy as np
import snowbough_native as native

SEED = 3


def limb(parent, level, points, radii):
    points, radii = np.asarray(points, np.float32), np.asarray(radii, np.float32)
    return {
        "name": "limb",
        "level": level,
        "parent": parent,
        "attach_point": points[0],
        "points": points,
        "radii": radii,
        "areas": np.pi * radii**2,
    }


def twig(parent, level, start, heading, length, radius):
    steps = np.linspace(0.0, 1.0, 4)[:, None]
    return limb(parent, level, start + length * steps * heading, np.linspace(radius, 0.1 * radius, 4))


def trunk(joints):
    height = np.linspace(0.0, 100.0, joints)
    return limb(
        -1, 0, np.column_stack([0.2 * np.sin(0.3 * height), 0 * height, height]), np.full(joints, 0.5)
    )


def along(points, share):
    """The point at that share of the joints."""
    at = share * (len(points) - 1)
    low = min(int(at), len(points) - 2)
    return points[low] + (at - low) * (points[low + 1] - points[low])


def one_limb(count, radius=0.002, joints=101):
    rng = random.Random(SEED)
    branches = [trunk(joints)]
    for i in range(count - 1):
        angle = rng.uniform(0.0, 2.0 * math.pi)
        start = along(branches[0]["points"], (i + 0.5) / count)
        branches.append(twig(0, 1, start, np.array([math.cos(angle), math.sin(angle), 0.3]), 1.5, radius))
    return branches


def spread(count, limbs=100):
    rng = random.Random(SEED)
    branches = [trunk(101)]
    for i in range(limbs):
        angle = 2.4 * i
        heading = np.array([math.cos(angle), math.sin(angle), 0.3])
        start = along(branches[0]["points"], (i + 0.5) / limbs)
        steps = np.linspace(0.0, 30.0, 31)[:, None]
        branches.append(limb(0, 1, start + steps * heading, np.linspace(0.1, 0.02, 31)))
    for i in range(count - len(branches)):
        parent = 1 + i % limbs
        angle = rng.uniform(0.0, 2.0 * math.pi)
        start = along(branches[parent]["points"], 0.05 + 0.95 * rng.random())
        heading = np.array([0.2 * math.cos(angle), 0.2 * math.sin(angle), 1.0 if i % 2 else -1.0])
        branches.append(twig(parent, 2, start, heading, 0.6, 0.002))
    return branches


TREES = {
    "one limb": one_limb,
    "crowded": lambda count: one_limb(count, radius=0.02),
    "joints": lambda count: one_limb(count, joints=count // 2),
    "spread": spread,
}


def circle(count, radius, centre, height):
    angles = [2.0 * math.pi * k / count for k in range(count)]
    return [(centre + radius * math.cos(a), height, radius * math.sin(a)) for a in angles]


def tube(first, count, rings):
    """Quads between rings of `count` vertices from vertex number `first` on."""
    for ring in range(rings - 1):
        for k in range(count):
            low = first + ring * count
            after = (k + 1) % count
            yield (low + k, low + after, low + count + after, low + count + k)


def write_tree(path, points, faces):
    """Writes the points and faces beside a six-sided trunk."""
    stem = [p for height in range(6) for p in circle(6, 0.3, 0.0, height)]
    with open(path, "w", encoding="ascii") as file:
        file.writelines("v {:.7g} {:.7g} {:.7g}\n".format(*p) for p in stem + points)
        for face in [*tube(0, 6, 6), *([v + len(stem) for v in face] for face in faces)]:
            file.write("f " + " ".join(str(v + 1) for v in face) + "\n")


def leaf(corners):
    return circle(corners, 0.1, 2.0, 3.0), [range(corners)]


def back_to_back(corners):
    return circle(corners, 0.1, 2.0, 3.0), [range(corners), range(corners - 1, -1, -1)]


def shuffled_tube(corners):
    points = [p for height in range(3) for p in circle(corners, 0.3, 5.0, height)]
    faces = [*tube(0, corners, 3), range(corners - 1, -1, -1), range(2 * corners, 3 * corners)]
    order = list(range(len(points)))
    random.Random(SEED).shuffle(order)
    place = {old: new for new, old in enumerate(order)}
    return [points[old] for old in order], [[place[v] for v in face] for face in faces]


POLYGONS = {"leaf": leaf, "back to back": back_to_back, "tube": shuffled_tube}


def seconds(call):
    start = time.perf_counter()
    result = call()
    return time.perf_counter() - start, result


def cell(taken, count):
    return f"{taken:.2f} ({1e6 * taken / count:.0f})"


def row(cells):
    print("| " + " | ".join(str(c) for c in cells) + " |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--branches", default="2000,10000,50000")
    parser.add_argument("--corners", default="2000,10000,50000")
    details = ("BASE", "DRAFT", "GAME", "DEFAULT", "FILM")
    parser.add_argument("--detail", choices=details, default="BASE", help="BASE: four sides")
    options = parser.parse_args()

    row(["branches", "from_branches s (µs each)", *(f"{name} s (µs each)" for name in TREES)])
    row(["---"] * (len(TREES) + 2))
    for count in map(int, options.branches.split(",")):
        cells = []
        for make in TREES.values():
            branches = make(count)
            named, skeleton = seconds(lambda branches=branches: native.Skeleton.from_branches(branches))
            if not cells:
                cells.append(cell(named, count))
            built, _ = seconds(
                lambda skeleton=skeleton: native.build_tree_mesh(skeleton, detail=options.detail)
            )
            cells.append(cell(built, count))
        row([count, *cells])
    print()
    row(["corners", *(f"{name} s (µs each)" for name in POLYGONS)])
    row(["---"] * (len(POLYGONS) + 1))
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "polygons.obj")
        for count in map(int, options.corners.split(",")):
            cells = []
            for make in POLYGONS.values():
                write_tree(path, *make(count))
                cells.append(cell(seconds(lambda: native.read_tree(path))[0], count))
            row([count, *cells])
    print(f"\nload of the machine: {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores; seed {SEED}")


if __name__ == "__main__":
    main()
