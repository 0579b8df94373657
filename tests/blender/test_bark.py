# SPDX-License-Identifier: GPL-3.0-or-later
"""Procedural bark, as it is rendered."""

import bpy
import numpy as np
import pytest
from realtime_shot import rendered as picture_of

WIDTH, HEIGHT = 96, 64


@pytest.fixture
def rendered(addon, tmp_path):
    """Renders a sheet whose left half ends and whose right half begins at the seam of the map `bark`;
    on branches of a level; span: of the map in either half. Gives the colour's brightness, rows from below."""

    def render(level=0.0, span=0.3):
        bpy.ops.wm.read_homefile(use_empty=True)
        mesh = bpy.data.meshes.new("sheet")
        points = [(x, y, 0.0) for x in (-1.5, 0.0, 1.5) for y in (-1.0, 1.0)]
        mesh.from_pydata(points, [], [(0, 2, 3, 1), (2, 4, 5, 3)])
        uv = mesh.uv_layers.new(name="bark")
        for face, (low, high) in enumerate(((1.0 - span, 1.0), (0.0, span))):
            for corner, at in enumerate(((low, 0.2), (high, 0.2), (high, 0.2 + span), (low, 0.2 + span))):
                uv.data[4 * face + corner].uv = at
        mesh.attributes.new("_BRANCH_LEVEL", "FLOAT", "POINT").data.foreach_set("value", [level] * 6)
        material = addon("tree.materials").bark_material("bark")
        nodes, link = material.node_tree.nodes, material.node_tree.links.new
        colour = next(node for node in nodes if node.type == "VALTORGB").outputs["Color"]
        light = nodes.new("ShaderNodeEmission")
        link(colour, light.inputs["Color"])
        output = next(node for node in nodes if node.type == "OUTPUT_MATERIAL")
        link(light.outputs[0], output.inputs["Surface"])
        mesh.materials.append(material)
        scene = bpy.context.scene
        scene.collection.objects.link(bpy.data.objects.new("sheet", mesh))
        scene.camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
        scene.collection.objects.link(scene.camera)
        scene.camera.data.type, scene.camera.data.ortho_scale = "ORTHO", 3.0
        scene.camera.location = (0.0, 0.0, 2.0)
        scene.render.engine, scene.cycles.samples = "CYCLES", 4
        scene.cycles.use_denoising = False
        scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT
        scene.render.image_settings.file_format = "OPEN_EXR"
        scene.render.image_settings.color_depth = "32"
        scene.render.filepath = str(tmp_path / "bark.exr")
        return picture_of(scene)[..., :3].mean(axis=2)

    return render


def test_bark_has_no_seam_where_its_map_has_come_round(rendered):
    steps = np.abs(np.diff(rendered(span=0.02), axis=1)).mean(axis=0)
    assert steps.min() > 0.0
    assert steps[WIDTH // 2 - 1] < 3.0 * np.median(steps)


def test_young_branches_have_shallower_furrows(rendered):
    old, young = rendered(0.0), rendered(5.0)
    assert young.min() > old.min()
    assert young.std() < 0.8 * old.std()


def test_a_second_material_of_the_same_bark_is_its_copy_with_its_own_name(addon):
    bark_material = addon("tree.materials").bark_material
    alone, made = bark_material("alone"), {}
    first, second = bark_material("trunk", made=made), bark_material("twigs", made=made)
    assert (first.name, second.name) == ("trunk", "twigs")
    assert first.node_tree is not second.node_tree

    def links(material):
        return {
            (link.from_node.name, link.from_socket.name, link.to_node.name, link.to_socket.identifier)
            for link in material.node_tree.links
        }

    assert links(first) == links(second) == links(alone)
