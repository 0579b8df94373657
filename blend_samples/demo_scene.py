# SPDX-License-Identifier: GPL-3.0-or-later
"""The stage of the demo: a knoll, a bench, a cart that drives off, winter light and a camera.

`build_stage()` makes the stage in the current file and returns the receivers of snow. All meshes are modelled here from
boxes, discs and grids, in metres, Z up; the tree stands at the origin. Used by demo.py; needs no add-on.
"""

import math
from dataclasses import dataclass

import bmesh
import bpy
import numpy as np
from mathutils import Matrix, Vector

FRAMES = 48
# The cart waits under the tree, then drives off between these frames.
CART_LEAVES, CART_STOPS = 29, 49
CART_FROM, CART_TO = Vector((0.95, -1.35, 0.0)), Vector((3.2, -2.15, 0.0))
WHEEL_RADIUS = 0.34
# How far below the knoll the far forest stands.
FOREST_DEPTH = 8.5


@dataclass
class Stage:
    """What build_stage made: the meshes that receive snow, and the cart that moves one of them."""

    ground: bpy.types.Object
    bench: bpy.types.Object
    cart: bpy.types.Object
    wheels: list
    camera: bpy.types.Object
    # Scenery without snow.
    backdrop: list


# --------------------------------------------------------------------------------------------------
# Materials


def make_material(name, colour, roughness=0.8, mottle=0.0, scale=4.0, bump=0.0, stretch=(1.0, 1.0, 1.0)):
    """A plain surface whose brightness varies with noise in object space."""
    material = bpy.data.materials.new(name)
    if bpy.app.version < (5, 0, 0):
        material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    shader = next(node for node in nodes if node.type == "BSDF_PRINCIPLED")
    shader.inputs["Roughness"].default_value = roughness
    shader.inputs["Base Color"].default_value = (*colour, 1.0)
    if mottle or bump:
        coordinates, mapping = nodes.new("ShaderNodeTexCoord"), nodes.new("ShaderNodeMapping")
        noise, ramp = nodes.new("ShaderNodeTexNoise"), nodes.new("ShaderNodeValToRGB")
        mapping.inputs["Scale"].default_value = stretch
        noise.inputs["Scale"].default_value = scale
        noise.inputs["Detail"].default_value = 6.0
        ramp.color_ramp.elements[0].position, ramp.color_ramp.elements[1].position = 0.30, 0.72
        for element, factor in zip(ramp.color_ramp.elements, (1.0 - mottle, 1.0 + mottle)):
            element.color = (*(channel * factor for channel in colour), 1.0)
        links.new(coordinates.outputs["Object"], mapping.inputs["Vector"])
        links.new(mapping.outputs["Vector"], noise.inputs["Vector"])
        links.new(noise.outputs[0], ramp.inputs["Fac"])
        links.new(ramp.outputs["Color"], shader.inputs["Base Color"])
        if bump:
            bumps = nodes.new("ShaderNodeBump")
            bumps.inputs["Strength"].default_value = bump
            bumps.inputs["Distance"].default_value = 0.02
            links.new(noise.outputs[0], bumps.inputs["Height"])
            links.new(bumps.outputs["Normal"], shader.inputs["Normal"])
    return material


# --------------------------------------------------------------------------------------------------
# Geometry


def add_box(mesh, centre, size, turn=None, cell=0.06):
    """Adds a box with its faces cut into cells of about `cell` metres, which snow can raise."""
    matrix = Matrix.Translation(centre) @ (turn.to_4x4() if turn else Matrix())
    for axis in range(3):
        across, up = [(1, 2), (2, 0), (0, 1)][axis]
        columns, rows = (max(1, round(size[i] / cell)) for i in (across, up))
        for side in (-1.0, 1.0):
            grid = []
            for row in range(rows + 1):
                for column in range(columns + 1):
                    corner = Vector((0.0, 0.0, 0.0))
                    corner[axis] = side * size[axis] / 2.0
                    corner[across] = (column / columns - 0.5) * size[across] * side
                    corner[up] = (row / rows - 0.5) * size[up]
                    grid.append(mesh.verts.new(matrix @ corner))
            for row in range(rows):
                for column in range(columns):
                    first = row * (columns + 1) + column
                    mesh.faces.new(
                        [grid[i] for i in (first, first + 1, first + columns + 2, first + columns + 1)]
                    )


def add_disc(mesh, centre, inner, outer, width, sides=40):
    """Adds a ring about the Y axis: a wheel's rim, its hub with inner = 0."""
    rings = []
    for radius in (inner, outer):
        for offset in (-width / 2.0, width / 2.0):
            rings.append(
                [
                    mesh.verts.new(centre + Vector((radius * math.cos(a), offset, radius * math.sin(a))))
                    for a in (2.0 * math.pi * side / sides for side in range(sides))
                ]
            )
    inner_left, inner_right, outer_left, outer_right = rings
    walls = [(outer_left, outer_right), (inner_left, outer_left), (outer_right, inner_right)]
    if inner > 0.0:
        walls.append((inner_right, inner_left))
    for first, second in walls:
        for side in range(sides):
            after = (side + 1) % sides
            mesh.faces.new((first[after], first[side], second[side], second[after]))


def finish_object(mesh, name, material, merge=1e-5):
    """Turns a bmesh into an object of the scene, its box edges welded so that snow cannot tear them."""
    bmesh.ops.remove_doubles(mesh, verts=mesh.verts, dist=merge)
    bmesh.ops.dissolve_degenerate(mesh, edges=mesh.edges, dist=merge)
    bmesh.ops.recalc_face_normals(mesh, faces=mesh.faces)
    data = bpy.data.meshes.new(name)
    mesh.to_mesh(data)
    mesh.free()
    data.materials.append(material)
    made = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(made)
    return made


def unwrap(target):
    """Unwraps every flat side without overlaps, as snow maps need it."""
    bpy.ops.object.select_all(action="DESELECT")
    target.select_set(True)
    bpy.context.view_layer.objects.active = target
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.uv.smart_project(angle_limit=math.radians(50.0), island_margin=0.006)
    bpy.ops.object.mode_set(mode="OBJECT")
    target.select_set(False)


def knoll(x, y):
    """Height of the ground: gentle waves that fall away all around, so that it ends in the sky."""
    distance = np.hypot(x, y)
    waves = 0.05 * np.sin(0.55 * x + 0.8) * np.cos(0.47 * y) + 0.035 * np.sin(0.9 * y + 0.31 * x)
    return waves * np.clip(distance / 4.0, 0.0, 1.0) - 0.012 * np.maximum(distance - 5.0, 0.0) ** 2


def make_ground(material, half=14.0, lines=201):
    """A square grid, fine in the middle and coarse far out; its UVs are as dense as its lines."""
    even = np.linspace(-1.0, 1.0, lines)
    stretched = half * (0.42 * even + 0.58 * even**3)
    x, y = np.meshgrid(stretched, stretched)
    vertices = np.stack([x, y, knoll(x, y)], axis=-1).reshape(-1, 3)
    first = (np.arange(lines - 1)[:, None] * lines + np.arange(lines - 1)).reshape(-1)
    quads = np.stack([first, first + 1, first + lines + 1, first + lines], axis=1)
    data = bpy.data.meshes.new("ground")
    data.from_pydata(vertices.tolist(), [], quads.tolist())
    uv = np.stack(np.meshgrid(even, even), axis=-1).reshape(-1, 2)[quads.reshape(-1)]
    layer = data.uv_layers.new(name="snow")
    layer.data.foreach_set("uv", (0.002 + 0.996 * (0.5 + 0.5 * uv)).astype(np.float32).reshape(-1))
    data.polygons.foreach_set("use_smooth", [True] * len(data.polygons))
    data.materials.append(material)
    made = bpy.data.objects.new("ground", data)
    bpy.context.scene.collection.objects.link(made)
    return made


def make_bench(material):
    """A park bench of slats, 1.7 m wide."""
    mesh = bmesh.new()
    for slat in range(4):
        add_box(mesh, Vector((0.0, -0.21 + 0.14 * slat, 0.45)), (1.7, 0.105, 0.035), cell=0.035)
    lean = Matrix.Rotation(math.radians(-14.0), 3, "X")
    for slat in range(3):
        height = 0.16 + 0.15 * slat
        add_box(
            mesh,
            Vector((0.0, 0.30, 0.47)) + lean @ Vector((0.0, 0.0, height)),
            (1.7, 0.032, 0.105),
            lean,
            0.035,
        )
    for side in (-0.68, 0.68):
        add_box(mesh, Vector((side, -0.20, 0.215)), (0.06, 0.06, 0.43))
        add_box(mesh, Vector((side, 0.24, 0.215)), (0.06, 0.06, 0.43))
        add_box(mesh, Vector((side, 0.02, 0.405)), (0.055, 0.52, 0.05))
        add_box(
            mesh, Vector((side, 0.335, 0.47)) + lean @ Vector((0.0, 0.0, 0.25)), (0.055, 0.035, 0.56), lean
        )
        add_box(mesh, Vector((side, -0.02, 0.66)), (0.075, 0.50, 0.035), cell=0.035)
        add_box(mesh, Vector((side, -0.22, 0.545)), (0.05, 0.05, 0.20))
    return finish_object(mesh, "bench", material)


def make_cart_body(material):
    """A hay cart without its wheels: floor, rails on three sides, two axles and a shaft in front."""
    mesh = bmesh.new()
    for plank in range(6):
        add_box(mesh, Vector((0.0, -0.425 + 0.17 * plank, 0.56)), (1.9, 0.174, 0.035), cell=0.05)
    for side in (-0.52, 0.52):
        for rail in (0.68, 0.84):
            add_box(mesh, Vector((0.0, side, rail)), (1.9, 0.03, 0.10), cell=0.05)
        for post in (-0.9, -0.3, 0.3, 0.9):
            add_box(mesh, Vector((post, side - math.copysign(0.035, side), 0.73)), (0.05, 0.04, 0.36))
    for rail in (0.68, 0.84):
        add_box(mesh, Vector((-0.955, 0.0, rail)), (0.03, 1.07, 0.10), cell=0.05)
    for axle in (-0.6, 0.6):
        add_box(mesh, Vector((axle, 0.0, WHEEL_RADIUS)), (0.07, 1.3, 0.07))
        for side in (-0.3, 0.3):
            add_box(mesh, Vector((axle, side, 0.45)), (0.09, 0.07, 0.18))
    add_box(mesh, Vector((0.0, 0.0, 0.515)), (1.8, 0.10, 0.05))
    for side in (-0.22, 0.22):
        dip = Matrix.Rotation(math.radians(9.0), 3, "Y")
        add_box(mesh, Vector((1.62, side, 0.42)), (1.45, 0.05, 0.05), dip)
    add_box(mesh, Vector((2.25, 0.0, 0.32)), (0.05, 0.62, 0.05))
    return finish_object(mesh, "cart", material)


def make_wheel(name, material):
    """A wheel with spokes, standing about the Y axis."""
    mesh = bmesh.new()
    add_disc(mesh, Vector(), WHEEL_RADIUS - 0.055, WHEEL_RADIUS, 0.06)
    add_disc(mesh, Vector(), 0.0, 0.065, 0.13, sides=16)
    for spoke in range(10):
        turn = Matrix.Rotation(2.0 * math.pi * spoke / 10.0, 3, "Y")
        add_box(mesh, turn @ Vector((0.0, 0.0, 0.17)), (0.028, 0.03, 0.25), turn, cell=0.3)
    return finish_object(mesh, name, material)


def cart_place(frame):
    """The cart's position, 0 to 1: at rest, then moving with a soft start and stop."""
    time = min(max((frame - CART_LEAVES) / (CART_STOPS - CART_LEAVES), 0.0), 1.0)
    return time * time * (3.0 - 2.0 * time)


def drive_cart(body, wheels):
    """Keys the cart along its way over the ground; the wheels turn with the distance."""
    way = CART_TO - CART_FROM
    bearing = math.atan2(way.y, way.x)
    heading = Vector((math.cos(bearing), math.sin(bearing)))
    turn = Matrix.Rotation(bearing, 4, "Z")
    for frame in range(1, FRAMES + 1):
        at = CART_FROM + way * cart_place(frame)
        axles = [at.xy + heading * offset for offset in (-0.6, 0.6)]
        rear, front = (float(knoll(*axle)) for axle in axles)
        body.location = (at.x, at.y, (rear + front) / 2.0)
        body.rotation_euler = (turn @ Matrix.Rotation(-math.atan2(front - rear, 1.2), 4, "Y")).to_euler()
        body.keyframe_insert("location", frame=frame)
        body.keyframe_insert("rotation_euler", frame=frame)
        for wheel in wheels:
            wheel.rotation_euler = (0.0, way.length * cart_place(frame) / WHEEL_RADIUS, 0.0)
            wheel.keyframe_insert("rotation_euler", index=1, frame=frame)


def make_cart(boards, iron):
    """The cart with its wheels, unwrapped and on its way; returns [cart, wheel, wheel, wheel, wheel]."""
    cart = make_cart_body(boards)
    unwrap(cart)
    wheels = []
    for axle in (-0.6, 0.6):
        for side in (-0.63, 0.63):
            wheel = make_wheel(f"wheel {len(wheels) + 1}", iron)
            unwrap(wheel)
            wheel.parent, wheel.location = cart, (axle, side, WHEEL_RADIUS)
            wheels.append(wheel)
    drive_cart(cart, wheels)
    return [cart, *wheels]


# --------------------------------------------------------------------------------------------------
# Light, camera, render settings


def make_sky(scene):
    """A clear winter evening: a pale band over the horizon, deep blue above, without a sun in it.

    Darker than snow in the light, so that white limbs stand out against it.
    """
    world = bpy.data.worlds.new("winter sky")
    if bpy.app.version < (5, 0, 0):
        world.use_nodes = True
    nodes, links = world.node_tree.nodes, world.node_tree.links
    background = next(node for node in nodes if node.type == "BACKGROUND")
    coordinates, separate = nodes.new("ShaderNodeTexCoord"), nodes.new("ShaderNodeSeparateXYZ")
    ramp = nodes.new("ShaderNodeValToRGB")
    stops = (
        (0.0, (0.55, 0.48, 0.46)),
        (0.04, (0.46, 0.45, 0.49)),
        (0.13, (0.20, 0.29, 0.44)),
        (0.40, (0.09, 0.17, 0.35)),
        (1.0, (0.06, 0.12, 0.28)),
    )
    while len(ramp.color_ramp.elements) < len(stops):
        ramp.color_ramp.elements.new(0.5)
    for element, (position, colour) in zip(ramp.color_ramp.elements, stops):
        element.position, element.color = position, (*colour, 1.0)
    ramp.color_ramp.interpolation = "B_SPLINE"
    links.new(coordinates.outputs["Generated"], separate.inputs["Vector"])
    links.new(separate.outputs["Z"], ramp.inputs["Fac"])
    links.new(ramp.outputs["Color"], background.inputs["Color"])
    background.inputs["Strength"].default_value = 0.9
    scene.world = world


def make_forest(distance, height, colour, seed):
    """A distant line of spruces as one flat silhouette in the haze; it neither receives nor blocks snow."""
    rng = np.random.default_rng(seed)
    mesh = bmesh.new()
    for bearing in np.arange(-50.0, 50.0, 0.45):
        angle = math.radians(bearing + rng.uniform(-0.3, 0.3))
        tall = height * rng.uniform(0.55, 1.0) * (0.8 + 0.2 * math.sin(0.11 * bearing + seed))
        foot = Vector((distance * math.sin(angle), distance * math.cos(angle), -FOREST_DEPTH))
        across = Vector((math.cos(angle), -math.sin(angle), 0.0)) * tall * 0.17
        rise = Vector((0.0, 0.0, 1.0))
        # Three skirts of boughs, one above the other, over a strip that joins them.
        for low, high, wide in ((0.0, 0.55, 1.0), (0.3, 0.8, 0.72), (0.55, 1.0, 0.45)):
            mesh.faces.new(
                [
                    mesh.verts.new(foot + corner)
                    for corner in (
                        rise * low * tall - across * wide,
                        rise * low * tall + across * wide,
                        rise * high * tall,
                    )
                ]
            )
        mesh.faces.new(
            [
                mesh.verts.new(foot + corner)
                for corner in (
                    rise * -9.0 - 3.0 * across,
                    rise * -9.0 + 3.0 * across,
                    rise * 0.25 * height + 3.0 * across,
                    rise * 0.25 * height - 3.0 * across,
                )
            ]
        )
    data = bpy.data.meshes.new("far forest")
    mesh.to_mesh(data)
    mesh.free()
    material = bpy.data.materials.new("haze")
    if bpy.app.version < (5, 0, 0):
        material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    glow = nodes.new("ShaderNodeEmission")
    # Mist lies at the foot of the trees.
    place, height_of = nodes.new("ShaderNodeNewGeometry"), nodes.new("ShaderNodeSeparateXYZ")
    spread, ramp = nodes.new("ShaderNodeMapRange"), nodes.new("ShaderNodeValToRGB")
    spread.inputs["From Min"].default_value, spread.inputs["From Max"].default_value = (
        -FOREST_DEPTH - 1.0,
        -FOREST_DEPTH + height,
    )
    ramp.color_ramp.elements[0].color = (0.56, 0.50, 0.49, 1.0)
    ramp.color_ramp.elements[1].color = (*colour, 1.0)
    links.new(place.outputs["Position"], height_of.inputs["Vector"])
    links.new(height_of.outputs["Z"], spread.inputs["Value"])
    links.new(spread.outputs["Result"], ramp.inputs["Fac"])
    links.new(ramp.outputs["Color"], glow.inputs["Color"])
    output = next(node for node in nodes if node.type == "OUTPUT_MATERIAL")
    links.new(glow.outputs["Emission"], output.inputs["Surface"])
    data.materials.append(material)
    made = bpy.data.objects.new("far forest", data)
    made.visible_shadow = made.visible_diffuse = made.visible_glossy = False
    bpy.context.scene.collection.objects.link(made)
    return made


def make_sun(scene):
    light = bpy.data.lights.new("low sun", "SUN")
    light.energy, light.angle, light.color = 5.5, math.radians(1.2), (1.0, 0.80, 0.60)
    sun = bpy.data.objects.new("low sun", light)
    # From the left and a little in front of the tree, 23 degrees high: it grazes the ground, and snow on
    # the limbs is bright against the sky.
    sun.rotation_euler = (math.radians(67.0), 0.0, math.radians(-72.0))
    scene.collection.objects.link(sun)


def make_camera(scene, name, place, target, focal_length):
    lens = bpy.data.cameras.new(name)
    lens.lens, lens.sensor_width, lens.clip_start = focal_length, 36.0, 0.01
    camera = bpy.data.objects.new(name, lens)
    camera.location = place
    camera.rotation_euler = (target - place).to_track_quat("-Z", "Y").to_euler()
    scene.collection.objects.link(camera)
    return camera


def set_render(scene, width=800, height=500, samples=16):
    """Cycles on the CPU, small and quick; the same settings in every Blender version.

    Debian's Blender has no denoiser: what keeps the pictures clean is that nothing in them is hard to
    sample. One bounce of diffuse light, a sky without a sun in it and a nearly sharp sun.
    """
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.samples = samples
    scene.cycles.use_adaptive_sampling = True
    scene.cycles.adaptive_threshold = 0.02
    scene.cycles.max_bounces = 2
    scene.cycles.diffuse_bounces = 1
    scene.cycles.glossy_bounces = 1
    scene.cycles.sample_clamp_indirect = 2.0
    scene.cycles.caustics_reflective = scene.cycles.caustics_refractive = False
    scene.cycles.use_denoising = False
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.render.resolution_percentage = 100
    scene.render.use_persistent_data = False
    scene.render.image_settings.file_format = "PNG"
    looks = {item.name for item in type(scene.view_settings).bl_rna.properties["look"].enum_items}
    scene.view_settings.view_transform = "Filmic"
    scene.view_settings.exposure = 0.45
    if "Medium High Contrast" in looks:
        scene.view_settings.look = "Medium High Contrast"


def build_stage():
    """Builds everything but the tree in the current scene; returns a Stage."""
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, FRAMES
    scene.render.fps = 24
    earth = make_material("earth", (0.085, 0.066, 0.038), 0.95, mottle=0.45, scale=2.3, bump=0.6)
    painted = make_material("green paint", (0.045, 0.115, 0.085), 0.5, mottle=0.15, scale=9.0)
    boards = make_material(
        "old boards", (0.23, 0.115, 0.05), 0.75, mottle=0.4, scale=7.0, bump=0.3, stretch=(0.5, 4.0, 4.0)
    )
    iron = make_material("iron", (0.055, 0.045, 0.04), 0.55)

    ground = make_ground(earth)
    bench = make_bench(painted)
    unwrap(bench)
    bench.location = (-2.35, -1.75, float(knoll(-2.35, -1.75)))
    bench.rotation_euler = (0.0, 0.0, math.radians(14.0))
    cart, *wheels = make_cart(boards, iron)
    make_sky(scene)
    make_sun(scene)
    backdrop = [make_forest(75.0, 11.0, (0.30, 0.34, 0.42), 3), make_forest(50.0, 8.0, (0.13, 0.17, 0.23), 5)]
    scene.camera = make_camera(
        scene, "camera", Vector((1.5, -10.2, 2.3)), Vector((0.9, 0.0, 2.55)), focal_length=32.0
    )
    set_render(scene)
    return Stage(ground, bench, cart, wheels, scene.camera, backdrop)
