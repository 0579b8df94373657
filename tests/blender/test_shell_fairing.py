# SPDX-License-Identifier: GPL-3.0-or-later
"""Fairing: fronts of shells, and the line in which snow ends, are smoother than the faces that they stand on."""

import bpy
import numpy as np
import pytest
import shell_scene
import snow_scene as s
from shell_scene import Geometry, set_slider, shell_of

SIZE = 256
DEPTH = 0.05
RADIUS = 0.4
# Cosine of the angle between a cap's axis and its border, and how wide its slope is.
BORDER, WIDTH = 0.75, 0.01


def ball():
    bpy.ops.mesh.primitive_uv_sphere_add(segments=24, ring_count=12, radius=RADIUS)
    obj = bpy.context.object
    obj.data.uv_layers[0].name = "snow"
    bpy.ops.object.shade_smooth()
    return obj


# Oblique to the ball's meridians and parallels.
AXIS = np.array((0.4, 0.3, 1.0)) / np.linalg.norm((0.4, 0.3, 1.0))


def cap():
    """A cap around AXIS, on the map of Blender's ball: u goes round from -x, v from the lower pole up."""
    at = (np.arange(SIZE) + 0.5) / SIZE
    azimuth, polar = 2.0 * np.pi * (at[None, :] - 0.5), np.pi * (1.0 - at[:, None])
    normals = np.stack(
        np.broadcast_arrays(np.cos(azimuth) * np.sin(polar), np.sin(azimuth) * np.sin(polar), np.cos(polar)),
        -1,
    )
    return DEPTH * np.clip((normals @ AXIS - BORDER) / WIDTH, 0.0, 1.0)


@pytest.fixture
def border(addon, tmp_path, monkeypatch):
    """border(rounds): cosines between AXIS and points of the line in which the cap's snow ends, along that line."""
    fairing = addon("result.fairing_nodes")
    monkeypatch.setattr(addon("result.snow_shell"), "MAX_FACES_VIEWPORT", 1_000_000)

    def of(rounds):
        monkeypatch.setattr(fairing, "MOST_ROUNDS", rounds)
        folder = shell_scene.write_maps(addon("native").load(), tmp_path / f"rounds {rounds}", [cap()])
        shell_scene.write_depth(addon, folder, DEPTH)
        shell = shell_of(ball(), folder)
        for name in ("Relief", "Ragged Edges"):
            set_slider(addon, shell, name, 0.0)
        bpy.context.scene.frame_set(1)
        points = Geometry(shell).contour(0.006)
        side = np.cross(AXIS, (1.0, 0.0, 0.0))
        along = np.argsort(np.arctan2(points @ side, points @ np.cross(side, AXIS)))
        return (points @ AXIS / np.linalg.norm(points, axis=1))[along]

    return of


def roughness(line):
    """How far points are from the mean of their surroundings along the line."""
    window = 15
    return np.std(
        line - np.convolve(np.pad(line, window // 2, mode="wrap"), np.full(window, 1 / window), "valid")
    )


def test_snow_ends_in_a_smooth_line(border):
    plain, faired = border(0), border(8)
    assert len(faired) > 100
    assert np.mean(faired) == pytest.approx(np.mean(plain), abs=0.02)
    assert roughness(faired) < 0.85 * roughness(plain)


@pytest.mark.parametrize("face_size, rounds", [(0.003, 8), (0.006, 8), (0.012, 2), (0.03, 0), (np.inf, 0)])
def test_coarse_faces_are_drawn_together_less_often(addon, face_size, rounds):
    assert addon("result.fairing_nodes").rounds_for(face_size) == rounds


@pytest.mark.parametrize("thickness, shown", [(0.002, 0.0), (0.03, 0.03)])
def test_walls_show_no_thin_snow(addon, tmp_path, thickness, shown):
    wall = s.square("Wall", 2.0)
    wall.rotation_euler.x = np.pi / 2
    folder = shell_scene.write_maps(
        addon("native").load(), tmp_path / "wall", [np.full((SIZE, SIZE), thickness)]
    )
    shell = shell_of(wall, folder)
    bpy.context.scene.frame_set(1)
    geometry = Geometry(shell)
    inner = np.abs(geometry.points[:, [0, 2]]).max(axis=1) < 0.8
    assert geometry.height[inner] == pytest.approx(shown, abs=1e-4)
