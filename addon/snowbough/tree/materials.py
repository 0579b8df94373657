# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials of an imported tree: those of the export's MTL as Principled materials, and substitutes for missing ones.

A source is a native ObjMaterial, or a copy of one by :class:`textures.Check`. The caller names the UV map of its
textures: `original`, the export's own coordinates, on wood, and `leaf` on leaves. Textures that were not found or
cannot be read are empty in the source; the import's report names them.
"""

import bpy

from ..base import compat
from ..base.names import BARK_UV, LEAF_UV
from .bark_nodes import add_bark
from .textures import Textures

GREEN = (0.08, 0.22, 0.04)
# Colours whose components differ by less are ignored: exporters write greys as a default.
COLOURLESS = 0.04
# Largest component of a colour that counts as black.
BLACK = 0.01
# Share of light that a leaf with a transmission filter (Tf) lets through.
TRANSLUCENCY = 0.5


def _fresh(name):
    """(material, node tree, Principled BSDF, output) of a new material with no other nodes."""
    material = bpy.data.materials.new(name)
    compat.use_material_nodes(material)
    tree = material.node_tree
    tree.nodes.clear()
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    surface = tree.nodes.new("ShaderNodeBsdfPrincipled")
    surface.location = (-300, 0)
    tree.links.new(surface.outputs["BSDF"], output.inputs["Surface"])
    return material, tree, surface, output


def _deliberate(colour):
    """The colour, or None if it looks like an exporter's default."""
    colour = tuple(map(float, colour))
    return colour if max(colour) - min(colour) > COLOURLESS else None


def _relief(tree, surface, source, textures, uv_map):
    """Links normals from the normal map, the bump map, or both."""
    normal = None
    image = textures.node(source.normal_texture, "Non-Color", -900)
    if image is not None:
        node = tree.nodes.new("ShaderNodeNormalMap")
        node.uv_map = uv_map
        node.location = (-600, -700)
        tree.links.new(image.outputs["Color"], node.inputs["Color"])
        normal = node.outputs["Normal"]
    image = textures.node(source.bump_texture, "Non-Color", -620)
    if image is not None:
        node = tree.nodes.new("ShaderNodeBump")
        node.location = (-600, -450)
        strength = max(float(source.bump_strength), 0.0)
        node.inputs["Strength"].default_value = min(strength, 1.0)
        node.inputs["Distance"].default_value = 0.01 * max(strength, 1.0)
        tree.links.new(image.outputs["Color"], node.inputs["Height"])
        if normal is not None:
            tree.links.new(normal, node.inputs["Normal"])
        normal = node.outputs["Normal"]
    if normal is not None:
        tree.links.new(normal, surface.inputs["Normal"])


def _gloss(tree, surface, source, textures):
    image = textures.node(source.specular_texture, "Non-Color", -1180)
    if image is None:
        return
    half = tree.nodes.new("ShaderNodeMath")  # 0.5 is the default of Principled
    half.operation = "MULTIPLY"
    half.location = (-600, -950)
    half.inputs[1].default_value = 0.5
    tree.links.new(image.outputs["Color"], half.inputs[0])
    tree.links.new(half.outputs[0], compat.specular_input(surface))


def _mask(source, textures, colour_node, own_alpha):
    """The output with the opacity of the material; None if it is opaque everywhere.

    own_alpha: without a mask, use the alpha of the colour texture.
    """
    mask = source.alpha_texture
    if mask.path and mask.path == source.diffuse_texture.path:
        return colour_node.outputs["Alpha"]
    if mask.path:
        return textures.node(mask, "Non-Color", -320).outputs["Color"]
    if own_alpha and colour_node is not None and colour_node.image.channels == 4:
        return colour_node.outputs["Alpha"]
    return None


def _filter(source):
    """The colour of light that passes through the material; None for an opaque one.

    Exporters write white or black as Tf where it has no meaning.
    """
    colour = tuple(min(max(float(c), 0.0), 1.0) for c in source.transmission)
    return colour if max(colour) > 0.01 and min(colour) < 0.99 else None


def _let_light_through(tree, surface, output, colour, mask, opacity):
    """Adds light from behind, filtered by `colour`, and cuts everything by the mask."""
    nodes, link = tree.nodes, tree.links.new
    surface.location, output.location = (-500, 0), (500, 0)
    back = nodes.new("ShaderNodeBsdfTranslucent")
    back.location = (-150, -200)
    back.inputs["Color"].default_value = (*colour, 1.0)
    base = surface.inputs["Base Color"]
    if base.is_linked:
        tinted = nodes.new("ShaderNodeVectorMath")
        tinted.operation = "MULTIPLY"
        tinted.location = (-300, -200)
        tinted.inputs[1].default_value = colour
        link(base.links[0].from_socket, tinted.inputs[0])
        link(tinted.outputs[0], back.inputs["Color"])
    both = nodes.new("ShaderNodeMixShader")
    both.location = (50, 0)
    both.inputs[0].default_value = TRANSLUCENCY * max(colour)
    link(surface.outputs["BSDF"], both.inputs[1])
    link(back.outputs[0], both.inputs[2])
    result = both.outputs[0]
    if mask is not None or opacity < 1.0:
        nothing = nodes.new("ShaderNodeBsdfTransparent")
        nothing.location = (50, 150)
        cut = nodes.new("ShaderNodeMixShader")
        cut.location = (280, 0)
        cut.inputs[0].default_value = opacity
        if mask is not None:
            link(mask, cut.inputs[0])
        link(nothing.outputs[0], cut.inputs[1])
        link(result, cut.inputs[2])
        result = cut.outputs[0]
    link(result, output.inputs["Surface"])


def _add_textures(parts, source, uv_map, opacity, own_alpha):
    """Adds the source's textures to a new material."""
    material, tree, surface, output = parts
    textures = Textures(tree, uv_map)
    colour = textures.node(source.diffuse_texture, "sRGB")
    if colour is not None:
        tree.links.new(colour.outputs["Color"], surface.inputs["Base Color"])
    _relief(tree, surface, source, textures, uv_map)
    _gloss(tree, surface, source, textures)
    mask = _mask(source, textures, colour, own_alpha)
    through = _filter(source)
    if through is not None:
        _let_light_through(tree, surface, output, through, mask, opacity)
    elif mask is not None:
        tree.links.new(mask, surface.inputs["Alpha"])
    else:
        surface.inputs["Alpha"].default_value = opacity
    if mask is not None or opacity < 1.0:
        compat.set_alpha_clipping(material)


def _is_plain(source):
    """Whether a source adds nothing to a new material: neither textures nor light that passes through."""
    textures = (
        source.diffuse_texture,
        source.alpha_texture,
        source.bump_texture,
        source.normal_texture,
        source.specular_texture,
    )
    return not any(texture.path for texture in textures) and _filter(source) is None


def bark_material(name, source=None, uv_map=BARK_UV, made=None):
    """The material of wood: the source's textures on `uv_map`, or procedural bark if there is no colour texture, in the
    source's colour unless that is a default.

    name: for a material without a source. made: a dict that one import passes to all its calls: a second material of
    procedural bark is a copy of the first, since Blender takes 6 ms to add the nodes.
    """
    name = source.name if source and source.name else name
    ridge = _deliberate(source.diffuse) if source and source.defined else None
    plain = source is None or _is_plain(source)
    if plain and made is not None and ridge in made:
        material = made[ridge].copy()
        material.name = name
        return material
    parts = _fresh(name)
    material, tree, surface, _output = parts
    surface.inputs["Roughness"].default_value = 0.9
    if source is None or not source.diffuse_texture.path:
        add_bark(tree, surface, ridge)
    if source is not None:
        _add_textures(parts, source, uv_map, 1.0, own_alpha=False)
    if plain and made is not None:
        made[ridge] = material
    return material


def leaf_material(source=None, name="leaf"):
    """The material of a leaf from its source, or plain green without a texture and a colour."""
    parts = _fresh(source.name if source and source.name else name)
    material, _tree, surface, _output = parts
    surface.inputs["Roughness"].default_value = 0.6
    colour = GREEN
    if source is not None and source.defined:
        # White is for textures, which show through the leaf's own colour. Black is a default.
        extreme = min(source.diffuse) >= 0.5 or max(source.diffuse) <= BLACK
        unsaid = extreme and _deliberate(source.diffuse) is None
        colour = GREEN if unsaid else tuple(map(float, source.diffuse))
    surface.inputs["Base Color"].default_value = (*colour, 1.0)
    if source is not None:
        # Fully transparent leaves make no sense: some exporters swap d and Tr.
        _add_textures(parts, source, LEAF_UV, float(source.opacity) or 1.0, own_alpha=True)
    return material


class OwnMaterials:
    """The materials that a tree's meshes already have in Blender, by name."""

    def __init__(self, known=()):
        self._known = dict(known)

    def copy(self, source, uv_map):
        """A copy of the source's material with its textures on `uv_map`; None if no material has its name."""
        material = self._known.get(source.name) if source is not None else None
        if material is None:
            return None
        material = material.copy()
        if material.node_tree is not None:
            _put_on_uv_map(material.node_tree, uv_map)
        return material


def _put_on_uv_map(tree, uv_map):
    """Makes all image textures use `uv_map`: it need not be the first of the mesh, which nodes take by default."""
    place = None
    for node in list(tree.nodes):
        if node.type == "UVMAP":
            node.uv_map = uv_map
        inputs = (
            [node.inputs["Vector"]]
            if node.type == "TEX_IMAGE" and not node.inputs["Vector"].is_linked
            else []
        )
        if node.type == "TEX_COORD":
            inputs += [link.to_socket for link in node.outputs["UV"].links]
        for socket in inputs:
            if place is None:
                place = tree.nodes.new("ShaderNodeUVMap")
                place.uv_map = uv_map
            tree.links.new(place.outputs["UV"], socket)
