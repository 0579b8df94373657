# SPDX-License-Identifier: GPL-3.0-or-later
"""Snow on shapes as modellers make them, beside a plain twin of each: bevels, joints, slats, tiles.

    blender -b --factory-startup --python-exit-code 1 -P benchmarks/snow/real_shapes.py -- [--depth 0.2]
        [--root CHECKOUT] [--only tiles,slats]

Each shape goes the artist's way: Add Snow (which unwraps it), Bake Snow over 16 frames, the drawn surface of the last
one. A ray falls every centimetre, away from the outer rims of what lies level; the thickness is from the first bare
face under it up to what is drawn there. The table has mean and 5 % quantile of the thickness in millimetres, the points
of the surface, and the mean as a share of the twin's. The peer is Blender's own add-on Real Snow with the same height,
where it is installed. --root: another built checkout.
"""

import argparse
import math
import random
import sys
import tempfile
from pathlib import Path

import bmesh
import bpy
import numpy as np
from mathutils import Matrix, Vector
from mathutils.bvhtree import BVHTree

FRAMES, TEXEL, SEED = 16, 0.01, 1


def arguments():
    parser = argparse.ArgumentParser(prog="real_shapes.py")
    parser.add_argument("--depth", type=float, default=0.2)
    parser.add_argument("--root", default=str(Path(__file__).resolve().parents[2]))
    parser.add_argument("--only", help="names of shapes, with commas between them")
    return parser.parse_args(sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else [])


def boxes(name, items, bevel=0.0, segments=1):
    """One object of boxes (centre, size, pitch in degrees about x), in metres."""
    form = bmesh.new()
    for centre, size, pitch in items:
        corners = bmesh.ops.create_cube(form, size=1.0)["verts"]
        turn = Matrix.Rotation(math.radians(pitch), 4, "X")
        bmesh.ops.transform(
            form, matrix=Matrix.Translation(centre) @ turn @ Matrix.Diagonal((*size, 1.0)), verts=corners
        )
    mesh = bpy.data.meshes.new(name)
    form.to_mesh(mesh)
    obj = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(obj)
    if bevel:
        modifier = obj.modifiers.new("Bevel", "BEVEL")
        modifier.width, modifier.segments = bevel, segments
        bpy.context.view_layer.objects.active = obj
        bpy.ops.object.modifier_apply(modifier=modifier.name)
    return obj


def tiles(bevel):
    """Eight courses of 22 cm under 40 degrees, steps of 3 cm."""
    pitch, length, step, items = math.radians(40.0), 0.22, 0.03, []
    up, out = (
        Vector((0.0, math.cos(pitch), math.sin(pitch))),
        Vector((0.0, -math.sin(pitch), math.cos(pitch))),
    )
    tilt = math.atan2(step, length)
    lie = pitch - tilt
    along = Vector((0.0, math.cos(lie), math.sin(lie)))
    across = Vector((0.0, -math.sin(lie), math.cos(lie)))
    for course in range(8):
        lower = up * course * length + out * step
        items.append(
            (lower + along * 0.6 * length - across * 0.5 * step, (0.9, 1.2 * length, step), math.degrees(lie))
        )
    return boxes("Tiles", items, bevel)


def roof_slab():
    pitch = math.radians(40.0)
    middle = Vector((0.0, math.cos(pitch), math.sin(pitch))) * 0.88
    return boxes("Slab", [(middle - Vector((0.0, 0.0, 0.02)), (0.9, 1.76, 0.04), 40.0)])


def paving(bevel):
    """Nine stones of 60 cm, joints of 1.5 cm over a bed 4 cm below."""
    places = [(i - 1) * 0.615 for i in range(3)]
    stones = [((x, y, -0.02), (0.6, 0.6, 0.04), 0.0) for x in places for y in places]
    return boxes("Paving", [*stones, ((0.0, 0.0, -0.06), (1.83, 1.83, 0.04), 0.0)], bevel)


def wall(bevel):
    """Four rows of stones of 20 to 36 cm, joints of 2 cm."""
    chance, items = random.Random(SEED), []
    for row in range(4):
        x = -0.8
        while x < 0.8:
            width = min(chance.uniform(0.2, 0.36), 0.8 - x)
            if width > 0.05:
                items.append(((x + 0.5 * width, 0.0, 0.08 + 0.17 * row), (width, 0.3, 0.15), 0.0))
            x += width + 0.02
    return boxes("Wall", items, bevel)


def slats(bevel, segments=1):
    """Six slats of 6 cm, gaps of 1.5 cm."""
    return boxes(
        "Slats",
        [((0.0, (i - 2.5) * 0.075, 0.49), (1.4, 0.06, 0.025), 0.0) for i in range(6)],
        bevel,
        segments,
    )


def block(bevel=0.0, segments=1):
    return boxes("Block", [((0.0, 0.0, 0.25), (0.8, 0.8, 0.5), 0.0)], bevel, segments)


def plain(size, top):
    """A box of this length and width with its top there."""
    return boxes("Plain", [((0.0, 0.0, top - 0.02), (*size, 0.04), 0.0)])


# name: (shape, its plain twin, half of the measured length and width, middle of it)
SHAPES = {
    "tiles": (lambda: tiles(0.0), roof_slab, (0.35, 0.5), 0.7),
    "tiles, bevelled": (lambda: tiles(0.004), roof_slab, (0.35, 0.5), 0.7),
    "paving": (lambda: paving(0.0), lambda: plain((1.83, 1.83), 0.0), (0.7, 0.7), 0.0),
    "paving, bevelled": (lambda: paving(0.008), lambda: plain((1.83, 1.83), 0.0), (0.7, 0.7), 0.0),
    "wall": (lambda: wall(0.0), lambda: plain((1.6, 0.3), 0.665), (0.7, 0.13), 0.0),
    "wall, bevelled": (lambda: wall(0.015), lambda: plain((1.6, 0.3), 0.665), (0.7, 0.13), 0.0),
    "slats": (lambda: slats(0.0), lambda: plain((1.4, 0.435), 0.5), (0.6, 0.2), 0.0),
    "slats, bevelled": (lambda: slats(0.004), lambda: plain((1.4, 0.435), 0.5), (0.6, 0.2), 0.0),
    "slats, bevel of 2": (lambda: slats(0.006, 2), lambda: plain((1.4, 0.435), 0.5), (0.6, 0.2), 0.0),
    "bevel of 1": (lambda: block(0.02, 1), block, (0.39, 0.39), 0.0),
    "bevel of 2": (lambda: block(0.02, 2), block, (0.39, 0.39), 0.0),
    "bevel of 3": (lambda: block(0.02, 3), block, (0.39, 0.39), 0.0),
    "rounded by 8": (lambda: block(0.06, 8), block, (0.39, 0.39), 0.0),
}


def tree_of(objects):
    """All evaluated faces of some objects, for rays."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    points, faces = [], []
    for obj in objects:
        evaluated = obj.evaluated_get(depsgraph)
        mesh, first = evaluated.to_mesh(), len(points)
        points += [evaluated.matrix_world @ vertex.co for vertex in mesh.vertices]
        faces += [[first + index for index in polygon.vertices] for polygon in mesh.polygons]
    return BVHTree.FromPolygons(points, faces)


def thickness(bare, drawn, half, middle):
    """Millimetres of snow over the first bare face under each ray, (N,)."""
    found, down = [], Vector((0.0, 0.0, -1.0))
    for x in np.arange(-half[0], half[0], TEXEL):
        for y in np.arange(middle - half[1], middle + half[1], TEXEL):
            above = Vector((x, y, 9.0))
            ground, top = bare.ray_cast(above, down)[0], drawn.ray_cast(above, down)[0]
            if ground is not None:
                found.append(1000.0 * max(0.0, top.z - ground.z))
    return np.array(found)


def ours(make, depth):
    """(bare object, the objects that are drawn, points of the surface)."""
    scene = bpy.context.scene
    obj = make()
    obj.select_set(True)
    bpy.context.view_layer.objects.active = obj
    bpy.ops.snowbough.add_receivers()
    area = sum(polygon.area for polygon in obj.data.polygons)
    settings = scene.snowbough
    # Charts cover about half of a map.
    settings.receivers[0].resolution = 2 ** math.ceil(math.log2(math.sqrt(2.0 * area) / TEXEL))
    settings.end_depth, settings.cache_directory = depth, tempfile.mkdtemp()
    bpy.ops.snowbough.bake()
    scene.frame_set(FRAMES)
    surface = bpy.data.objects[f"{obj.name} Snow"]
    return obj, [obj, surface], len(surface.data.vertices)


def peers(make, depth):
    """The same of Real Snow, or None if it is not installed."""
    import addon_utils

    if addon_utils.enable("real_snow") is None:
        return None
    obj = make()
    obj.select_set(True)
    bpy.context.view_layer.objects.active = obj
    bpy.context.scene.snow.height = depth
    before = set(bpy.data.objects)
    bpy.ops.snow.create()
    made = [new for new in set(bpy.data.objects) - before if new.type == "MESH"]
    return obj, [obj, *made], sum(len(new.data.vertices) for new in made)


def measured(program, make, depth, half, middle):
    """(mean, 5 % quantile, points), or None."""
    bpy.ops.wm.read_homefile(use_empty=True)
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 1, FRAMES
    made = program(make, depth)
    if made is None:
        return None
    obj, drawn, points = made
    found = thickness(tree_of([obj]), tree_of(drawn), half, middle)
    return found.mean(), np.quantile(found, 0.05), points


def main():
    options = arguments()
    root = Path(options.root)
    sys.path[:0] = [str(root / "addon"), str(root / "build" / "python")]
    import snowbough

    snowbough.register()
    rows = [
        f"| {'shape':18} | mean / 5 % | points | of twin | Real Snow | of its twin |",
        "|---|---|---|---|---|---|",
    ]
    twins = {}
    for name, (shape, twin, half, middle) in SHAPES.items():
        if options.only and name.split(",")[0] not in options.only.split(","):
            continue
        cells = [f"{name:18}"]
        for program in (ours, peers):
            got = measured(program, shape, options.depth, half, middle)
            if got is None:
                cells += ["not installed", ""]
                continue
            key = (program, name.split(",")[0].split(" of ")[0])
            if key not in twins:
                twins[key] = measured(program, twin, options.depth, half, middle)[0]
            cells.append(f"{got[0]:.0f} / {got[1]:.0f}")
            cells += [str(got[2])] if program is ours else []
            cells.append(f"{got[0] / max(twins[key], 1e-9):.2f}")
        rows.append(f"| {' | '.join(cells)} |")
        print(rows[-1], flush=True)
    print("\n".join(["", f"{100.0 * options.depth:g} cm of snow", "", *rows]))


main()
