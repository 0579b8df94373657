# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders a small scene with snow by Snowbough or by Blender's Real Snow add-on: same camera, light and depth.

    blender -b --factory-startup --python-exit-code 1 -P benchmarks/snow/look_scenes.py -- SCENE FILE.png
        [--peer] [--frames 12] [--close] [--samples 32] [--blend FILE.blend]

SCENE: box (a box and a monkey), bench (a garden bench), limb (a limb of a maple, 30 cm away), roof (a roof with fence
and posts), spruce (twigs with needles). --peer: Real Snow, which comes with Blender up to 4.1. --close: the scene's
second camera, 10 cm away. The script makes pictures; look.py measures.
"""

import argparse
import math
import random
import sys
import tempfile
import time
from pathlib import Path

import bpy
from mathutils import Matrix, Vector

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "addon"))
import snowbough  # noqa: E402

SIZE = (900, 620)


def arguments():
    parser = argparse.ArgumentParser(prog="look_scenes.py")
    parser.add_argument("scene", choices=sorted(SCENES))
    parser.add_argument("file")
    parser.add_argument("--peer", action="store_true")
    parser.add_argument("--frames", type=int, default=12)
    parser.add_argument("--close", action="store_true")
    parser.add_argument("--samples", type=int, default=32)
    parser.add_argument("--blend")
    return parser.parse_args(sys.argv[sys.argv.index("--") + 1 :])


# -- parts ------------------------------------------------------------------------------------------------


def paint(thing, name, colour, roughness=0.7):
    material = bpy.data.materials.get(name)
    if material is None:
        material = bpy.data.materials.new(name)
        material.use_nodes = True
        shader = material.node_tree.nodes["Principled BSDF"]
        shader.inputs["Base Color"].default_value = (*colour, 1.0)
        shader.inputs["Roughness"].default_value = roughness
    thing.data.materials.append(material)
    return thing


WOOD = ("wood", (0.36, 0.22, 0.10))
BARK = ("bark", (0.16, 0.11, 0.08))
GRASS = ("grass", (0.05, 0.10, 0.05))
IRON = ("iron", (0.04, 0.045, 0.05), 0.4)
TILES = ("tiles", (0.30, 0.09, 0.06))
NEEDLE = ("needle", (0.03, 0.09, 0.03))


def ground(size=6.0, cells=60):
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=cells, y_subdivisions=cells, size=size)
    bpy.context.object.name = "Ground"
    return paint(bpy.context.object, *GRASS)


def block(name, size, at, look=WOOD, turn=(0.0, 0.0, 0.0)):
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=at, rotation=turn)
    made = bpy.context.object
    made.name, made.scale = name, size
    bpy.ops.object.transform_apply(location=False, rotation=False, scale=True)
    return paint(made, *look)


def post(name, radius, height, at, look=WOOD):
    bpy.ops.mesh.primitive_cylinder_add(
        radius=radius, depth=height, vertices=32, location=(at[0], at[1], 0.5 * height)
    )
    made = bpy.context.object
    made.name = name
    bpy.ops.object.shade_smooth()
    made.data.use_auto_smooth = True
    return paint(made, *look)


def joined(name, parts):
    bpy.ops.object.select_all(action="DESELECT")
    for part in parts:
        part.select_set(True)
    bpy.context.view_layer.objects.active = parts[0]
    bpy.ops.object.join()
    parts[0].name = name
    return parts[0]


def camera(at, to, lens=50.0):
    data = bpy.data.cameras.new("Camera")
    data.lens, data.clip_start = lens, 0.01
    made = bpy.data.objects.new("Camera", data)
    bpy.context.scene.collection.objects.link(made)
    made.location = at
    made.rotation_euler = (Vector(to) - Vector(at)).to_track_quat("-Z", "Y").to_euler()
    bpy.context.scene.camera = made


def light(turn=(50.0, 8.0, 35.0)):
    sun = bpy.data.lights.new("Sun", "SUN")
    sun.energy, sun.angle, sun.color = 3.0, math.radians(2.0), (1.0, 0.93, 0.84)
    made = bpy.data.objects.new("Sun", sun)
    made.rotation_euler = [math.radians(angle) for angle in turn]
    bpy.context.scene.collection.objects.link(made)
    world = bpy.context.scene.world = bpy.data.worlds.new("World")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs[0].default_value = (0.42, 0.48, 0.58, 1.0)
    world.node_tree.nodes["Background"].inputs[1].default_value = 0.9


# -- scenes: each returns what snow falls on, its depth in metres, and two cameras --------------------------


def box_and_monkey():
    things = [ground(), block("Box", (1.0, 1.0, 1.0), (-1.0, 0.0, 0.5))]
    bpy.ops.mesh.primitive_monkey_add(size=1.6, location=(1.0, 0.3, 1.0))
    monkey = bpy.context.object
    monkey.modifiers.new("Subdivision", "SUBSURF").render_levels = 2
    bpy.ops.object.shade_smooth()
    paint(monkey, *WOOD)
    return (
        [*things, monkey],
        0.12,
        ((1.2, -5.2, 2.6), (0.1, 0.0, 0.7)),
        ((-0.1, -1.35, 1.35), (-0.6, -0.4, 1.0)),
    )


def bench():
    parts = [block("slat", (1.5, 0.07, 0.03), (0.0, 0.02 + 0.09 * i, 0.45)) for i in range(5)]
    for i in range(4):
        parts.append(
            block("rest", (1.5, 0.025, 0.08), (0.0, 0.43 + 0.03 * i, 0.56 + 0.11 * i), turn=(-0.25, 0.0, 0.0))
        )
    wood = joined("Bench", parts)
    legs = []
    for x in (-0.65, 0.65):
        legs.append(block("leg", (0.05, 0.05, 0.45), (x, 0.0, 0.22), IRON))
        legs.append(block("leg", (0.05, 0.05, 0.95), (x, 0.50, 0.47), IRON, (-0.12, 0.0, 0.0)))
        legs.append(block("arm", (0.06, 0.55, 0.03), (x, 0.24, 0.66), IRON))
        legs.append(block("arm", (0.04, 0.04, 0.22), (x, 0.0, 0.55), IRON))
    iron = joined("Iron", legs)
    bpy.ops.mesh.primitive_torus_add(
        major_radius=0.25, minor_radius=0.06, location=(1.2, 0.2, 0.25), rotation=(1.35, 0.0, 0.5)
    )
    bpy.ops.object.shade_smooth()
    tyre = paint(bpy.context.object, *IRON)
    return (
        [ground(5.0), wood, iron, tyre],
        0.10,
        ((1.3, -2.5, 1.45), (0.15, 0.2, 0.4)),
        ((0.55, -0.5, 0.8), (0.2, 0.15, 0.5)),
    )


def limb():
    """A limb of the demo's maple: a length of crooked wood with forks, an arm's length of it in the picture."""
    sys.path.insert(0, str(ROOT / "blend_samples"))
    import grow_tree

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "maple.obj"
        grow_tree.main(["--species", "maple", "--seed", "3", "--height", "5", "--leaves", str(path)])
        bpy.ops.import_scene.xfrog_tree(filepath=str(path), max_bones=40)
    bark = next(o for o in bpy.data.objects if o.name.endswith("_bark"))
    leaves = next((o for o in bpy.data.objects if o.name.endswith("_leaves")), None)
    # The nearest low outer fork seen from the front.
    points = [bark.matrix_world @ v.co for v in bark.data.vertices]
    low = [p for p in points if 1.6 < p.z < 3.0 and math.hypot(p.x, p.y) > 0.8]
    aim = min(low, key=lambda p: p.y)
    eye = aim + Vector((0.25, -0.5, 0.25))
    near = aim + Vector((0.08, -0.18, 0.1))
    things = [bark] + ([leaves] if leaves else [])
    return things, 0.05, (eye, aim), (near, aim)


def roof():
    parts = []
    for side in (-1.0, 1.0):
        parts.append(
            block(
                "slope",
                (2.4, 1.15, 0.05),
                (0.0, side * 0.44, 1.75),
                TILES,
                (-side * math.radians(40.0), 0.0, 0.0),
            )
        )
    top = joined("Roof", parts)
    walls = block("Walls", (2.1, 1.4, 1.45), (0.0, 0.0, 0.72), ("wall", (0.55, 0.50, 0.42)))
    pickets = [block("picket", (0.08, 0.025, 0.8), (-2.0 + 0.16 * i, -1.6, 0.45)) for i in range(26)]
    pickets += [block("rail", (4.2, 0.03, 0.07), (0.0, -1.57, z)) for z in (0.3, 0.68)]
    fence = joined("Fence", pickets)
    posts = joined("Posts", [post("post", 0.06, 1.0, (x, -1.56)) for x in (-2.15, 0.0, 2.15)])
    return (
        [ground(7.0, 70), top, walls, fence, posts],
        0.12,
        ((1.9, -4.6, 2.5), (0.1, -0.4, 0.9)),
        ((0.35, -2.15, 1.25), (0.02, -1.56, 0.95)),
    )


def spruce():
    """Three twigs, a hand long, with needles as thin prisms; a hundred times finer than a roof."""
    randoms = random.Random(5)
    vertices, faces, twigs = [], [], []

    def prism(start, end, radius, sides):
        axis = (end - start).normalized()
        across = axis.orthogonal().normalized()
        first = len(vertices)
        for point, width in ((start, radius), (end, 0.35 * radius)):
            for side in range(sides):
                turn = Matrix.Rotation(2.0 * math.pi * side / sides, 3, axis)
                vertices.append(point + turn @ across * width)
        for side in range(sides):
            after = (side + 1) % sides
            faces.append((first + side, first + after, first + sides + after, first + sides + side))
        faces.append(tuple(first + side for side in reversed(range(sides))))
        faces.append(tuple(first + sides + side for side in range(sides)))

    def twig(start, end):
        prism(start, end, 0.0035, 10)
        axis = (end - start).normalized()
        for i in range(int((end - start).length / 0.0011)):
            at = start.lerp(end, i * 0.0011 / (end - start).length)
            turn = Matrix.Rotation(2.4 * i, 3, axis)
            out = (turn @ axis.orthogonal().normalized() + 0.8 * axis).normalized()
            prism(at, at + out * randoms.uniform(0.011, 0.015), 0.0006, 4)

    root = Vector((-0.12, 0.0, 0.02))
    tip = Vector((0.12, 0.0, 0.0))
    twig(root, tip)
    for along, side in ((0.3, 1.0), (0.45, -1.0), (0.62, 1.0), (0.75, -1.0)):
        begin = root.lerp(tip, along)
        twig(begin, begin + Vector((0.06, 0.055 * side, -0.005)) * (1.15 - along))
    mesh = bpy.data.meshes.new("Spruce")
    mesh.from_pydata([tuple(v) for v in vertices], [], faces)
    made = bpy.data.objects.new("Spruce", mesh)
    bpy.context.scene.collection.objects.link(made)
    paint(made, *NEEDLE)
    twigs.append(made)
    return twigs, 0.012, ((0.06, -0.26, 0.16), (0.0, 0.0, 0.0)), ((0.05, -0.1, 0.07), (0.02, 0.0, 0.01))


SCENES = {"box": box_and_monkey, "bench": bench, "limb": limb, "roof": roof, "spruce": spruce}


# -- snow -------------------------------------------------------------------------------------------------


def unwrap(things):
    for thing in things:
        if any(layer.name == "snow" for layer in thing.data.uv_layers):
            continue
        bpy.ops.object.select_all(action="DESELECT")
        thing.select_set(True)
        bpy.context.view_layer.objects.active = thing
        while thing.data.uv_layers:
            thing.data.uv_layers.remove(thing.data.uv_layers[0])
        thing.data.uv_layers.new(name="UVMap")
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="SELECT")
        bpy.ops.uv.smart_project(island_margin=0.003)
        bpy.ops.object.mode_set(mode="OBJECT")


def snow_by_snowbough(things, depth, folder):
    unwrap(things)
    bpy.ops.object.select_all(action="DESELECT")
    for thing in things:
        thing.select_set(True)
    bpy.ops.snowbough.add_receivers()
    settings = bpy.context.scene.snowbough
    settings.end_depth = depth
    settings.cache_directory = folder
    bpy.ops.snowbough.bake()
    bpy.ops.snowbough.setup_material()
    bpy.ops.snowbough.setup_displacement()


def snow_by_real_snow(things, depth):
    bpy.ops.preferences.addon_enable(module="real_snow")
    for thing in things:
        bpy.ops.object.select_all(action="DESELECT")
        thing.select_set(True)
        bpy.context.view_layer.objects.active = thing
        bpy.context.scene.snow.coverage = 100
        bpy.context.scene.snow.height = max(0.1, 2.0 * depth)
        bpy.ops.snow.create()


def main():
    options = arguments()
    bpy.ops.wm.read_homefile(use_empty=True)
    snowbough.register()
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, options.frames
    things, depth, far, near = SCENES[options.scene]()
    camera(*(near if options.close else far))
    light()
    began = time.perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        if options.peer:
            snow_by_real_snow(things, depth)
        else:
            snow_by_snowbough(things, depth, folder)
        print(f"snow: {time.perf_counter() - began:.1f} s")
        scene.frame_set(options.frames)
        scene.render.engine = "CYCLES"
        scene.cycles.samples, scene.cycles.use_denoising = options.samples, False
        scene.render.resolution_x, scene.render.resolution_y = SIZE
        scene.render.filepath = options.file
        scene.view_settings.view_transform = "Filmic"
        if options.blend:
            bpy.ops.wm.save_as_mainfile(filepath=options.blend)
        began = time.perf_counter()
        bpy.ops.render.render(write_still=True)
        print(f"render: {time.perf_counter() - began:.1f} s")


main()
