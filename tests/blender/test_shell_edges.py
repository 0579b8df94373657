# SPDX-License-Identifier: GPL-3.0-or-later
"""Ragged edges: where shelter thins the snow out, it lies in patches before it is gone."""

import bpy
import numpy as np
import pytest
import shell_scene
import snow_scene as s
from mathutils import Matrix
from shell_scene import Geometry, set_slider, shell_of

SIZE = 256
DEPTH = 0.1


@pytest.fixture
def shell(addon, tmp_path):
    """shell(map, obj=None): of a square of 4 m, or obj, under snow that is DEPTH deep on open ground."""

    def make(height, obj=None):
        obj = obj or s.square("Ground", 4.0)
        folder = shell_scene.write_maps(
            addon("native").load(), tmp_path / obj.name, [height], covered=level(1.0)
        )
        shell_scene.write_depth(addon, folder, DEPTH)
        made = shell_of(obj, folder)
        for name in ("Relief", "Shoulders"):
            set_slider(addon, made, name, 0.0)
        bpy.context.scene.frame_set(1)
        return made

    return make


def level(depth):
    return np.full((SIZE, SIZE), depth)


def inner(geometry):
    """Thickness away from the sheet's own rim."""
    return geometry.height[np.abs(geometry.points[:, :2]).max(axis=1) < 1.9]


def test_open_ground_keeps_all_of_its_snow(shell):
    assert inner(Geometry(shell(level(DEPTH)))) == pytest.approx(DEPTH, abs=1e-6)


def test_thin_snow_lies_in_patches(shell):
    shown = inner(Geometry(shell(level(0.06 * DEPTH))))
    assert shown.max() == pytest.approx(0.06 * DEPTH, abs=1e-6)
    assert 0.1 < np.mean(shown < 0.01 * DEPTH) < 0.9


def test_half_of_the_open_depth_is_no_edge(shell):
    assert inner(Geometry(shell(level(0.6 * DEPTH)))) == pytest.approx(0.6 * DEPTH, abs=1e-6)


def test_bare_ground_stays_bare(shell):
    half = level(0.5 * DEPTH)
    half[:, : SIZE // 2] = 0.0
    geometry = Geometry(shell(half))
    # A texel wide the map itself goes from one to the other.
    assert geometry.height[geometry.points[:, 0] < -3 * 4.0 / SIZE].max() == 0.0


def test_zero_shows_the_map(shell, addon):
    made = shell(level(0.06 * DEPTH))
    set_slider(addon, made, "Ragged Edges", 0.0)
    assert inner(Geometry(made)) == pytest.approx(0.06 * DEPTH, abs=1e-6)


def rod(radius):
    """A smooth rod along x, the whole of it in one texel's surroundings of the map's middle."""
    bpy.ops.mesh.primitive_cylinder_add(radius=radius, depth=1.0, rotation=(0.0, np.pi / 2, 0.0))
    obj = bpy.context.object
    layer = obj.data.uv_layers[0]
    layer.name = "snow"
    for corner in layer.data:
        corner.uv = (0.5, 0.5)
    bpy.ops.object.shade_smooth()
    return obj


def test_what_is_thin_keeps_its_thin_snow(shell):
    thin = 0.06 * DEPTH
    geometry = Geometry(shell(level(thin), rod(0.2 * thin)))
    # Its ends are walls, and below its middle it is an overhang: their thin snow does not show.
    top = (geometry.points[:, 2] > 0.5 * thin) & (np.abs(geometry.points[:, 0]) < 0.45)
    assert geometry.height[top].min() == pytest.approx(thin, abs=1e-6)


def test_what_is_narrow_keeps_its_thin_snow(shell):
    """A picket's end: high, but its rims are near."""
    thin = 0.06 * DEPTH
    bpy.ops.mesh.primitive_cube_add(size=1.0)
    picket = bpy.context.object
    width = 5.0 * thin
    picket.data.transform(Matrix.Diagonal((width, 1.0, 2.0, 1.0)))
    picket.data.uv_layers[0].name = "snow"
    geometry = Geometry(shell(level(thin), picket))
    top = (geometry.points[:, 2] > 1.0) & (np.abs(geometry.points[:, 0]) < 0.4 * width)
    assert geometry.height[top].min() > 0.5 * thin


def test_what_is_thick_does_not(shell):
    thin = 0.06 * DEPTH
    assert Geometry(shell(level(thin), rod(DEPTH))).height.min() < 0.1 * thin


def test_between_patches_lies_a_dusting(shell):
    shown = inner(Geometry(shell(level(0.03 * DEPTH))))
    assert 0.0 < shown.min() < 0.002


def steep():
    """A square that rises by 60 degrees along y."""
    obj = s.square("Slope", 4.0)
    obj.rotation_euler = (np.radians(60.0), 0.0, 0.0)
    return obj


def in_the_middle(geometry):
    return geometry.height[(np.abs(geometry.points[:, :2]) < (1.5, 0.7)).all(axis=1)]


@pytest.mark.parametrize(("thin", "least", "most"), [(0.1, 1.5, 3.0), (2.0, 0.99, 1.01)])
def test_steep_snow_ends_in_a_lip_and_deep_snow_stays(shell, addon, thin, least, most):
    made = shell(level(thin * DEPTH), steep())
    set_slider(addon, made, "Ragged Edges", 0.0)
    assert in_the_middle(Geometry(made)) == pytest.approx(thin * DEPTH, rel=1e-4)
    set_slider(addon, made, "Shoulders", 1.0)
    shown = in_the_middle(Geometry(made)) / (thin * DEPTH)
    assert least < shown.min() <= shown.max() < most


def test_thin_snow_on_a_slope_is_thin_for_being_steep(shell):
    thin = 0.15 * DEPTH
    on_level = inner(Geometry(shell(level(thin))))
    on_slope = in_the_middle(Geometry(shell(level(thin), steep())))
    assert on_slope.min() > 0.9 * thin > 2.0 * on_level.min()
