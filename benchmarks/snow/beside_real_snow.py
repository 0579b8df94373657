# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of whole scenes under our snow and under Real Snow, Blender's own add-on.

    blender -b --factory-startup --python-exit-code 1 -P benchmarks/snow/beside_real_snow.py -- SCENE ours|real DEPTH
        [--out FOLDER] [--root CHECKOUT] [--views wide,close] [--size 480x270] [--samples 16]

SCENE: house, stair, terrace, wall, street, conifer. DEPTH: metres of snow on open ground. Each scene goes the artist's
way: all objects are selected, then Add Snow and Bake Snow over 16 frames with the defaults, or Real Snow's Add Snow on
one object after the other with the same depth. Writes FOLDER/<scene>_<program>_<centimetres>_<view>.png and prints the
seconds from the press of the button to the surfaces. The scenes were made for these pictures, and no constant of the
snow was chosen on them.

Real Snow covers an object with metaballs, at least 10 cm deep; on the open ground of a scene it does not finish, so a
raised copy of the ground stands for its snow there.
"""

import argparse
import math
import random
import sys
import tempfile
import time
from pathlib import Path

import bmesh
import bpy
from mathutils import Matrix, Vector, noise

FRAMES = 16
REAL_MIN = 0.1

COLOURS = {
    # name: (colour, roughness)
    "stone": ((0.28, 0.26, 0.23), 0.8),
    "wood": ((0.30, 0.15, 0.07), 0.8),
    "tile": ((0.42, 0.13, 0.07), 0.8),
    "plaster": ((0.62, 0.55, 0.42), 0.8),
    "grass": ((0.09, 0.12, 0.04), 0.9),
    "asphalt": ((0.07, 0.07, 0.07), 0.8),
    "iron": ((0.03, 0.03, 0.035), 0.4),
    "paint": ((0.35, 0.02, 0.02), 0.25),
    "glass": ((0.10, 0.15, 0.16), 0.1),
    "needle": ((0.04, 0.11, 0.04), 0.8),
    "bark": ((0.14, 0.09, 0.06), 0.9),
    "snow": ((0.85, 0.87, 0.90), 0.9),
}


def arguments():
    parser = argparse.ArgumentParser(prog="beside_real_snow.py")
    parser.add_argument("scene", choices=SCENES)
    parser.add_argument("program", choices=("ours", "real"))
    parser.add_argument("depth", type=float)
    root = Path(__file__).resolve().parents[2]
    parser.add_argument("--out", type=Path, default=root / "build" / "snow" / "beside")
    parser.add_argument("--root", type=Path, default=root)
    parser.add_argument("--views", default="wide,close")
    parser.add_argument("--size", default="480x270")
    parser.add_argument("--samples", type=int, default=16)
    return parser.parse_args(sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else [])


# -- shapes --------------------------------------------------------------------------------------------------


def material(name):
    made = bpy.data.materials.get(name)
    if made is None:
        made = bpy.data.materials.new(name)
        made.use_nodes = True
        inputs = made.node_tree.nodes["Principled BSDF"].inputs
        colour, inputs["Roughness"].default_value = COLOURS[name]
        inputs["Base Color"].default_value = (*colour, 1.0)
    return made


def turned(degrees):
    x, y, z = (Matrix.Rotation(math.radians(angle), 4, axis) for angle, axis in zip(degrees, "XYZ"))
    return z @ y @ x


class Shape:
    """Pieces of one mesh; each function adds one and returns the shape."""

    def __init__(self):
        self.form = bmesh.new()

    def _place(self, made, centre, turn, size=(1.0, 1.0, 1.0)):
        matrix = Matrix.Translation(centre) @ turned(turn) @ Matrix.Diagonal((*size, 1.0))
        bmesh.ops.transform(self.form, matrix=matrix, verts=made["verts"])
        return self

    def box(self, centre, size, turn=(0, 0, 0)):
        return self._place(bmesh.ops.create_cube(self.form, size=1.0), centre, turn, size)

    def cone(self, centre, low, high, length, around=16, turn=(0, 0, 0)):
        made = bmesh.ops.create_cone(
            self.form, cap_ends=True, segments=around, radius1=low, radius2=high, depth=length
        )
        return self._place(made, centre, turn)

    def ball(self, centre, radius, rings=12, size=(1.0, 1.0, 1.0)):
        made = bmesh.ops.create_uvsphere(self.form, u_segments=2 * rings, v_segments=rings, radius=radius)
        return self._place(made, centre, (0, 0, 0), size)

    def lathe(self, foot, outline, around=24):
        """Turns an outline of (radius, height) around a vertical axis."""
        turns = [2.0 * math.pi * k / around for k in range(around)]
        rows = [
            [self.form.verts.new(Vector(foot) + Vector((r * math.cos(a), r * math.sin(a), z))) for a in turns]
            for r, z in outline
        ]
        for a, b in zip(rows, rows[1:]):
            for k in range(around):
                self.form.faces.new((a[k], a[(k + 1) % around], b[(k + 1) % around], b[k]))
        self.form.faces.new(reversed(rows[0]))
        self.form.faces.new(rows[-1])
        return self

    def faces(self, points, corners):
        verts = [self.form.verts.new(point) for point in points]
        for face in corners:
            self.form.faces.new([verts[k] for k in face])
        return self

    def done(self, name, colour, bevel=0.0, segments=1, smooth=False, rough=0.0, subdivisions=0):
        """The object. rough: metres by which noise moves its points."""
        bmesh.ops.recalc_face_normals(self.form, faces=self.form.faces)
        mesh = bpy.data.meshes.new(name)
        self.form.to_mesh(mesh)
        made = bpy.data.objects.new(name, mesh)
        bpy.context.scene.collection.objects.link(made)
        mesh.materials.append(material(colour))
        bpy.context.view_layer.objects.active = made
        if bevel:
            modifier = made.modifiers.new("Bevel", "BEVEL")
            modifier.width, modifier.segments, modifier.limit_method = bevel, segments, "ANGLE"
            bpy.ops.object.modifier_apply(modifier=modifier.name)
        if subdivisions:
            modifier = made.modifiers.new("Subdivision", "SUBSURF")
            modifier.levels = subdivisions
            bpy.ops.object.modifier_apply(modifier=modifier.name)
        for vertex in mesh.vertices:
            vertex.co += rough * noise.noise_vector(vertex.co * 6.0)
        if smooth:
            for polygon in mesh.polygons:
                polygon.use_smooth = True
        return made


def ground(half, bumps=0.0, colour="grass", z=0.0):
    made = Shape()
    bmesh.ops.create_grid(made.form, x_segments=24, y_segments=24, size=half)
    for vertex in made.form.verts:
        vertex.co.z = z + bumps * noise.noise(vertex.co * 0.6)
    return made.done("ground", colour)


# -- scenes: each returns {view: (eye, target, lens)} ----------------------------------------------------------


def house():
    """A tiled roof of 38 degrees with gutters, a chimney, sills and a step."""
    chance = random.Random(3)
    ground(7.0, 0.05)
    Shape().box((0, 0, 1.25), (4.0, 3.0, 2.5)).box((0, -1.53, 0.1), (1.3, 0.5, 0.2)).done(
        "walls", "plaster", 0.015
    )
    sills = Shape().box((0, -1.75, 2.15), (1.4, 0.6, 0.06), (12, 0, 0))
    for x in (-1.1, 1.1):
        sills.box((x, -1.52, 1.0), (0.9, 0.24, 0.05))
    sills.done("sills", "stone", 0.008, 2)
    pitch, course, tilt = math.radians(38.0), 0.24, math.degrees(math.atan2(0.022, 0.24))
    tiles = Shape()
    for side in (-1, 1):
        for row in range(int(1.85 / math.cos(pitch) / course)):
            up = 0.12 + row * course
            y, z = side * (-1.85 + up * math.cos(pitch)), 2.44 + up * math.sin(pitch)
            for column in range(20):
                x = -2.2 + (column + 0.5 * (row % 2)) * 0.225 + chance.uniform(-0.003, 0.003)
                lie = (side * (38.0 - tilt), 0, chance.uniform(-0.8, 0.8))
                tiles.box((x, y, z + chance.uniform(-0.002, 0.002)), (0.22, 0.29, 0.018), lie)
    ridge = 2.44 + 1.85 * math.tan(pitch)
    for k in range(11):
        tiles.cone((-1.95 + k * 0.41, 0, ridge), 0.09, 0.10, 0.44, 12, (0, 90, 0))
    tiles.done("tiles", "tile", 0.004)
    top = 2.48 + 1.5 * math.tan(pitch)
    gables = Shape()
    for x in (-2.0, 1.94):
        points = [(x + d, y, z) for d in (0.0, 0.06) for y, z in ((-1.5, 2.5), (1.5, 2.5), (0.0, top))]
        gables.faces(points, ((0, 1, 2), (5, 4, 3), (0, 3, 4, 1), (1, 4, 5, 2), (2, 5, 3, 0)))
    gables.done("gables", "plaster")
    for side in (-1, 1):
        arc = [math.pi * (1.0 + k / 10) for k in range(11)]
        points = [
            (x, side * 1.97 + 0.07 * math.cos(a), 2.43 + 0.07 * math.sin(a)) for x in (-2.3, 2.3) for a in arc
        ]
        Shape().faces(points, [(k, k + 1, k + 12, k + 11) for k in range(10)]).done(f"gutter {side}", "iron")
    Shape().box((1.0, 0.55, 3.5), (0.5, 0.5, 1.3)).box((1.0, 0.55, 4.15), (0.62, 0.62, 0.08)).done(
        "chimney", "stone", 0.02, 2
    )
    return {
        "wide": ((4.2, -7.6, 3.6), (0, -0.2, 1.75), 32),
        "close": ((1.7, -3.9, 3.6), (0.2, -1.0, 2.85), 40),
    }


def stair():
    """Six steps between cheeks with balusters, two urns, and paving before them."""
    chance = random.Random(5)
    ground(6.0, 0.03)
    steps = Shape().box((0, 3.2, 0.5), (2.2, 2.0, 0.92))
    for k in range(6):
        steps.box((0, 0.4 + 0.34 * k, 0.08 + 0.16 * k), (2.2, 0.40, 0.16))
    steps.done("steps", "stone", 0.018, 3)
    baluster = [(0.06, 0), (0.06, 0.04), (0.03, 0.08), (0.055, 0.2), (0.03, 0.32), (0.05, 0.36), (0.05, 0.4)]
    urn = [(0.12, 0), (0.12, 0.03), (0.05, 0.06), (0.05, 0.12), (0.14, 0.18), (0.22, 0.32), (0.24, 0.42)]
    urn += [(0.27, 0.45), (0.27, 0.47), (0.235, 0.47), (0.21, 0.42), (0.18, 0.32), (0.1, 0.2), (0.01, 0.18)]
    cheeks = Shape()
    for side in (-1.25, 1.25):
        cheeks.box((side, 1.4, 0.5), (0.22, 2.5, 1.0)).box((side, 1.4, 1.04), (0.32, 2.6, 0.08))
        cheeks.box((side, 1.4, 1.51), (0.2, 2.5, 0.07)).box((side, 0, 0.75), (0.36, 0.36, 1.5))
        cheeks.box((side, 0, 1.53), (0.44, 0.44, 0.07))
        for k in range(7):
            cheeks.lathe((side, 0.35 + 0.35 * k, 1.08), baluster, 12)
        Shape().lathe((side, 0, 1.57), urn, 32).done(f"urn {side}", "stone", smooth=True)
    cheeks.done("cheeks", "stone", 0.012, 2)
    paving = Shape()
    for i in range(5):
        for j in range(3):
            lie = (0, 0, chance.uniform(-0.5, 0.5))
            paving.box((-1.0 + i * 0.505, -0.35 - j * 0.505, 0.015), (0.49, 0.49, 0.06), lie)
    paving.done("paving", "stone", 0.008, 2)
    return {
        "wide": ((2.9, -4.4, 2.5), (0, 0.8, 0.75), 32),
        "close": ((2.35, -1.35, 2.15), (1.1, 0.25, 1.5), 40),
    }


def terrace():
    """A slatted table and bench with a cushion, a chair, a pot and a balustrade of glass on paving."""
    chance = random.Random(8)
    ground(6.0, 0.03, z=-0.06)
    paving = Shape().box((0, 0, -0.07), (3.7, 3.7, 0.06))
    for i in range(36):
        x, y = -1.52 + i % 6 * 0.61, -1.52 + i // 6 * 0.61
        paving.box((x, y, -0.02 + chance.uniform(-0.003, 0.003)), (0.6, 0.6, 0.04))
    paving.done("paving", "stone", 0.006, 2)
    table = Shape()
    for k in range(9):
        table.box((-0.3, -0.14 + k * 0.11, 0.72), (1.5, 0.095, 0.028))
    for y in (-0.1, 0.7):
        table.box((-0.3, y, 0.68), (1.3, 0.04, 0.05))
        for x in (-0.95, 0.35):
            table.box((x, y, 0.35), (0.07, 0.07, 0.7))
    table.done("table", "wood", 0.006, 2)
    bench = Shape()
    for k in range(4):
        bench.box((0.1, -0.98 + k * 0.105, 0.44), (1.5, 0.09, 0.03))
    for k in range(3):
        bench.box((0.1, -1.08 - k * 0.03, 0.56 + k * 0.12), (1.5, 0.025, 0.09), (14, 0, 0))
    for x in (-0.55, 0.75):
        bench.box((x, -1.03, 0.21), (0.06, 0.06, 0.42)).box((x, -0.68, 0.21), (0.06, 0.06, 0.42))
        bench.box((x, -1.12, 0.62), (0.06, 0.05, 0.5), (14, 0, 0)).box((x, -0.85, 0.66), (0.07, 0.5, 0.035))
        bench.box((x, -0.66, 0.53), (0.05, 0.05, 0.24))
    bench.done("bench", "wood", 0.006, 2)
    Shape().box((-0.1, -0.75, 0.52), (0.42, 0.34, 0.11)).done("cushion", "paint", 0.05, 4, smooth=True)
    chair = Shape().box((1.25, 0.5, 0.44), (0.45, 0.45, 0.035)).box((1.47, 0.5, 0.75), (0.03, 0.45, 0.3))
    for x in (1.06, 1.44):
        for y in (0.31, 0.69):
            chair.cone((x, y, 0.22), 0.018, 0.018, 0.44, 10)
    for y in (0.31, 0.69):
        chair.cone((1.46, y, 0.65), 0.014, 0.014, 0.5, 10)
    chair.done("chair", "iron", 0.01, 3)
    pot = [(0.16, 0), (0.2, 0.06), (0.27, 0.38), (0.29, 0.42), (0.26, 0.42), (0.23, 0.34), (0.01, 0.33)]
    Shape().lathe((-1.35, -1.2, 0), pot, 28).done("pot", "tile", smooth=True)
    panes, rail = Shape(), Shape().cone((0, 1.75, 1.02), 0.025, 0.025, 3.7, 12, (0, 90, 0))
    for k in range(5):
        rail.cone((-1.8 + k * 0.9, 1.75, 0.5), 0.022, 0.022, 1.0, 12)
        if k < 4:
            panes.box((-1.35 + k * 0.9, 1.75, 0.55), (0.86, 0.015, 0.8))
    panes.done("panes", "glass")
    rail.done("rail", "iron", smooth=True)
    return {
        "wide": ((3.0, -3.6, 2.2), (0, 0, 0.35), 32),
        "close": ((1.35, -2.15, 1.25), (0, -0.6, 0.5), 36),
    }


def wall():
    """A wall of rough stones beside a pillar, boulders before it, and a fence."""
    chance = random.Random(11)
    ground(6.0, 0.05)
    stones, z = Shape(), 0.0
    for _ in range(5):
        height, x = chance.uniform(0.14, 0.2), -1.7
        while x < 1.65:
            length = min(chance.uniform(0.18, 0.42), 1.7 - x)
            if length > 0.06:
                size = (
                    length - 0.015,
                    0.36 + chance.uniform(-0.03, 0.03),
                    height - chance.uniform(0.006, 0.024),
                )
                lie = [chance.uniform(-2, 2), chance.uniform(-2, 2), chance.uniform(-3, 3)]
                stones.box((x + length / 2, chance.uniform(-0.02, 0.02), z + height / 2), size, lie)
            x += length
        z += height
    stones.done("stones", "stone", 0.02, 2, rough=0.012)
    Shape().box((0, 0, (z - 0.05) / 2), (3.36, 0.26, z - 0.05)).done("mortar", "plaster")
    knob = [(0.1, 0), (0.07, 0.05), (0.13, 0.12), (0.16, 0.2), (0.13, 0.3), (0.01, 0.36)]
    Shape().box((1.98, 0, 0.6), (0.42, 0.42, 1.2)).box((1.98, 0, 1.23), (0.54, 0.54, 0.07)).lathe(
        (1.98, 0, 1.26), knob, 20
    ).done("pillar", "stone", 0.015, 2)
    fence = Shape().box((-2.6, 0.13, 0.25), (1.6, 0.03, 0.06)).box((-2.6, 0.13, 0.7), (1.6, 0.03, 0.06))
    for k in range(14):
        fence.box((-1.9 - k * 0.11, 0.1, 0.45), (0.07, 0.02, 0.9))
    fence.done("fence", "wood", 0.004)
    Shape().ball((-0.6, -0.75, 0.1), 0.25, 8, (1.2, 0.8, 0.7)).ball((0.3, -0.8, 0.06), 0.16, 8).ball(
        (0.7, -0.65, 0.05), 0.12, 8
    ).done("boulders", "stone", smooth=True, rough=0.05)
    return {
        "wide": ((1.7, -4.6, 1.7), (-0.2, 0, 0.5), 30),
        "close": ((1.5, -1.9, 1.35), (0.75, 0, 0.8), 40),
    }


def street():
    """A car at a kerb, with a pavement, bollards, a bin and a railing."""
    ground(7.0, 0.0, "asphalt")
    kerb = Shape()
    for i in range(10):
        kerb.box((-4.5 + i, 1.7, 0.05), (0.99, 0.15, 0.22))
    for i in range(60):
        kerb.box((-4.75 + i % 20 * 0.5, 2.03 + i // 20 * 0.5, 0.07), (0.49, 0.49, 0.16))
    kerb.done("kerb", "stone", 0.012, 2)
    outline = [(-2.0, 0.35), (-2.05, 0.6), (-1.95, 0.85), (-1.3, 0.93), (-0.75, 1.38)]
    outline += [(0.35, 1.42), (1.05, 0.98), (1.9, 0.82), (2.1, 0.6), (2.05, 0.35)]
    points = []
    for y in (-0.85, -0.8, 0.0, 0.8, 0.85):
        for x, z in outline:
            inset = 0.17 * max(0.0, (z - 0.95) / 0.45)
            lower = 0.05 if abs(y) > 0.84 and z > 0.8 else 0.0
            points.append((x - 0.4, math.copysign(max(abs(y) - inset, 0.0), y) + 0.45, z - lower))
    skin = [
        (10 * j + i, 10 * j + i + 1, 10 * j + i + 11, 10 * j + i + 10) for j in range(4) for i in range(9)
    ]
    Shape().faces(points, [*skin, range(10), range(49, 39, -1)]).done(
        "car", "paint", smooth=True, subdivisions=2
    )
    wheels = Shape()
    for x in (-1.65, 0.9):
        for y in (-0.37, 1.27):
            wheels.cone((x, y, 0.32), 0.32, 0.32, 0.2, 24, (90, 0, 0))
    wheels.done("wheels", "iron", 0.03, 2)
    Shape().box((0.33, 0.45, 1.19), (0.02, 1.2, 0.62), (0, -58, 0)).done("windscreen", "glass")
    parts = Shape()
    for y in (-0.05, 0.95):
        parts.cone((-0.55, y, 1.47), 0.018, 0.018, 1.1, 8, (0, 90, 0))
    for x in (-0.95, -0.2):
        parts.box((x, 0.45, 1.47), (0.05, 1.05, 0.025))
    for y in (-0.48, 1.38):
        parts.box((0.25, y, 1.0), (0.12, 0.16, 0.1))
    for x in (1.75, -2.5):
        parts.box((x, 0.45, 0.5), (0.1, 1.5, 0.12))
    parts.done("parts", "iron", 0.012, 2)
    bollards = Shape()
    for x in (-2.4, -0.9, 0.6, 2.1):
        bollards.cone((x, 1.95, 0.55), 0.07, 0.06, 0.9).ball((x, 1.95, 1.02), 0.085, 8)
    bollards.done("bollards", "iron", smooth=True)
    Shape().cone((2.6, 2.1, 0.6), 0.2, 0.22, 0.9, 20).cone((2.6, 2.1, 1.07), 0.25, 0.24, 0.05, 20).done(
        "bin", "iron", 0.01, 2
    )
    railing = Shape()
    for z in (0.35, 1.2):
        railing.box((-0.4, 3.45, z), (6.0, 0.03, 0.04))
    for i in range(22):
        railing.box((-3.2 + i * 0.26, 3.45, 0.75), (0.025, 0.025, 1.2))
    railing.done("railing", "iron", 0.003)
    return {
        "wide": ((3.4, -4.6, 2.3), (-0.2, 0.9, 0.7), 30),
        "close": ((2.6, -2.0, 1.55), (0.7, 0.2, 0.85), 40),
    }


def conifer():
    """A spruce of 24 whorls whose needles are cards, and a seat of wood."""
    chance = random.Random(17)
    ground(5.0, 0.12)
    trunk, needles = Shape().cone((0, 0, 1.7), 0.13, 0.015, 3.4, 14), Shape()
    up = Vector((0.0, 0.0, 1.0))
    for whorl in range(24):
        z = 0.45 + whorl * 0.122
        length, count, base = 1.25 * (1.0 - (z - 0.3) / 3.4) + 0.1, 6 + whorl % 2, Vector((0.0, 0.0, z))
        for k in range(count):
            around = 2.0 * math.pi * (k + 0.37 * whorl + chance.uniform(-0.1, 0.1)) / count
            droop = math.radians(chance.uniform(-18.0, 2.0))
            out = Vector(
                (math.cos(around) * math.cos(droop), math.sin(around) * math.cos(droop), math.sin(droop))
            )
            turn = [math.degrees(angle) for angle in out.to_track_quat("Z", "Y").to_euler()]
            trunk.cone(base + out * length / 2, 0.022 * length + 0.004, 0.003, length, 6, turn)
            side = out.cross(up).normalized()
            for i in range(int(length * 22)):
                part = 0.15 + 0.85 * i / int(length * 22)
                at, own = base + out * length * part, 0.32 * (1.12 - part) * length**0.5 + 0.06
                lift = side.cross(out) * chance.uniform(-0.12, 0.25)
                way = (out * 0.8 + side * (-1) ** i + lift).normalized()
                wide = way.cross(up).normalized() * 0.032
                tip = at + way * own
                needles.faces((at - wide, at + wide, tip + wide * 0.3, tip - wide * 0.3), ((0, 1, 2, 3),))
    trunk.done("trunk", "bark", smooth=True)
    needles.done("needles", "needle")
    seat = Shape().box((1.3, -0.9, 0.25), (0.9, 0.28, 0.06))
    for x in (1.0, 1.6):
        seat.box((x, -0.9, 0.1), (0.06, 0.24, 0.26))
    seat.done("seat", "wood", 0.01, 2)
    return {
        "wide": ((3.4, -4.9, 2.4), (0, 0, 1.5), 32),
        "close": ((1.5, -2.0, 1.7), (0.35, -0.3, 1.15), 42),
    }


SCENES = {made.__name__: made for made in (house, stair, terrace, wall, street, conifer)}


# -- snow and pictures ---------------------------------------------------------------------------------------


def ours(objects, depth, root):
    sys.path[:0] = [str(root / "addon"), str(root / "build" / "python")]
    import snowbough

    snowbough.register()
    scene = bpy.context.scene
    for obj in objects:
        obj.select_set(True)
    bpy.context.view_layer.objects.active = objects[0]
    begun = time.monotonic()
    bpy.ops.snowbough.add_receivers()
    scene.snowbough.end_depth, scene.snowbough.cache_directory = depth, tempfile.mkdtemp()
    if bpy.ops.snowbough.bake() != {"FINISHED"}:
        raise RuntimeError("the bake did not finish")
    scene.frame_set(FRAMES)
    return time.monotonic() - begun


def real(objects, depth, _root):
    import addon_utils

    if addon_utils.enable("real_snow") is None:
        raise SystemExit("beside_real_snow: this Blender has no add-on Real Snow")
    scene = bpy.context.scene
    scene.snow.height = max(depth, REAL_MIN)
    random.seed(1)
    begun = time.monotonic()
    for obj in objects:
        if obj.name == "ground":
            raised = obj.copy()
            raised.data = obj.data.copy()
            raised.data.materials[0] = material("snow")
            raised.location.z += 0.45 * depth
            scene.collection.objects.link(raised)
            continue
        bpy.ops.object.select_all(action="DESELECT")
        obj.select_set(True)
        bpy.context.view_layer.objects.active = obj
        bpy.ops.snow.create()
    return time.monotonic() - begun


def light():
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("sky")
    scene.world.use_nodes = True
    sky = scene.world.node_tree.nodes["Background"].inputs
    sky["Color"].default_value, sky["Strength"].default_value = (0.45, 0.6, 0.85, 1.0), 0.55
    sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    sun.data.energy, sun.data.angle, sun.data.color = 3.2, 0.01, (1.0, 0.93, 0.83)
    sun.rotation_euler = (math.radians(55.0), 0.0, math.radians(40.0))
    scene.collection.objects.link(sun)


def render(path, view, size, samples):
    eye, target, lens = view
    scene = bpy.context.scene
    scene.camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    scene.collection.objects.link(scene.camera)
    scene.camera.data.lens, scene.camera.location = lens, eye
    scene.camera.rotation_euler = (Vector(target) - Vector(eye)).to_track_quat("-Z", "Y").to_euler()
    scene.render.engine, scene.cycles.samples = "CYCLES", samples
    scene.cycles.use_denoising, scene.cycles.max_bounces = False, 4
    scene.view_settings.view_transform, scene.view_settings.look = "Filmic", "Medium High Contrast"
    scene.render.resolution_x, scene.render.resolution_y = (int(side) for side in size.split("x"))
    scene.render.resolution_percentage = 100
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)


def main():
    options = arguments()
    bpy.ops.wm.read_homefile(use_empty=True)
    noise.seed_set(7)
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, FRAMES
    views = SCENES[options.scene]()
    objects = [obj for obj in scene.objects if obj.type == "MESH"]
    bpy.context.view_layer.update()
    seconds = {"ours": ours, "real": real}[options.program](objects, options.depth, options.root)
    print(f"{options.scene} {options.program} {options.depth:g} m: {seconds:.1f} s", flush=True)
    light()
    options.out.mkdir(parents=True, exist_ok=True)
    for name in options.views.split(","):
        path = f"{options.scene}_{options.program}_{round(100 * options.depth):02d}_{name}.png"
        render(options.out / path, views[name], options.size, options.samples)


main()
