# SPDX-License-Identifier: GPL-3.0-or-later
"""Bakes a procedural bark material to a colour and a normal texture that repeat, with Cycles.

The material is baked on a flat sheet as wide as the trunk's circumference, on which the UV map ``bark`` goes once
around the limb. The nodes are periodic around the limb. Along the limb, the end of the tile fades into its beginning.
"""

import bpy
import numpy as np

from ..base import compat
from ..base.names import BARK_UV
from .images import pixels_of

# Length of the fade, in tiles.
FADE = 0.25
# Maximum side of the textures in texels. Baking takes 11 s on two cores at this size, and four times that at the next.
MAX_SIZE = 512
BAKE_UV = "bake"


def repeating(sheet, size):
    """(size, size, channels) from sheet (rows, size, channels), row 0 at the bottom, whose upper rows continue the
    tile: they fade into the lowest rows, so that the tile repeats."""
    tile = sheet[:size].copy()
    beyond = sheet[size:]
    share = ((np.arange(len(beyond)) + 0.5) / len(beyond))[:, None, None]
    tile[: len(beyond)] = share * tile[: len(beyond)] + (1.0 - share) * beyond
    return tile


def _sheet(circumference):
    """A mesh object: the flat sheet, with the UV map for the image active."""
    height = 1.0 + FADE
    mesh = bpy.data.meshes.new("snowbough_bark")
    places = np.array([(0, 0), (1, 0), (1, height), (0, height)], dtype=np.float64)
    mesh.from_pydata([(u * circumference, v * circumference, 0.0) for u, v in places], [], [(0, 1, 2, 3)])
    for name, scale in ((BARK_UV, 1.0), (BAKE_UV, height)):
        layer = mesh.uv_layers.new(name=name)
        compat.set_uv(layer, places / (1.0, scale))
        layer.active = True
    return bpy.data.objects.new("snowbough_bark", mesh)


def _bake_kind(context, scene, obj, node, size, kind):
    """float32 (size, size, 3): one kind of bake. node: the image texture node that is the target."""
    rows = size + int(size * FADE)
    node.image = bpy.data.images.new("snowbough_bark", size, rows)
    node.image.colorspace_settings.name = "Non-Color" if kind == "NORMAL" else "sRGB"
    place = {"scene": scene, "view_layer": scene.view_layers[0], "object": obj, "active_object": obj}
    try:
        with context.temp_override(selected_objects=[obj], selected_editable_objects=[obj], **place):
            bpy.ops.object.bake(type=kind, pass_filter={"COLOR"}, margin=0, use_clear=False)
        return repeating(pixels_of(node.image)[..., :3], size)
    finally:
        bpy.data.images.remove(node.image)


def bake(context, material, circumference, size):
    """(colour, normals): float32 (S, S, 3) with S at most `size`, encoded as in image files. circumference: of the
    trunk, in metres. Raises RuntimeError if Cycles is missing or cannot bake."""
    size = min(size, MAX_SIZE)
    if "cycles" not in context.preferences.addons:
        raise RuntimeError("Cycles is not enabled")
    scene = bpy.data.scenes.new("snowbough_bark")
    copy = material.copy()
    obj = _sheet(circumference)
    try:
        scene.render.engine = "CYCLES"
        scene.cycles.samples, scene.cycles.device, scene.cycles.use_denoising = 1, "CPU", False
        scene.collection.objects.link(obj)
        obj.data.materials.append(copy)
        node = copy.node_tree.nodes.new("ShaderNodeTexImage")
        copy.node_tree.nodes.active = node
        color, normals = (_bake_kind(context, scene, obj, node, size, kind) for kind in ("DIFFUSE", "NORMAL"))
        vectors = normals * 2.0 - 1.0
        length = np.linalg.norm(vectors, axis=2, keepdims=True)
        return color, 0.5 + 0.5 * vectors / np.maximum(length, 1e-6)
    finally:
        mesh = obj.data
        bpy.data.objects.remove(obj)
        bpy.data.meshes.remove(mesh)
        bpy.data.materials.remove(copy)
        bpy.data.scenes.remove(scene)
