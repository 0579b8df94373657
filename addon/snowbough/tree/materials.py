# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials of an imported tree: bark by its `bark` UV map, leaves from the export's MTL."""

from pathlib import Path

import bpy

from .. import compat, compat_nodes
from ..names import BARK_UV, LEAF_UV


def _fresh(name):
    """(material, node tree, Principled BSDF) of a new material with nothing else in it."""
    material = bpy.data.materials.new(name)
    compat.use_material_nodes(material)
    tree = material.node_tree
    tree.nodes.clear()
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    surface = tree.nodes.new("ShaderNodeBsdfPrincipled")
    surface.location = (-300, 0)
    tree.links.new(surface.outputs["BSDF"], output.inputs["Surface"])
    return material, tree, surface


def _uv_node(tree, uv_map):
    node = tree.nodes.new("ShaderNodeUVMap")
    node.uv_map = uv_map
    node.location = (-1300, 0)
    return node


def bark_material(name):
    """Furrowed bark along the limb: noise stretched along `bark`'s V, as colour and as bump."""
    material, tree, surface = _fresh(name)
    uv = _uv_node(tree, BARK_UV)
    mapping = tree.nodes.new("ShaderNodeMapping")
    mapping.location = (-1100, 0)
    # The map's U goes once round the limb; furrows run along V.
    mapping.inputs["Scale"].default_value = (6.0, 1.5, 1.0)
    noise = tree.nodes.new("ShaderNodeTexNoise")
    noise.location = (-900, 0)
    noise.inputs["Scale"].default_value = 2.0
    noise.inputs["Detail"].default_value = 8.0
    ramp = tree.nodes.new("ShaderNodeValToRGB")
    ramp.location = (-650, 100)
    ramp.color_ramp.elements[0].position, ramp.color_ramp.elements[0].color = 0.3, (0.028, 0.019, 0.013, 1)
    ramp.color_ramp.elements[1].position, ramp.color_ramp.elements[1].color = 0.75, (0.17, 0.125, 0.09, 1)
    bump = tree.nodes.new("ShaderNodeBump")
    bump.location = (-600, -250)
    bump.inputs["Strength"].default_value = 0.5
    bump.inputs["Distance"].default_value = 0.01
    height = compat_nodes.noise_value(noise)
    link = tree.links.new
    link(uv.outputs["UV"], mapping.inputs["Vector"])
    link(mapping.outputs["Vector"], noise.inputs["Vector"])
    link(height, ramp.inputs["Fac"] if "Fac" in ramp.inputs else ramp.inputs[0])
    link(height, bump.inputs["Height"])
    link(ramp.outputs["Color"], surface.inputs["Base Color"])
    link(bump.outputs["Normal"], surface.inputs["Normal"])
    surface.inputs["Roughness"].default_value = 0.9
    return material


def _image_node(tree, uv, path, color_space):
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = bpy.data.images.load(str(Path(path)), check_existing=True)
    node.image.colorspace_settings.name = color_space
    node.location = (-900, 0)
    tree.links.new(uv.outputs["UV"], node.inputs["Vector"])
    return node


def leaf_material(source=None, name="leaf"):
    """A leaf's material from the MTL's (native FoliageMaterial), or plain green without one.

    Textures that could not be found are empty in `source`; the import's report has named them.
    """
    material, tree, surface = _fresh(source.name if source and source.name else name)
    surface.inputs["Roughness"].default_value = 0.6
    color = tuple(source.diffuse) if source else (0.08, 0.22, 0.04)
    surface.inputs["Base Color"].default_value = (*map(float, color), 1.0)
    surface.inputs["Alpha"].default_value = float(source.opacity) if source else 1.0
    cut = source is not None and source.opacity < 1.0
    if source is not None and (source.diffuse_texture or source.alpha_texture):
        uv = _uv_node(tree, LEAF_UV)
        image = None
        if source.diffuse_texture:
            image = _image_node(tree, uv, source.diffuse_texture, "sRGB")
            tree.links.new(image.outputs["Color"], surface.inputs["Base Color"])
        if source.alpha_texture and source.alpha_texture == source.diffuse_texture:
            tree.links.new(image.outputs["Alpha"], surface.inputs["Alpha"])
            cut = True
        elif source.alpha_texture:
            mask = _image_node(tree, uv, source.alpha_texture, "Non-Color")
            mask.location = (-900, -320)
            tree.links.new(mask.outputs["Color"], surface.inputs["Alpha"])
            cut = True
        elif image.image.channels == 4:
            tree.links.new(image.outputs["Alpha"], surface.inputs["Alpha"])
            cut = True
    if cut:
        compat.set_alpha_clipping(material)
    return material
