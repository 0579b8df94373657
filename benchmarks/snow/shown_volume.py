# SPDX-License-Identifier: GPL-3.0-or-later
"""Volume of the snow on a displaced mesh, as a share of its map: Steiner's correction and smoothing together.

    python3 benchmarks/snow/shown_volume.py [--engine CPU]

Every triangle is cut into pieces smaller than a texel and displaced along interpolated normals by the output's bilinear
height. The volume between that and the bare mesh is measured. "plain": displaced by the stored thickness.
"""

import argparse
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
from meshes import native, sphere, tree  # noqa: E402
from rows import ROWS, row  # noqa: E402
from snow_meshes import cylinder, grid  # noqa: E402


def shared_corners(positions, triangles):
    """Numbers of corners that share a smooth normal: those at one point."""
    _, number = np.unique(np.round(positions, 6), axis=0, return_inverse=True)
    return number.reshape(-1)[triangles].astype(np.int32)


def smooth_normals(positions, triangles, shading):
    """(T, 3, 3), weighted by the corners' angles, as Blender's."""
    corners = positions.astype(np.float64)[triangles]
    face = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    face /= np.maximum(np.linalg.norm(face, axis=1, keepdims=True), 1e-30)
    sums = np.zeros((shading.max() + 1, 3))
    for k in range(3):
        a = corners[:, (k + 1) % 3] - corners[:, k]
        b = corners[:, (k + 2) % 3] - corners[:, k]
        angle = np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), (a * b).sum(1))
        np.add.at(sums, shading[:, k], face * angle[:, None])
    return (sums / np.maximum(np.linalg.norm(sums, axis=1, keepdims=True), 1e-30))[shading]


def read(height, uv):
    size = len(height)
    at = uv * size - 0.5
    low = np.floor(at).astype(int)
    part = at - low
    value = np.zeros(uv.shape[:-1])
    for dx in (0, 1):
        for dy in (0, 1):
            x, y = np.clip(low[..., 0] + dx, 0, size - 1), np.clip(low[..., 1] + dy, 0, size - 1)
            share = np.abs(1 - dx - part[..., 0]) * np.abs(1 - dy - part[..., 1])
            value += share * height[y, x]
    return value


def displaced_volume(mesh, normals, height, cuts):
    """m3 between the mesh and the mesh displaced, every triangle cut into cuts x cuts."""
    positions, triangles, uv = mesh
    corners, uv = positions.astype(np.float64)[triangles], uv.astype(np.float64)
    pieces = [
        np.array(piece)
        for j in range(cuts)
        for i in range(cuts - j)
        for piece in ([(i, j), (i + 1, j), (i, j + 1)], [(i + 1, j), (i + 1, j + 1), (i, j + 1)])
        if max(a + b for a, b in piece) <= cuts
    ]
    total = 0.0
    for piece in pieces:
        w = np.stack([1 - piece.sum(1) / cuts, piece[:, 0] / cuts, piece[:, 1] / cuts], axis=1)
        low = np.einsum("kc,tcd->tkd", w, corners)
        along = np.einsum("kc,tcd->tkd", w, normals)
        along /= np.maximum(np.linalg.norm(along, axis=2, keepdims=True), 1e-30)
        high = low + along * read(height, np.einsum("kc,tcd->tkd", w, uv))[..., None]
        # The prism's volume with bilinear walls, as the integral over its faces.
        mean = 0.0
        for a, b, c in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
            for first, second, third, sign in ((a, b, c, 1.0), (a, c, b, -1.0)):
                for p in (
                    (low[:, first], low[:, second], low[:, third], high[:, first]),
                    (low[:, second], low[:, third], high[:, first], high[:, second]),
                    (low[:, third], high[:, first], high[:, second], high[:, third]),
                ):
                    mean += sign * (np.cross(p[1] - p[0], p[2] - p[0]) * (p[3] - p[0])).sum() / 36.0
        total += mean
    return total


def saddle():
    mesh = grid(1.0, 1.0, 24)
    x, y = mesh[0][:, 0].copy(), mesh[0][:, 1].copy()
    mesh[0][:, 2] = 1.2 * (x * x - y * y)
    return mesh


def measure(name, mesh, resolution, depth, pixel_size, cuts, steps=16, **settings):
    shading = shared_corners(*mesh[:2])
    normals = smooth_normals(mesh[0], mesh[1], shading)
    with native.SnowSimulation(
        pixel_size=pixel_size, max_depth=10.0, flutter=np.radians(3.0), **settings
    ) as sim:
        sim.add_object("it", mesh[1], mesh[2], resolution=resolution, shading=shading, sides="FRONT")
        for step in range(steps):
            sim.step({"it": mesh[0]} if step == 0 else {}, depth / steps, (0.0, 0.0, -1.0), 0.0)
        held = np.asarray(sim.height("it"), np.float64)
        volume = (held * np.asarray(sim.texel_area("it"), np.float64)).sum()
        height = np.asarray(sim.output("it")["height"], np.float64)
    shown = displaced_volume(mesh, normals, height, cuts) / volume
    plain = displaced_volume(mesh, normals, held, cuts) / volume
    text = f"{shown:.4f} x (plain {plain:.3f} x)"
    row(f"{name}: shown of what is held", "within 5 %", text, abs(shown - 1.0) < 0.05)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--engine", default="CPU")
    engine = parser.parse_args().engine
    ball = sphere(0.4, 32, 16)
    measure("plane, 0.1 m", grid(1.0, 1.0), 512, 0.1, 0.005, 24, engine=engine, blur_radius=0.004)
    measure("ball of 0.4 m, 0.12 m", ball, 512, 0.12, 0.01, 12, engine=engine, blur_radius=0.01)
    twig = cylinder(0.01, 0.3, 24, "x")
    measure("twig of 1 cm, 5 cm", twig, 512, 0.05, 0.001, 24, engine=engine, blur_radius=0.001)
    measure("saddle, 0.1 m", saddle(), 512, 0.1, 0.005, 12, engine=engine, blur_radius=0.004)
    for name in ("AL06a_squares",):
        mesh = tree(1024, name)
        if mesh is None:
            print("shared/data is not there: no tree")
            continue
        for depth in (0.01, 0.03):
            measure(
                f"{name}, {depth * 100:g} cm", mesh, 1024, depth, 0.005, 5, engine=engine, blur_radius=0.01
            )
    return 0 if all(good for *_, good in ROWS) else 1


if __name__ == "__main__":
    sys.exit(main())
