# SPDX-License-Identifier: GPL-3.0-or-later
"""A shell does not show the faces of what it lies on: no steps where they meet, no flutes where they have many
corners."""

import bpy
import numpy as np
import pytest
import shell_scene
import snow_scene as s
from mathutils import Vector
from mathutils.bvhtree import BVHTree
from shell_scene import Geometry, set_slider, shell_of

SIZE = 64
DEPTH = 0.1
# Of the slope at a rim.
SLOPE = 2.0
CORNERS = 24


@pytest.fixture
def snow(addon, tmp_path):
    """snow(obj, map): a shell without relief and ragged edges, under snow that is DEPTH deep on open ground."""

    def make(obj, height):
        folder = shell_scene.write_maps(addon("native").load(), tmp_path / obj.name, [height])
        shell_scene.write_depth(addon, folder, DEPTH)
        shell = shell_of(obj, folder)
        for name in ("Relief", "Ragged Edges"):
            set_slider(addon, shell, name, 0.0)
        bpy.context.scene.frame_set(1)
        return shell

    return make


def grid(cells):
    """A square of a metre whose one chart fills the map."""
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=cells, y_subdivisions=cells, size=1.0)
    obj = bpy.context.object
    obj.data.uv_layers[0].name = "snow"
    for corner, uv in zip(obj.data.loops, obj.data.uv_layers[0].data):
        x, y, _ = obj.data.vertices[corner.vertex_index].co
        uv.uv = (x + 0.5, y + 0.5)
    return obj


def test_a_slope_goes_on_where_faces_meet(snow, addon):
    ramp = np.repeat(DEPTH * (np.arange(SIZE) + 0.5)[None, :] / SIZE, SIZE, axis=0)
    shell = snow(grid(8), ramp)
    set_slider(addon, shell, "Shoulders", 0.0)
    geometry = Geometry(shell)
    inner = np.abs(geometry.points[:, :2]).max(axis=1) < 0.35
    expected = DEPTH * (geometry.points[inner, 0] + 0.5)
    assert geometry.height[inner] == pytest.approx(expected, abs=0.05 * DEPTH / SIZE)


def drum():
    """A drum of a metre's width, whose top of CORNERS corners fills the map; its other faces lie in a corner of it."""
    bpy.ops.mesh.primitive_cylinder_add(vertices=CORNERS, radius=0.5, depth=0.5, location=(0, 0, -0.25))
    obj = bpy.context.object
    layer = obj.data.uv_layers[0]
    layer.name = "snow"
    for polygon in obj.data.polygons:
        for corner in polygon.loop_indices:
            x, y, _ = obj.data.vertices[obj.data.loops[corner].vertex_index].co
            layer.data[corner].uv = (x + 0.5, y + 0.5) if polygon.normal.z > 0.9 else (0.0, 0.0)
    return obj


def round_heap():
    """Snow on the drum that ends at its rim as a slope."""
    at = (np.arange(256) + 0.5) / 256 - 0.5
    angle, radius = np.arctan2(at[:, None], at[None, :]), np.hypot(at[:, None], at[None, :])
    across = 2.0 * np.pi / CORNERS
    rim = 0.5 * np.cos(across / 2) / np.cos((angle + np.pi / 2) % across - across / 2)
    return np.clip(SLOPE * (rim - radius), 0.0, DEPTH)


def flutes(shell):
    """How uneven the front is half-way up, from one place to the next along the rim (metres)."""
    tree = BVHTree.FromObject(shell, bpy.context.evaluated_depsgraph_get())
    radii = []
    for angle in np.linspace(0.0, 2.0 * np.pi, 15 * CORNERS, endpoint=False):
        outwards = Vector((np.cos(angle), np.sin(angle), 0.0))
        place, *_ = tree.ray_cast(outwards + Vector((0.0, 0.0, 0.5 * DEPTH)), -outwards)
        radii.append(place.xy.length)
    window = 15
    mean = np.convolve(np.pad(radii, window // 2, mode="wrap"), np.full(window, 1 / window), "valid")
    return np.std(radii - mean)


def test_the_rim_of_a_face_of_many_corners_has_no_flutes(snow, addon, monkeypatch):
    monkeypatch.setattr(addon("result.shoulder_nodes"), "VARIATION", 0.0)
    collared = flutes(snow(drum(), round_heap()))
    monkeypatch.setattr(addon("result.shell_pieces"), "MOST_CORNERS", 1000)
    other = drum()
    other.name = "Other"
    plain = flutes(snow(other, round_heap()))
    assert collared < 0.5 * plain


def test_a_shell_keeps_the_mesh_of_faces_with_four_corners(snow, addon):
    assert addon("result.snow_shell")._corners(s.square("Square", 1.0).data) == 4
    assert addon("result.snow_shell")._corners(drum().data) == 2 * CORNERS * (1 + 4) + 4 * CORNERS
