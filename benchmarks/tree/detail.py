#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Deviation of each level of detail from the trees it was made from, as one Markdown table.

    PYTHONPATH=build/python python3 benchmarks/tree/detail.py [FOLDER] [--repeats 3] [--details DRAFT,DEFAULT]

One row per tree of ../shared/data/trees (and the grown maple, unless a folder is given) and level. Columns:

- faces, and sides of the thickest ring;
- `tubes %`: distance of the export's tubes from the rebuilt surface in percent of the local radius, median and 95th
  percentile, over points spread evenly by area over the export's own faces where its rings have eight and more corners
  (`-`: it has none), outside of forks;
- `limbs %`: the same distance for round limbs with the export's centrelines and areas, which every tree has;
- `turn`: the largest angle in degrees between the normals of two successive faces along a limb, and its 99.9th
  percentile, outside of forks and not beside caps;
- `crossings`: pairs of limbs whose faces cross, or one limb's own, of the four-sided base and of the level. The
  export's own crossings are those between two limbs that do not leave each other, whose round tubes along the export's
  centrelines intersect (radii at least 2e-5 of the height, the thinnest that we make); all others are made here
  (wanted: 0);
- `UV`: texels of the snow map that two charts share plus faces without positive area (wanted: 0), and the ratio of its
  p95 to p5 of texels per m2 (wanted: below 2);
- `closed`: one component per root, closed, of Euler characteristic 2, consistently wound, weights of sum 1, no face
  without area;
- processor seconds of build_tree_mesh on one thread, best of the repeats, and those of the four-sided base.

A place is at a fork if a child's and its parent's surfaces are both nearer than twice the radius of the thinner one
where they meet: the fillet between them is half as wide. All joints are kept (simplify NONE).
"""

import argparse
import os
import pathlib
import subprocess
import sys
import tempfile
import time

import numpy as np
import snowbough_native as native
import snowbough_testing as testing

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDER = ROOT / ".." / "shared" / "data" / "trees"
DETAILS = ("DRAFT", "GAME", "DEFAULT", "FILM")
SAMPLES = 20000
# Least radius that the surface has anywhere, as a share of the tree's height.
THINNEST = 2e-5
COLUMNS = [
    "tree",
    "detail",
    "faces",
    "sides",
    "tubes % p50 / p95",
    "limbs % p50 / p95",
    "turn max / p99.9",
    "crossings base: export's, ours",
    "crossings level: export's, ours",
    "UV overlap / density",
    "closed",
    "base s",
    "s",
]


class Segments:
    """Segments of all limbs with their radii, and a search for the nearest ones."""

    def __init__(self, branches):
        begin, end, low, high, owner = [], [], [], [], []
        for number, limb in enumerate(branches):
            points = np.asarray(limb.points, float)
            radii = np.sqrt(np.asarray(limb.areas, float) / np.pi)
            begin.append(points[:-1])
            end.append(points[1:])
            low.append(radii[:-1])
            high.append(radii[1:])
            owner.append(np.full(len(points) - 1, number))
        self.begin, self.end = np.concatenate(begin), np.concatenate(end)
        self.low, self.high = np.concatenate(low), np.concatenate(high)
        self.owner = np.concatenate(owner)

    def along(self, points, rows):
        """(distance, radius) of points from segments, one each."""
        step = self.end[rows] - self.begin[rows]
        square = np.maximum((step**2).sum(-1), 1e-30)
        t = np.clip(((points - self.begin[rows]) * step).sum(-1) / square, 0, 1)
        distance = np.linalg.norm(points - self.begin[rows] - step * t[..., None], axis=-1)
        return distance, self.low[rows] * (1 - t) + self.high[rows] * t


def triangle_distances(points, corners, cells=64):
    """Distance of each point from the nearest of the triangles (T, 3, 3), through a grid of their boxes."""
    low, high = corners.reshape(-1, 3).min(0), corners.reshape(-1, 3).max(0)
    size = max((high - low).max() / cells, 1e-9)
    first = np.floor((corners.min(1) - low) / size).astype(int)
    last = np.floor((corners.max(1) - low) / size).astype(int)
    cell_of = {}
    for number, (a, b) in enumerate(zip(first.tolist(), last.tolist())):
        for x in range(a[0], b[0] + 1):
            for y in range(a[1], b[1] + 1):
                for z in range(a[2], b[2] + 1):
                    cell_of.setdefault((x, y, z), []).append(number)
    keys = np.floor((points - low) / size).astype(int)
    order = np.lexsort(keys.T)
    result = np.full(len(points), np.inf)
    begin = 0
    while begin < len(order):
        key = keys[order[begin]]
        end = begin
        while end < len(order) and (keys[order[end]] == key).all():
            end += 1
        rows = order[begin:end]
        near = set()
        for x in range(-1, 2):
            for y in range(-1, 2):
                for z in range(-1, 2):
                    near.update(cell_of.get((key[0] + x, key[1] + y, key[2] + z), ()))
        if near:
            result[rows] = nearest_triangle(points[rows], corners[sorted(near)])
        begin = end
    return result


def nearest_triangle(points, corners):
    """Distance of each of (P, 3) points from the nearest of (T, 3, 3) triangles."""
    best = np.full(len(points), np.inf)
    for begin in range(0, len(corners), 512):
        a, b, c = (corners[None, begin : begin + 512, k] for k in range(3))
        p = points[:, None]
        normal = np.cross(b - a, c - a)
        square = np.maximum((normal**2).sum(-1), 1e-300)
        height = ((p - a) * normal).sum(-1)
        inside = np.ones(height.shape, bool)
        distance = np.full(height.shape, np.inf)
        for q, r in ((a, b), (b, c), (c, a)):
            edge = r - q
            inside &= (np.cross(edge, p - q) * normal).sum(-1) >= 0
            t = np.clip(((p - q) * edge).sum(-1) / np.maximum((edge**2).sum(-1), 1e-300), 0, 1)
            distance = np.minimum(distance, np.linalg.norm(p - q - edge * t[..., None], axis=-1))
        distance = np.where(inside, np.minimum(np.abs(height) / np.sqrt(square), distance), distance)
        best = np.minimum(best, distance.min(1))
    return best


class Forks:
    """Places where limbs blend: both surfaces are nearer than twice the radius of the thinner limb."""

    def __init__(self, branches):
        self.rows = Segments(branches)
        self.of = [np.flatnonzero(self.rows.owner == number) for number in range(len(branches))]
        self.pairs = []
        for number, limb in enumerate(branches):
            if limb.parent < 0 or not len(self.of[number]) or not len(self.of[limb.parent]):
                continue
            at = np.asarray(limb.attach_point, float)
            parent = self.of[limb.parent]
            distance, radius = self.rows.along(at[None], parent)
            own = np.sqrt(np.asarray(limb.areas[:2], float).max() / np.pi)
            thinner = min(own, radius[distance.argmin()])
            self.pairs.append((number, limb.parent, at, max(thinner, 1e-9)))

    def outside(self, points):
        """Per point whether it lies in no fork."""
        free = np.ones(len(points), bool)
        order = np.argsort(points[:, 2])
        heights = points[order, 2]
        for child, parent, at, radius in self.pairs:
            # Beyond the parent's thickness and 25 radii, no two limbs touch.
            reach = 25 * radius + 2 * self.rows.low[self.of[parent]].max()
            near = order[slice(*np.searchsorted(heights, (at[2] - reach, at[2] + reach)))]
            near = near[free[near]]
            near = near[((points[near] - at) ** 2).sum(1) < reach * reach]
            for limb in (child, parent):
                near = near[self.nearest_surface(points[near], limb, at, reach) < 2 * radius]
            free[near] = False
        return free

    def nearest_surface(self, points, limb, at, reach):
        rows = self.of[limb]
        length = np.linalg.norm(self.rows.end[rows] - self.rows.begin[rows], axis=1)
        rows = rows[np.linalg.norm(self.rows.begin[rows] - at, axis=1) < 2 * reach + length]
        if not len(rows) or not len(points):
            return np.full(len(points), np.inf)
        distance, radius = self.rows.along(points[:, None], rows[None])
        return (distance - radius).min(1)


def round_limb_samples(branches, random, count):
    """Points on round limbs with the export's centrelines and areas, by area: (points, radii)."""
    rows = Segments(branches)
    step = rows.end - rows.begin
    length = np.linalg.norm(step, axis=1)
    area = length * (rows.low + rows.high)
    chosen = random.choice(len(area), count, p=area / area.sum())
    t = random.random(count)
    axis = step[chosen] / length[chosen, None]
    off = np.cross(axis, random.normal(size=(count, 3)))
    off /= np.linalg.norm(off, axis=1)[:, None]
    radius = rows.low[chosen] * (1 - t) + rows.high[chosen] * t
    return rows.begin[chosen] + step[chosen] * t[:, None] + off * radius[:, None], radius, rows.owner[chosen]


def not_inside_others(points, owners, branches, free):
    """Drops points inside a limb's parent: only the outside of a tree is rebuilt."""
    for number, limb in enumerate(branches):
        rows = np.flatnonzero(free & (owners == number))
        if limb.parent < 0 or not len(rows):
            continue
        parent = Segments([branches[limb.parent]])
        if not len(parent.owner):
            continue
        distance, radius = parent.along(points[rows][:, None], np.arange(len(parent.owner))[None])
        free[rows] &= (distance > radius).all(1)
    return free


def ring_corners(branches):
    """Per branch: corners of its rings, computed from area divided by radius squared; 0 if it has no rings."""
    corners = []
    k = np.arange(3, 40)
    share = k * np.sin(2 * np.pi / k) / (2 * np.pi)
    for limb in branches:
        radii, areas = np.asarray(limb.radii, float), np.asarray(limb.areas, float)
        thick = radii > 1e-3 * max(radii.max(), 1e-30)
        ratio = np.median(areas[thick] / (np.pi * radii[thick] ** 2)) if thick.any() else 0.0
        corners.append(int(k[np.abs(share - ratio).argmin()]) if ratio > 0 else 0)
    return np.array(corners)


def tube_samples(path, up_axis, branches, random, count):
    """Points on the export's own faces, by area, that belong to limbs with rings of eight and more corners:
    (points, radii, branches)."""
    wanted = np.flatnonzero(ring_corners(branches) >= 8)
    if not len(wanted):
        return None
    vertices, faces = [], []
    with open(path, errors="replace") as lines:
        for line in lines:
            word = line.split()
            if word[:1] == ["v"]:
                vertices.append([float(value) for value in word[1:4]])
            elif word[:1] == ["f"]:
                corner = [int(part.split("/")[0]) for part in word[1:]]
                corner = [number - 1 if number > 0 else len(vertices) + number for number in corner]
                faces += [[corner[0], corner[i], corner[i + 1]] for i in range(1, len(corner) - 1)]
    vertices = np.array(vertices)
    if up_axis == "Y":
        vertices = vertices[:, [0, 2, 1]] * (1, -1, 1)
    corners = vertices[np.array(faces)]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    chosen = corners[random.choice(len(area), 40 * count, p=area / area.sum())]
    a, b = random.random((2, len(chosen), 1))
    flip = a + b > 1
    a, b = np.where(flip, 1 - a, a), np.where(flip, 1 - b, b)
    points = chosen[:, 0] + a * (chosen[:, 1] - chosen[:, 0]) + b * (chosen[:, 2] - chosen[:, 0])
    rows = Segments([branches[number] for number in wanted])
    kept, radii, owners = [], [], []
    for begin in range(0, len(points), 4096):
        part = points[begin : begin + 4096]
        distance, radius = rows.along(part[:, None], np.arange(len(rows.owner))[None])
        # On the tube itself: as far from the middle line as the ring's corners or its sides are.
        off = np.abs(distance / np.maximum(radius, 1e-30) - 1)
        nearest = off.argmin(1)
        each = np.arange(len(part))
        on = off[each, nearest] < 0.12
        kept.append(part[on])
        radii.append(radius[each, nearest][on])
        owners.append(wanted[rows.owner[nearest[on]]])
    points, radii, owners = np.concatenate(kept), np.concatenate(radii), np.concatenate(owners)
    return points[:count], radii[:count], owners[:count]


def deviation(samples, branches, forks, mesh):
    """Median and 95th percentile, in percent of the local radius."""
    if samples is None:
        return "-"
    points, radii, owners = samples
    free = forks.outside(points) & (radii > 0)
    free = not_inside_others(points, owners, branches, free)
    if free.sum() < 100:
        return "-"
    quads = mesh.vertices.astype(float)[mesh.quads]
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    share = triangle_distances(points[free], triangles) / radii[free]
    # A point in an empty neighbourhood of the grid is further away than any limit.
    low, high = np.percentile(share, [50, 95])
    return f"{100 * low:.1f} / {100 * high:.1f}"


def turns(mesh, forks):
    """Largest and 99.9th percentile of turn_angles."""
    angle = turn_angles(mesh, forks)
    return f"{angle.max():.0f} / {np.percentile(angle, 99.9):.0f}" if len(angle) else "-"


def turn_angles(mesh, forks):
    """Degrees between the normals of successive faces along a limb, outside of forks."""
    quads, corners = mesh.quads, mesh.vertices.astype(float)[mesh.quads]
    normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
    wall = mesh.face_part == 0
    # The bark's u runs around a limb, its v along it. Edges where the sides change their number run aslant.
    nxt = np.roll(np.arange(4), -1)
    edge = np.abs(mesh.uv_bark - mesh.uv_bark[:, nxt])
    across = (edge[..., 1] < 0.5 * edge[..., 0]) & wall[:, None]
    a, b = quads, quads[:, nxt]
    key = np.minimum(a, b).astype(np.int64) * len(mesh.vertices) + np.maximum(a, b)
    face = np.repeat(np.arange(len(quads)), 4).reshape(-1, 4)
    middle = 0.5 * (corners + corners[:, nxt])
    key, face, middle = key[across], face[across], middle[across]
    order = np.argsort(key, kind="stable")
    key, face, middle = key[order], face[order], middle[order]
    pair = np.flatnonzero(key[:-1] == key[1:])
    f, g, middle = face[pair], face[pair + 1], middle[pair]
    # Along one limb, or on to the one that continues it; not across the rim of a child's hole.
    low, high = (
        np.minimum(mesh.face_branch[f], mesh.face_branch[g]),
        np.maximum(mesh.face_branch[f], mesh.face_branch[g]),
    )
    along = (low == high) | (mesh.continues_parent[high] == 1)
    f, g, middle = f[along], g[along], middle[along]
    # The place where the faces meet, not their centres: beside a fork faces may be long.
    free = forks.outside(middle) & (normal_length(corners[f]) > 0) & (normal_length(corners[g]) > 0)
    return np.degrees(np.arccos(np.clip((normal[f] * normal[g]).sum(1), -1, 1)))[free]


def normal_length(corners):
    return np.linalg.norm(np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]), axis=1)


def crossings(mesh, branches):
    """(the export's own, those made here): pairs of limbs that cross, themselves included."""
    pairs = mesh.face_branch[testing.crossing_quads(mesh.vertices, mesh.quads)]
    least = THINNEST * np.ptp(mesh.vertices[:, 2])
    own = made = 0
    for first, second in np.unique(np.sort(pairs, axis=1), axis=0):
        if tubes_cross(branches, first, second, least):
            own += 1
        else:
            made += 1
    return own, made


def tubes_cross(branches, first, second, least):
    """Whether the export's tubes of two limbs that do not leave each other intersect."""
    if first == second or branches[second].parent == first or branches[first].parent == second:
        return False
    a, b = Segments([branches[first]]), Segments([branches[second]])
    along_a, along_b = a.end - a.begin, b.end - b.begin
    u, v = along_a[:, None], along_b[None]
    off = a.begin[:, None] - b.begin[None]
    # C. Ericson, "Real-Time Collision Detection", 2005, section 5.1.9.
    uu, uv, vv = np.maximum((u * u).sum(-1), 1e-30), (u * v).sum(-1), np.maximum((v * v).sum(-1), 1e-30)
    uo, vo = (u * off).sum(-1), (v * off).sum(-1)
    s = np.clip((uv * vo - uo * vv) / np.maximum(uu * vv - uv * uv, 1e-30), 0, 1)
    t = np.clip((uv * s + vo) / vv, 0, 1)
    s = np.clip((uv * t - uo) / uu, 0, 1)
    apart = np.linalg.norm(off + u * s[..., None] - v * t[..., None], axis=-1)
    radius_a = a.low[:, None] * (1 - s) + a.high[:, None] * s
    radius_b = b.low[None] * (1 - t) + b.high[None] * t
    return bool((apart < np.maximum(radius_a, least) + np.maximum(radius_b, least)).any())


def sides(mesh):
    """Sides of the trunk's first ring: the cap that closes it has a quarter of them along each edge."""
    return 4 * round(float(((mesh.face_part == 3) & (mesh.face_branch == 0)).sum()) ** 0.5)


def sound(skeleton, mesh):
    check = native.check_mesh(mesh.vertices, mesh.quads)
    roots = sum(limb.parent < 0 for limb in skeleton.branches)
    return (
        check["closed"]
        and check["winding_ok"]
        and check["components"] == roots
        and set(check["euler"]) == {2}
        and check["zero_area_faces"] == 0
        and bool((np.abs(mesh.bone_weights.sum(1) - 1) < 1e-6).all())
    )


def best_time(repeats, **options):
    times = []
    for _ in range(repeats):
        start = time.process_time()
        mesh = native.build_tree_mesh(threads=1, **options)
        times.append(time.process_time() - start)
    return min(times), mesh


def print_row(cells):
    print("| " + " | ".join(map(str, cells)) + " |", flush=True)


def measure(path, details, repeats):
    skeleton = native.read_tree(str(path))
    branches = [limb for limb in skeleton.branches]
    forks = Forks(branches)
    random = np.random.default_rng(1)
    tubes = tube_samples(path, skeleton.report["up_axis"], branches, random, SAMPLES)
    limbs = round_limb_samples(branches, random, SAMPLES)
    base_time, base = best_time(repeats, skeleton=skeleton)
    base_crossings = "{}, {}".format(*crossings(base, branches))
    for detail in details:
        seconds, mesh = best_time(repeats, skeleton=skeleton, detail=detail)
        layout = testing.measure_uv_layout(mesh.uv_snow, mesh.vertices, mesh.quads, 1024)
        bad = layout["overlap_texels"] + int(layout["min_face_area"] <= 0) + layout["outside_faces"]
        print_row(
            [
                path.name,
                detail,
                len(mesh.quads),
                sides(mesh),
                deviation(tubes, branches, forks, mesh),
                deviation(limbs, branches, forks, mesh),
                turns(mesh, forks),
                base_crossings,
                "{}, {}".format(*crossings(mesh, branches)),
                f"{bad} / {layout['density_p95'] / layout['density_p5']:.2f}",
                "yes" if sound(skeleton, mesh) else "NO",
                f"{base_time:.3f}",
                f"{seconds:.3f}",
            ]
        )


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("folder", nargs="?", type=pathlib.Path)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--details", default=",".join(DETAILS))
    arguments = parser.parse_args()
    folder = (arguments.folder or FOLDER).resolve()
    files = sorted(folder.glob("*/*.obj")) or sorted(folder.glob("*.obj"))
    with tempfile.TemporaryDirectory() as grown:
        if arguments.folder is None:
            maple = pathlib.Path(grown) / "maple.obj"
            grow = [sys.executable, str(ROOT / "blend_samples" / "grow_tree.py"), str(maple)]
            subprocess.run(grow, check=True, stdout=subprocess.DEVNULL)
            files.append(maple)
        if not files:
            parser.error(f"no .obj files in {folder} or its folders")
        print_row(COLUMNS)
        print("|" + " --- |" * len(COLUMNS))
        for path in files:
            measure(path, arguments.details.split(","), arguments.repeats)
    print(
        f"\nLoad of the machine: {os.getloadavg()[0]:.1f}; {os.cpu_count()} cores. Best of {arguments.repeats}."
    )


if __name__ == "__main__":
    main()
