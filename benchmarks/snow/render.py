# SPDX-License-Identifier: GPL-3.0-or-later
"""The part of pictures.py that runs in Blender: renders the displaced meshes of a plan. Run through pictures.py."""

import json
import sys
from pathlib import Path

import bpy
import numpy as np
from mathutils import Vector

SNOW = (0.86, 0.89, 0.95, 1.0)


def material(name, colour, wire):
    """`colour` on bare places, white under more than a millimetre of snow, with lines over it if `wire` > 0."""
    made = bpy.data.materials.new(name)
    if bpy.app.version < (5, 0, 0):
        made.use_nodes = True
    nodes, links = made.node_tree.nodes, made.node_tree.links
    shader = next(node for node in nodes if node.type == "BSDF_PRINCIPLED")
    shader.inputs["Roughness"].default_value = 0.8
    height, ramp = nodes.new("ShaderNodeAttribute"), nodes.new("ShaderNodeMapRange")
    height.attribute_name = "snow"
    ramp.inputs["From Min"].default_value, ramp.inputs["From Max"].default_value = 0.0003, 0.002
    mix = nodes.new("ShaderNodeMixRGB")
    mix.inputs[1].default_value, mix.inputs[2].default_value = (*colour, 1.0), SNOW
    links.new(height.outputs["Fac"], ramp.inputs["Value"])
    links.new(ramp.outputs[0], mix.inputs[0])
    result = mix.outputs[0]
    if wire > 0.0:
        lines, over = nodes.new("ShaderNodeWireframe"), nodes.new("ShaderNodeMixRGB")
        lines.inputs["Size"].default_value = wire
        over.inputs[2].default_value = (0.0, 0.05, 0.3, 1.0)
        links.new(lines.outputs[0], over.inputs[0])
        links.new(result, over.inputs[1])
        result = over.outputs[0]
    links.new(result, shader.inputs["Base Color"])
    return made


def add_mesh(name, positions, triangles, snow, colour, wire):
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(len(positions))
    mesh.loops.add(triangles.size)
    mesh.polygons.add(len(triangles))
    mesh.vertices.foreach_set("co", positions.ravel())
    mesh.loops.foreach_set("vertex_index", triangles.ravel())
    mesh.polygons.foreach_set("loop_start", np.arange(0, triangles.size, 3, dtype=np.int32))
    mesh.polygons.foreach_set("loop_total", np.full(len(triangles), 3, np.int32))
    mesh.update(calc_edges=True)
    mesh.attributes.new("snow", "FLOAT", "POINT").data.foreach_set("value", snow)
    mesh.materials.append(material(name, colour, wire))
    thing = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(thing)


def look(thing, place, target):
    thing.location = place
    thing.rotation_euler = (Vector(target) - Vector(place)).to_track_quat("-Z", "Y").to_euler()


def render(plan, scene_plan, samples):
    bpy.ops.wm.read_homefile(use_empty=True)
    scene = bpy.context.scene
    data = np.load(plan.parent / f"{scene_plan['name']}.npz")
    for i in range(scene_plan["count"]):
        add_mesh(
            f"part{i}",
            data[f"p{i}"],
            data[f"t{i}"],
            data[f"s{i}"],
            data[f"c{i}"].tolist(),
            scene_plan["wire"],
        )
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.lens, camera.data.clip_start = scene_plan["lens"], 0.01
    sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    sun.data.energy, sun.data.angle = 2.5, 0.03
    for thing in (camera, sun):
        scene.collection.objects.link(thing)
    look(camera, scene_plan["camera"], scene_plan["target"])
    look(sun, scene_plan["sun"], (0.0, 0.0, 0.0))
    scene.camera = camera
    scene.world = bpy.data.worlds.new("sky")
    if bpy.app.version < (5, 0, 0):
        scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs[0].default_value = (0.35, 0.42, 0.55, 1.0)
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.max_bounces = samples, 3
    scene.cycles.use_denoising = False
    scene.view_settings.view_transform = "Standard"
    scene.render.resolution_x, scene.render.resolution_y = 960, 640
    scene.render.filepath = str(plan.parent / f"{scene_plan['name']}.png")
    bpy.ops.render.render(write_still=True)


plan_path = Path(sys.argv[sys.argv.index("--") + 1])
wanted = json.loads(plan_path.read_text())
for one in wanted["scenes"]:
    render(plan_path, one, wanted["samples"])
