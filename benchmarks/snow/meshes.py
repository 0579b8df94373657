# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes for the snow measurements: positions (N, 3), triangles (T, 3), uv (T, 3, 2), Z up, metres.

Meshes made elsewhere are in shared/data beside the checkout. A measurement whose mesh is missing says so and continues
without it. The bunny has no UVs: Blender unwraps it once into build/snow.
"""

import subprocess
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
SHARED = ROOT.parent / "shared" / "data"
BUILD = ROOT / "build" / "snow"
sys.path[:0] = [str(ROOT / "build" / "python"), str(ROOT / "tests" / "python" / "native")]

import snowbough_native as native  # noqa: E402
from snow_meshes import box, grid, rotated, sphere, wind  # noqa: E402, F401


def in_blender(script, *arguments):
    """Runs a script beside this file in Blender without a window."""
    program = ["blender", "-b", "--factory-startup", "--python-exit-code", "1"]
    script = str(Path(__file__).with_name(script))
    subprocess.run(
        [*program, "-P", script, "--", *map(str, arguments)], check=True, stdout=subprocess.DEVNULL
    )


def bunny():
    """A bunny 1.5 m high with a Smart UV layout, or None if the mesh is missing."""
    source, target = SHARED / "snow" / "stanford-bunny.obj", BUILD / "stanford-bunny.npz"
    if not target.is_file():
        if not source.is_file():
            return None
        BUILD.mkdir(parents=True, exist_ok=True)
        in_blender("unwrap.py", source, target)
    data = np.load(target)
    return data["positions"] * np.float32(10.0), data["triangles"], data["uv"]


def tree():
    """A real tree rebuilt as one surface with its snow UVs."""
    path = SHARED / "trees" / "squares" / "AL06a_squares.obj"
    if not path.is_file():
        return None
    mesh = native.build_tree_mesh(native.read_tree(str(path)), snow_resolution=1024)
    quads, uv = np.asarray(mesh.quads), np.asarray(mesh.uv_snow)
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]).astype(np.int32)
    return (
        np.asarray(mesh.vertices, np.float32),
        triangles,
        np.concatenate([uv[:, [0, 1, 2]], uv[:, [0, 2, 3]]]).astype(np.float32),
    )


def surface_area(positions, triangles):
    corners = positions[triangles].astype(np.float64)
    return (
        0.5
        * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum()
    )


def texel_size(mesh, resolution):
    """Mean edge in metres of a texel of the mesh's map."""
    table = native.texel_table(mesh[1], mesh[2], resolution)
    return float(np.sqrt(surface_area(mesh[0], mesh[1]) / table["coverage"].sum()))


def waving_field(cells=128, extent=10.0):
    positions, triangles, uv = grid(extent, extent, cells, margin=0.0)
    x, y = positions[:, 0], positions[:, 1]
    positions[:, 2] = 0.3 * np.sin(2.0 * x) * np.cos(1.5 * y)
    return positions, triangles, uv
