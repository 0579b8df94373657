# SPDX-License-Identifier: GPL-3.0-or-later
"""Cost and losses of spreading a pixel's snow over its UV rectangle, as the thesis does, beside our deposit.

    PYTHONPATH=build/python python3 benchmarks/snow/thesis_mapping.py [--steps 16] [--only plane,twig,...]

In the thesis (D. T. Reynolds, Real-Time Rendering and Simulation of Trees and Snow, 2014, chapter 4), a pixel knows the
UV at its centre and the extent of u and v across it, |du/dx| + |du/dy| and |dv/dx| + |dv/dy|. It adds its snow to that
rectangle of the map: to every texel whose centre lies in it, even on another surface. Here this is numpy; the core
has no such mapping. The thickness can be understood in two ways:

THESIS        mass / (texels covered x area of a texel): a rectangle without a texel's centre loses its snow.
THESIS, area  mass / area of the rectangle, even outside of charts: nothing is lost if rectangles tile the map.

Mass, jitter and back faces are as in the core (without the thesis's slope factor), and nothing slides, so only the
spreading differs. Columns: share of depth x visible area that is not on the map (negative: too much is); share of the
area that rays reach but that has no snow, after the first step and after all; share of the snow on texels that no ray
reaches, in shadow or facing away; thickest texel divided by the mean of those with snow; texels written per pixel that
shows the object; median time of a step of the core (numpy's own time is left out).
"""

import argparse
import os
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
from meshes import bunny, grid, native, rotated, texel_size, wind  # noqa: E402
from snow_meshes import STAYS  # noqa: E402
from snow_rays import lit_shares, outline_area, plane_axes, texel_points  # noqa: E402
from speed import line  # noqa: E402

DEPTH = 0.001
R2 = np.array([0.7548776662466927, 0.5698402909980532])  # low-discrepancy steps of the jitter
PAIRS = 4_000_000  # pixels of triangles' bounding boxes that are tested at once


def visible_triangles(flat, depth, pixel_size, jitter):
    """Orthographic z-buffer: the pixels whose centre a triangle covers, as centres (P, 2) and triangles (P,).

    flat (T, 3, 2) are the corners on the plane, depth (T, 3) along the fall: the least is what snow meets."""
    edge = flat[:, 1:] - flat[:, :1]
    area = edge[:, 0, 0] * edge[:, 1, 1] - edge[:, 0, 1] * edge[:, 1, 0]
    low = np.ceil(flat.min(axis=1) / pixel_size - jitter).astype(np.int64)
    high = np.floor(flat.max(axis=1) / pixel_size - jitter).astype(np.int64)
    spans = np.where(area != 0.0, (high - low + 1).T.clip(0), 0).T
    sizes = spans.prod(axis=1)
    first, width = low.min(axis=0), int((high - low.min(axis=0)).max() + 1)
    found = []
    for part in np.split(np.arange(len(flat)), np.flatnonzero(np.diff(np.cumsum(sizes) // PAIRS)) + 1):
        t = np.repeat(part, sizes[part])
        within = np.arange(len(t)) - np.repeat(np.cumsum(sizes[part]) - sizes[part], sizes[part])
        cell = low[t] + np.stack([within % spans[t, 0], within // spans[t, 0]], axis=1)
        at = (cell + jitter) * pixel_size - flat[t, 0]
        b = (at[:, 0] * edge[t, 1, 1] - at[:, 1] * edge[t, 1, 0]) / area[t]
        c = (edge[t, 0, 0] * at[:, 1] - edge[t, 0, 1] * at[:, 0]) / area[t]
        hit = (b >= 0.0) & (c >= 0.0) & (b + c <= 1.0)
        t, b, c, cell = t[hit], b[hit], c[hit], cell[hit]
        z = depth[t, 0] * (1.0 - b - c) + depth[t, 1] * b + depth[t, 2] * c
        found.append((z, t, *cell.T))
    z, t, i, j = (np.concatenate(column) for column in zip(*found))
    key = (j - first[1]) * width + i - first[0]
    order = np.lexsort((z, key))
    nearest = order[np.flatnonzero(np.diff(key[order], prepend=-1))]
    return (np.stack([i, j], axis=1)[nearest] + jitter) * pixel_size, t[nearest]


def uv_rectangles(flat, uv, centres, triangle, pixel_size):
    """UV at the centres of pixels (P, 2), and how far u and v run across each pixel (P, 2)."""
    shown, own = np.unique(triangle, return_inverse=True)
    edge, edge_uv = (corners[shown, 1:] - corners[shown, :1] for corners in (flat, uv))
    gradient = np.linalg.solve(edge, edge_uv)[own]  # (P, plane axis, uv)
    at = uv[triangle, 0] + ((centres - flat[triangle, 0])[:, :, None] * gradient).sum(axis=1)
    return at, abs(gradient).sum(axis=1) * pixel_size


def lay_on_rectangles(centre, extent, volume, texel_area, resolution, by_area=False):
    """Thickness (R, R) in metres, row 0 = v 0, and how many texels each rectangle wrote (P,).

    Rectangle p, centre[p] +- extent[p] / 2 in UV, shares volume[p] (m3) among the texels whose centres it
    holds, each of texel_area[p] m2; what lies beyond the map is lost. With `by_area` it is as thick as
    volume over the rectangle's own area, however many centres it holds."""
    low = np.ceil((centre - 0.5 * extent) * resolution - 0.5).astype(np.int64)
    high = np.ceil((centre + 0.5 * extent) * resolution - 0.5).astype(np.int64)  # one past the last
    covered = (extent * resolution).prod(axis=1) if by_area else (high - low).prod(axis=1)
    thickness = volume / np.where(covered > 0, covered * texel_area, np.inf)
    low, high = low.clip(0, resolution), high.clip(0, resolution)
    written = (high - low).prod(axis=1)
    # Summed from the differences at the rectangles' corners; counts tell a zero from its rounding.
    change = np.zeros((resolution + 1, resolution + 1))
    count = np.zeros((resolution + 1, resolution + 1), np.int64)
    for (column, row), sign in (
        ((low[:, 0], low[:, 1]), 1),
        ((high[:, 0], low[:, 1]), -1),
        ((low[:, 0], high[:, 1]), -1),
        ((high[:, 0], high[:, 1]), 1),
    ):
        np.add.at(change, (row, column), sign * thickness * (written > 0))
        np.add.at(count, (row, column), sign * (written > 0))
    change, count = (values.cumsum(axis=0).cumsum(axis=1)[:-1, :-1] for values in (change, count))
    return np.where(count > 0, change, 0.0), written


def facing_area(mesh, direction):
    """Area in m2 that faces the fall, projected along it: the visible area of a convex mesh."""
    corners = mesh[0][mesh[1]].astype(np.float64)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return 0.5 * float((-(normals @ np.asarray(direction))).clip(0.0).sum())


def thesis_steps(mesh, direction, resolution, pixel_size, steps):
    """Thickness after the first step and after all, for both readings, and texels written for a pixel."""
    positions, triangles, uv = mesh
    x, y, d = plane_axes(direction)
    corners, uv = positions[triangles].astype(np.float64), uv.astype(np.float64)
    flat, depth = corners @ np.stack([x, y], axis=1), corners @ d
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    edge_uv = uv[:, 1:] - uv[:, :1]
    area_uv = abs(edge_uv[:, 0, 0] * edge_uv[:, 1, 1] - edge_uv[:, 0, 1] * edge_uv[:, 1, 0])
    texel_area = np.linalg.norm(normal, axis=1) / (np.maximum(area_uv, 1e-30) * resolution**2)
    volume = DEPTH * pixel_size**2 / max(abs(d[2]), 0.01)
    total, first, writes, pixels = np.zeros((2, resolution, resolution)), None, 0, 0
    for step in range(steps):
        centres, t = visible_triangles(flat, depth, pixel_size, (0.5 + R2 * step) % 1.0)
        facing = (normal @ d < 0.0)[t]
        centres, t = centres[facing], t[facing]
        rectangles = uv_rectangles(flat, uv, centres, t, pixel_size)
        for by_area in (False, True):
            laid, written = lay_on_rectangles(
                *rectangles, np.full(len(t), volume), texel_area[t], resolution, by_area
            )
            total[int(by_area)] += laid
        first = total.copy() if first is None else first
        writes, pixels = writes + int(written.sum()), pixels + len(t)
    return first, total, writes / max(pixels, 1)


def core_steps(mesh, direction, resolution, pixel_size, steps, mapping):
    """Thickness after the first step and after all, areas of the texels, and a step's median seconds."""
    taken, first = [], None
    with native.SnowSimulation(
        repose=STAYS, pixel_size=pixel_size, max_depth=1e6, mapping=mapping, engine="GL"
    ) as sim:
        sim.add_object("it", mesh[1], mesh[2], resolution=resolution)
        for _ in range(steps):
            started = time.perf_counter()
            sim.step({"it": mesh[0]}, DEPTH, direction, 0.0)  # zero seconds, so that nothing slides
            sim.statistics()  # waits for the GPU
            taken.append(time.perf_counter() - started)
            first = sim.height("it") if first is None else first
        return first, sim.height("it"), sim.texel_area("it"), float(np.median(taken[1:] or taken))


def reached_texels(table, mesh, resolution, snowed, scene, direction, margin):
    """For every owned texel: the share of its surface that rays reach, and whether no ray reaches it.

    3 x 3 rays per texel. Texels with snow that none of them reaches are tested again with 16 x 16: an edge that
    cuts off a texel's corner passes between nine rays."""
    share, _ = lit_shares(table, mesh, resolution, np.arange(len(snowed)), scene, direction, margin, 3)
    doubtful = np.flatnonzero(snowed & (share == 0.0))
    finer, _ = lit_shares(table, mesh, resolution, doubtful, scene, direction, margin, 16)
    return share, (share == 0.0) & (finer == 0.0)


def compare(name, mesh, direction, resolution, pixel_size, steps, visible):
    """One row for each variant, on one mesh of which `visible` m2 are seen along the fall."""
    positions, triangles, uv = mesh
    scene = positions[triangles]
    expected = steps * DEPTH * visible / abs(np.asarray(direction)[2])
    _, _, texel, table = texel_points(native, positions, triangles, uv, resolution)
    results = []
    for mapping in ("COMPUTE", "GEOMETRY"):
        first, last, area, seconds = core_steps(mesh, direction, resolution, pixel_size, steps, mapping)
        results.append((mapping, first, last, "", f"{seconds * 1e3:.1f}"))
    *both, writes = thesis_steps(mesh, direction, resolution, pixel_size, steps)
    for label, first, last in zip(("THESIS", "THESIS, area"), *both):
        results.append((label, first, last, f"{writes:.2f}", ""))
    weight = area.ravel()[texel].astype(np.float64)
    anywhere = np.any([last.ravel()[texel] > 0.0 for _, _, last, _, _ in results], axis=0)
    share, dark = reached_texels(table, mesh, resolution, anywhere, scene, direction, 0.05 * pixel_size)
    lit = weight * share
    for label, first, last, writes, milliseconds in results:
        first, height = (values.ravel()[texel].astype(np.float64) for values in (first, last))
        snowed, amount = height > 0.0, height * weight
        whole = max(amount.sum(), 1e-300)
        peak = height.max() / max(height[snowed].mean(), 1e-300) if snowed.any() else 0.0
        line(
            name,
            label,
            f"{100.0 * (1.0 - amount.sum() / expected):.2f}",
            f"{100.0 * lit[first == 0.0].sum() / lit.sum():.1f}",
            f"{100.0 * lit[~snowed].sum() / lit.sum():.1f}",
            f"{100.0 * amount[snowed & dark].sum() / whole:.2f}",
            f"{peak:.1f}",
            writes,
            milliseconds,
        )


def twig(diameter, length, resolution, texel, sides=8):
    """A leaning open tube with its seam below. Its strip on the map is as wide as its perimeter, at least two texels,
    and runs along v."""
    turn, rise = np.linspace(0.0, 2.0 * np.pi, sides + 1), np.array([-0.5, 0.5])
    r, t = (axis.ravel() for axis in np.meshgrid(rise, turn, indexing="ij"))
    positions = np.stack([r * length, -0.5 * diameter * np.sin(t), -0.5 * diameter * np.cos(t)], axis=1)
    wide = max(np.pi * diameter / texel, 2.0) / resolution
    uv = np.stack([0.3 + wide * t / (2.0 * np.pi), 0.5 + r * length / texel / resolution], axis=1)
    a = np.arange(sides)
    b = a + sides + 1
    triangles = np.concatenate([np.stack([a, b, b + 1], axis=1), np.stack([a, b + 1, a + 1], axis=1)])
    positions = rotated(rotated(positions, "y", 20.0), "z", 25.0)
    return positions, triangles.astype(np.int32), uv[triangles].astype(np.float32)


def compare_convex(name, mesh, direction, resolution, pixel_size, steps):
    compare(name, mesh, direction, resolution, pixel_size, steps, facing_area(mesh, direction))


def planes(steps):
    """A level square whose texels are larger than pixels, equal and smaller."""
    mesh = grid()
    texel = texel_size(mesh, 64)
    for ratio in (10.0, 4.0, 1.0, 0.5, 0.25):
        compare_convex(f"square, texel {ratio:g} pixels", mesh, wind(0.0), 64, texel / ratio, steps)


def grazing(steps):
    """A square, level and leaning into the wind."""
    texel = texel_size(grid(), 128)
    for tilt, angle in ((0, 80), (0, 89), (20, 80), (20, 89)):
        positions, *layout = grid()
        mesh = rotated(positions, "x", tilt), *layout
        for ratio in (1, 4):
            name = f"square at {tilt}, wind {angle}, texel {ratio} pixels"
            compare_convex(name, mesh, wind(angle, 30.0), 128, texel / ratio, steps)


def twigs(steps):
    """A leaning twig, three pixels thick and a third of one; texels as large as pixels along it."""
    for name, pixels in (("3 pixels", 3.0), ("1/3 pixel", 1.0 / 3.0)):
        mesh = twig(0.01 * pixels, 2.0, 256, 0.01)
        compare_convex(f"twig, {name} thick", mesh, wind(0.0), 256, 0.01, steps)


def bunnies(steps):
    mesh = bunny()
    if mesh is None:
        print("the bunny of shared/data or Blender is absent: no rows")
        return
    texel = texel_size(mesh, 512)
    for angle in (0, 45):
        direction = wind(angle, 20.0)
        visible = outline_area(mesh[0][mesh[1]], direction)
        for ratio in (1, 2):
            name = f"bunny, wind {angle}, texel {ratio} pixels"
            compare(name, mesh, direction, 512, texel / ratio, steps, visible)


TABLES = {"plane": planes, "grazing": grazing, "twig": twigs, "bunny": bunnies}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--steps", type=int, default=16)
    parser.add_argument("--only", default=",".join(TABLES), help="of " + ", ".join(TABLES))
    given = parser.parse_args()
    names = given.only.split(",")
    if given.steps < 1 or not set(names) <= set(TABLES):
        parser.error(f"--steps must be 1 or more, --only some of {', '.join(TABLES)}")
    info = native.Engine("GL").info
    print(f"{info['driver']}, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}")
    print(f"{given.steps} steps; THESIS rows: the thesis's sharing over UV rectangles, in numpy\n")
    cells = (
        "case",
        "variant",
        "lost %",
        "lit, empty % (1 step)",
        "lit, empty %",
        "leaked %",
        "peak / mean",
        "writes a pixel",
        "step ms",
    )
    line(*cells)
    line(*("---" for _ in cells))
    for name in names:
        TABLES[name](given.steps)


if __name__ == "__main__":
    main()
