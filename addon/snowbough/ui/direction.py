# SPDX-License-Identifier: GPL-3.0-or-later
"""The direction of the falling snow in the 3D view: two dials with an arrow, or an Empty that drives it.

Both edit the scene settings `fall_angle` and `bearing`. Keyframes and drivers on these settings work with or without
them.
"""

import math

import bpy
from mathutils import Euler, Matrix, Vector

from ..bake.plan import unit_direction
from ..base.names import MAX_FALL_ANGLE
from ..scene.receivers import bounds
from .editing_lock import NotWhileBaking

ARROW_NAME = "Snow Direction"

# With x, y, z as the Empty's world rotation (XYZ Euler angles), its +Z axis, the arrow, points to
#   (cos z sin y cos x + sin z sin x,  sin z sin y cos x - cos z sin x,  cos y cos x).
# The expressions use only functions that Blender evaluates itself, so the drivers run where scripts are disabled.
_DRIVER_FALL_ANGLE = f"min(acos(min(max(-cos(y)*cos(x), -1), 1)), {MAX_FALL_ANGLE:.6f})"
_DRIVER_BEARING = "atan2(cos(z)*sin(y)*cos(x)+sin(z)*sin(x), sin(z)*sin(y)*cos(x)-cos(z)*sin(x))"


def arrow_rotation(fall_angle, bearing):
    """Euler angles (XYZ) of an Empty whose +Z axis points in the direction."""
    return Euler((math.pi + fall_angle, 0.0, -bearing), "XYZ")


def frame_matrix(axis, zero, origin):
    """4x4 matrix of a dial at `origin` whose Z axis is `axis` and whose Y axis is `zero`."""
    z = axis.normalized()
    y = (zero - zero.dot(z) * z).normalized()
    x = y.cross(z)
    return Matrix.Translation(origin) @ Matrix((x, y, z)).transposed().to_4x4()


def drive_by(scene, empty):
    """Makes the Empty's rotation drive the scene's fall angle and bearing."""
    settings = scene.snowbough
    # Store both values before adding drivers: Blender evaluates drivers in parallel, and if both store a first value,
    # one of the two can be lost.
    settings.fall_angle, settings.bearing = settings.fall_angle, settings.bearing
    for path, expression in (("fall_angle", _DRIVER_FALL_ANGLE), ("bearing", _DRIVER_BEARING)):
        settings.driver_remove(path)
        driver = settings.driver_add(path).driver
        driver.type = "SCRIPTED"
        for axis in "xyz":
            variable = driver.variables.new()
            variable.name = axis
            variable.type = "TRANSFORMS"
            target = variable.targets[0]
            target.id = empty
            target.transform_type = f"ROT_{axis.upper()}"
            target.transform_space = "WORLD_SPACE"
            target.rotation_mode = "XYZ"
        driver.expression = expression


def is_driven(scene):
    """True if drivers control the direction, so that the dials cannot."""
    animation = scene.animation_data
    paths = {"snowbough.fall_angle", "snowbough.bearing"}
    return animation is not None and any(driver.data_path in paths for driver in animation.drivers)


class SNOWBOUGH_OT_add_direction_arrow(NotWhileBaking, bpy.types.Operator):
    """Add an arrow whose rotation sets the direction of the falling snow"""

    bl_idname = "snowbough.add_direction_arrow"
    bl_label = "Add Direction Arrow"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        scene = context.scene
        settings = scene.snowbough
        centre, radius = bounds(scene)
        empty = bpy.data.objects.new(ARROW_NAME, None)
        empty.empty_display_type = "SINGLE_ARROW"
        empty.empty_display_size = radius
        empty.location = centre + Vector((0.0, 0.0, 2.0 * radius))
        empty.rotation_euler = arrow_rotation(settings.fall_angle, settings.bearing)
        scene.collection.objects.link(empty)
        drive_by(scene, empty)
        return {"FINISHED"}


class SNOWBOUGH_GGT_direction(bpy.types.GizmoGroup):
    """Dials for the bearing (horizontal) and the fall angle (vertical), and an arrow along the fall."""

    bl_idname = "SNOWBOUGH_GGT_direction"
    bl_label = "Snow Direction"
    bl_space_type = "VIEW_3D"
    bl_region_type = "WINDOW"
    bl_options = {"3D", "PERSISTENT", "SHOW_MODAL_ALL"}

    @classmethod
    def poll(cls, context):
        scene = context.scene
        return bool(scene.snowbough.show_direction and scene.snowbough.receivers) and not is_driven(scene)

    def setup(self, context):
        # Gizmos outlive the scene that they were made for, so the handlers read the current scene.
        def getter(name):
            return lambda: getattr(bpy.context.scene.snowbough, name)

        def setter(name):
            def set_(value):
                value = max(0.0, min(value, MAX_FALL_ANGLE)) if name == "fall_angle" else value
                setattr(bpy.context.scene.snowbough, name, value)

            return set_

        self.dials = {}
        for name, color in (("bearing", (0.35, 0.65, 1.0)), ("fall_angle", (0.65, 0.85, 1.0))):
            dial = self.gizmos.new("GIZMO_GT_dial_3d")
            dial.draw_options = {"ANGLE_START_Y", "ANGLE_VALUE"}
            dial.target_set_handler("offset", get=getter(name), set=setter(name))
            dial.use_draw_value = True
            dial.use_draw_modal = True
            dial.line_width = 2.0
            dial.color = color
            dial.alpha = 0.5
            dial.color_highlight = (1.0, 1.0, 1.0)
            dial.alpha_highlight = 1.0
            self.dials[name] = dial
        self.arrow = self.gizmos.new("GIZMO_GT_arrow_3d")
        self.arrow.draw_style = "NORMAL"
        self.arrow.target_set_handler("offset", get=lambda: 0.0, set=lambda _value: None)
        self.arrow.color = (0.9, 0.95, 1.0)
        self.arrow.alpha = 0.9
        self.arrow.hide_select = True

    def draw_prepare(self, context):
        settings = context.scene.snowbough
        centre, radius = bounds(context.scene)
        origin = centre + Vector((0.0, 0.0, radius))
        along = Vector(unit_direction(settings.fall_angle, settings.bearing))
        ahead = Vector(unit_direction(math.pi / 2, settings.bearing))
        across = ahead.cross(Vector((0.0, 0.0, -1.0)))
        # A dial's value grows from its Y axis towards its X axis, clockwise as seen from its Z axis.
        self.dials["bearing"].matrix_basis = frame_matrix(Vector((0, 0, 1)), Vector((0, 1, 0)), origin)
        self.dials["fall_angle"].matrix_basis = frame_matrix(across, Vector((0, 0, -1)), origin)
        self.arrow.matrix_basis = (
            Matrix.Translation(origin) @ along.to_track_quat("Z", "Y").to_matrix().to_4x4()
        )


CLASSES = (SNOWBOUGH_OT_add_direction_arrow, SNOWBOUGH_GGT_direction)
register, unregister = bpy.utils.register_classes_factory(CLASSES)
