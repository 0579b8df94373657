# SPDX-License-Identifier: GPL-3.0-or-later
"""Instanced collections show their snow: each mesh the snow of its own map, at its instance's position."""

import math

import bpy
import numpy as np
import pytest
import snow_scene as s
from surface_scene import points_of


@pytest.fixture
def instance(tmp_path):
    """An empty that instances two squares with maps of other names, 1 m above each other; baked."""
    low, high = s.square("Low", 2.0), s.square("High", 1.0, z=1.0)
    high.data.uv_layers[0].name = "other"
    empty = s.instanced(low, high, name="Instance")
    empty.instance_collection.instance_offset = (0.0, 0.0, 0.5)
    empty.location = (5.0, 0.0, 2.0)
    empty.rotation_euler.z = math.radians(45.0)
    entry = bpy.context.scene.snowbough.receivers.add()
    entry.object = empty
    entry.resolution = 128
    s.settings(tmp_path)
    bpy.ops.snowbough.setup_displacement(mode="SHELL")
    s.bake()
    bpy.context.scene.frame_set(4)
    return empty


def test_every_member_has_its_own_surface_where_its_instance_stands(instance):
    low, high = points_of(bpy.data.objects["Low Snow"]), points_of(bpy.data.objects["High Snow"])
    assert high[:, 2].max() == pytest.approx(2.6, abs=0.02)
    assert high[:, :2].mean(axis=0) == pytest.approx([5.0, 0.0], abs=0.02)
    # Turned by 45 degrees, a corner of the square lies on the axis.
    assert high[:, 0].max() == pytest.approx(5.0 + math.sqrt(0.5), abs=0.05)
    # The lower square shows its own map, which is bare below the upper square.
    middle = np.abs(low[:, :2] - [5.0, 0.0]).max(axis=1) < 0.2
    assert low[:, 2].max() == pytest.approx(1.6, abs=0.02)
    assert (low[middle, 2] <= 1.5).all()
    assert high[np.abs(high[:, :2] - [5.0, 0.0]).max(axis=1) < 0.2, 2].min() > 2.585


def test_surfaces_are_children_of_the_empty_and_follow_it(instance):
    surface = bpy.data.objects["High Snow"]
    assert surface.parent == instance
    before = points_of(surface)
    instance.location.x += 1.0
    bpy.context.view_layer.update()
    assert np.abs(points_of(surface) - before - [1.0, 0.0, 0.0]).max() < 1e-5


def test_nothing_of_the_collection_is_changed(instance):
    for obj in instance.instance_collection.objects:
        assert not obj.modifiers and not obj.data.materials and not obj.children


def test_removing_takes_all_of_them_off(instance):
    bpy.ops.snowbough.remove()
    assert not [obj for obj in bpy.data.objects if obj.snowbough.is_shell]
