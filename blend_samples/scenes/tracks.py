# SPDX-License-Identifier: GPL-3.0-or-later
"""A yard that was in use: boot prints, the track of a tyre, a ploughed lane, and a heated strip that a mask keeps
bare."""

import math

import bpy
import sample

FRAMES = 40
YARD = 3.6
# Height of the yard over the ground, which is not level.
TOP = 0.4


def keyed(obj, path, frame, value):
    setattr(obj, path, value)
    obj.keyframe_insert(path, frame=frame)
    for curve in obj.animation_data.action.fcurves:
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"


def pressing(obj, kind, **settings):
    obj.snowbough.press, obj.snowbough.occlude = kind, False
    for name, value in settings.items():
        setattr(obj.snowbough, name, value)
    return obj


def active(name, material):
    made = bpy.context.view_layer.objects.active
    made.name = name
    made.data.materials.append(material)
    return made


def yard(material):
    made = sample.board("yard", material, YARD, (0.0, 0.0, TOP), 48)
    group = made.vertex_groups.new(name="heated")
    for vertex in made.data.vertices:
        weight = 1.0 - min(1.0, max(0.0, (abs(vertex.co.x - 1.35) - 0.12) / 0.1))
        group.add([vertex.index], weight, "REPLACE")
    return made


def slab(material):
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=(0.0, 0.0, 0.5 * TOP - 0.255))
    made = active("slab", material)
    made.scale = (YARD, YARD, TOP + 0.5)


def boots(material):
    """Two soles that walk along X, three quarters of the shot; then they leave the picture."""
    for side, first in ((1, 4), (-1, 8)):
        bpy.ops.mesh.primitive_cylinder_add(vertices=24, radius=0.5, depth=0.2)
        sole = pressing(active("boot", material), "PRESS", pushed_aside=0.25)
        sole.scale, sole.rotation_euler[2] = (0.29, 0.11, 1.0), 0.12 * side
        for step in range(4):
            x = -1.5 + 0.62 * step + (0.31 if side < 0 else 0.0)
            frame = first + 7 * step
            for wait, z in ((0, 0.5), (2, 0.15), (4, 0.15), (6, 0.5)):
                keyed(sole, "location", frame + wait, (x, -0.95 + 0.12 * side, TOP + z))
        keyed(sole, "location", first + 28, (0.0, 0.0, 60.0))


def tyre(material):
    radius = 0.32
    bpy.ops.mesh.primitive_torus_add(
        major_segments=72, minor_segments=16, major_radius=radius - 0.07, minor_radius=0.07,
        rotation=(math.pi / 2, 0.0, 0.0),
    )  # fmt: skip
    bpy.ops.object.transform_apply(rotation=True)
    made = pressing(active("tyre", material), "PRESS")
    for frame, x in ((1, -2.2), (FRAMES, 0.85)):
        keyed(made, "location", frame, (x, 0.1, TOP + radius + 0.04))
        keyed(made, "rotation_euler", frame, (0.0, (x + 2.2) / radius, 0.0))


def blade(material):
    bpy.ops.mesh.primitive_cube_add(size=1.0)
    made = pressing(active("blade", material), "PLOUGH", rim_width=0.03)
    made.scale, made.rotation_euler[2] = (0.03, 0.8, 0.35), math.radians(28.0)
    for frame, x in ((1, -2.3), (FRAMES, 0.55)):
        keyed(made, "location", frame, (x, 1.05, TOP + 0.17))


def build():
    stone = sample.painted("stone", (0.10, 0.095, 0.09), mottle=0.3, scale=6.0)
    rubber = sample.painted("rubber", (0.02, 0.02, 0.02), roughness=0.7)
    steel = sample.painted("steel", (0.35, 0.12, 0.02), roughness=0.45)
    made = yard(stone)
    slab(stone)
    boots(rubber)
    tyre(rubber)
    blade(steel)
    return [made]


def mask(settings):
    entry = next(own for own in settings.receivers if own.object.name == "yard")
    entry.mask, entry.mask_group, entry.mask_inverted = "GROUP", "heated", True


sample.run(
    build,
    eye=(-0.9, -3.7, 3.3),
    target=(-0.1, -0.05, 0.35),
    lens=36.0,
    frames=FRAMES,
    depth=0.13,
    resolution=768,
    start_depth=0.13,
    prepare=mask,
)
