# SPDX-License-Identifier: GPL-3.0-or-later
"""A car that is parked at the kerb under a bare maple: snow on roof, bonnet and windows, less of it under the branches,
dry asphalt under the car."""

import math

import bmesh
import bpy
import demo_scene
import sample
from mathutils import Vector

# The outline of the body from the side, in metres: (along, up). The windows begin at the height of the belt.
HULL = ((-2.05, 0.30), (-2.08, 0.72), (-1.75, 0.84), (1.05, 0.84), (1.95, 0.72), (2.05, 0.45), (2.0, 0.30))
CABIN = ((-1.70, 0.82), (-1.15, 1.38), (0.15, 1.42), (0.95, 0.82))
PARKED = Vector((0.3, -2.3, 0.05))
WHEELS = [Vector((along, side, 0.31)) for along in (-1.25, 1.25) for side in (-0.78, 0.78)]


def extruded(name, outline, width, top_width, material):
    """A solid whose side is the outline; it narrows to top_width at its highest point. Its edges are rounded."""
    low, high = min(up for _, up in outline), max(up for _, up in outline)
    mesh = bmesh.new()
    sides = []
    for side in (-0.5, 0.5):
        corners = [
            (along, up, width + (top_width - width) * (up - low) / (high - low)) for along, up in outline
        ]
        sides.append([mesh.verts.new((along, side * wide, up)) for along, up, wide in corners])
    mesh.faces.new(sides[0])
    mesh.faces.new(list(reversed(sides[1])))
    for i in range(len(outline)):
        after = (i + 1) % len(outline)
        mesh.faces.new((sides[0][after], sides[0][i], sides[1][i], sides[1][after]))
    made = demo_scene.finish_object(mesh, name, material)
    bpy.context.view_layer.objects.active = made
    bevel = made.modifiers.new("round", "BEVEL")
    bevel.width, bevel.segments, bevel.limit_method = 0.09, 4, "NONE"
    bpy.ops.object.modifier_apply(modifier="round")
    return sample.finish(material)


def make_wheel(number, place, material):
    bpy.ops.mesh.primitive_cylinder_add(
        radius=0.31, depth=0.2, location=place, rotation=(math.pi / 2, 0.0, 0.0), vertices=40
    )
    bpy.context.object.name = f"wheel {number}"
    return sample.finish(material, smooth=False)


def box(name, place, size, material):
    mesh = bmesh.new()
    demo_scene.add_box(mesh, Vector(place), size, cell=0.25)
    made = demo_scene.finish_object(mesh, name, material)
    demo_scene.unwrap(made)
    return made


def build():
    paint = sample.painted("blue paint", (0.02, 0.07, 0.22), roughness=0.25)
    glass = sample.painted("glass", (0.02, 0.025, 0.03), roughness=0.08)
    rubber = sample.painted("rubber", (0.02, 0.02, 0.02))
    kerb = sample.painted("kerb", (0.30, 0.29, 0.27), mottle=0.2, scale=6.0)
    asphalt = sample.painted("asphalt", (0.05, 0.05, 0.055), mottle=0.3, scale=12.0)
    car = [extruded("hull", HULL, 1.70, 1.62, paint), extruded("cabin", CABIN, 1.50, 1.20, glass)]
    car += [make_wheel(number, place, rubber) for number, place in enumerate(WHEELS, 1)]
    for part in car:
        part.location += PARKED
    road = box("road", (0.0, -3.0, 0.0), (12.0, 3.6, 0.1), asphalt)
    edge = box("kerb", (0.0, -1.12, 0.06), (12.0, 0.16, 0.24), kerb)
    return [sample.tree("maple")[0], *car, road, edge]


sample.run(
    build, eye=(3.6, -8.6, 2.3), target=(0.3, -1.2, 1.35), lens=32.0, depth=0.11, angle=8.0, resolution=1024
)
