# SPDX-License-Identifier: GPL-3.0-or-later
"""The direction of the snow: the arrow that drives it, and where the dials lie."""

import math

import bpy
import pytest
from mathutils import Euler, Vector


def settled():
    bpy.context.view_layer.update()
    bpy.context.evaluated_depsgraph_get()
    return bpy.context.scene.snowbough


@pytest.mark.parametrize(
    "angle, bearing", [(0.0, 0.0), (30.0, 0.0), (30.0, 90.0), (60.0, -135.0), (89.0, 10.0)]
)
def test_the_arrow_starts_with_the_direction_that_was_set(angle, bearing):
    settings = bpy.context.scene.snowbough
    settings.fall_angle, settings.bearing = math.radians(angle), math.radians(bearing)
    bpy.ops.snowbough.add_direction_arrow()
    bpy.context.scene.frame_set(2)
    assert settled().fall_angle == pytest.approx(math.radians(angle), abs=1e-3)
    if angle:
        assert settled().bearing == pytest.approx(math.radians(bearing), abs=1e-4)


def test_both_angles_are_stored_before_their_drivers_run_side_by_side(addon):
    settings = bpy.context.scene.snowbough
    assert not settings.is_property_set("fall_angle") and not settings.is_property_set("bearing")
    empty = bpy.data.objects.new("Arrow", None)
    addon("ui.direction").drive_by(bpy.context.scene, empty)
    assert settings.is_property_set("fall_angle") and settings.is_property_set("bearing")


@pytest.mark.parametrize("rotation", [(3.5, 0.2, 1.0), (2.6, -0.4, -2.0)])
def test_turning_the_arrow_turns_the_snow(addon, rotation):
    bpy.ops.snowbough.add_direction_arrow()
    arrow = bpy.data.objects["Snow Direction"]
    arrow.rotation_euler = rotation
    bpy.context.scene.frame_set(2)
    settings = settled()
    expected = Euler(rotation, "XYZ").to_matrix() @ Vector((0, 0, 1))
    found = Vector(addon("bake.plan").unit_direction(settings.fall_angle, settings.bearing))
    assert (found - expected).length < 1e-3


def test_an_arrow_that_points_up_stops_at_the_steepest_angle():
    bpy.ops.snowbough.add_direction_arrow()
    bpy.data.objects["Snow Direction"].rotation_euler = (0.0, 0.0, 0.0)
    bpy.context.scene.frame_set(2)
    assert settled().fall_angle == pytest.approx(math.radians(89.5), abs=1e-4)


def test_the_drivers_need_no_python(addon):
    """Blender evaluates simple expressions itself, so files with disabled scripts keep their direction."""
    bpy.ops.snowbough.add_direction_arrow()
    drivers = bpy.context.scene.animation_data.drivers
    assert len(drivers) == 2
    assert all(curve.driver.is_simple_expression for curve in drivers)
    assert addon("ui.direction").is_driven(bpy.context.scene)


def test_a_dial_has_its_axes_where_they_are_asked_for(addon):
    dial = addon("ui.direction").frame_matrix(Vector((0, 0, 2)), Vector((0, 1, 5)), Vector((1, 2, 3)))
    assert (dial.translation - Vector((1, 2, 3))).length < 1e-6
    for column, axis in enumerate(((1, 0, 0), (0, 1, 0), (0, 0, 1))):
        assert (dial.to_3x3().col[column] - Vector(axis)).length < 1e-6
