# SPDX-License-Identifier: GPL-3.0-or-later
"""Converts Blender's materials to glTF: the colour texture or colour of the first Principled BSDF, its normal map, and
the opacity that the snow uses (scene.material_alpha) as the alpha of the texture.
"""

from pathlib import Path

import bpy
import numpy as np

from ..scene import material_alpha
from . import bark_bake, texels
from .images import encoded, kind_of, pixels_of
from .tree_data import Material, Texture

CUTOFF = 0.5


def _node_behind(socket):
    """The node that is linked to an input, or None. Skips reroutes."""
    while socket is not None and socket.is_linked:
        node = socket.links[0].from_node
        if node.type != "REROUTE":
            return node
        socket = node.inputs[0]
    return None


def srgb(linear):
    """Encodes linear colours as sRGB."""
    linear = np.clip(np.asarray(linear, dtype=np.float32), 0.0, 1.0)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def _colors(image):
    """float32 (H, W, 3) of a colour image in sRGB; None if the image is missing. Float images are linear."""
    pixels = pixels_of(image) if image is not None else None
    if pixels is None:
        return None
    return srgb(pixels[..., :3]) if image.is_float else pixels[..., :3]


def _file_of(image):
    """The bytes of the image's file; None if there is no file or the image was painted on since it was saved."""
    if image.is_dirty:
        return None
    if image.packed_file is not None:
        return image.packed_file.data
    path = Path(bpy.path.abspath(image.filepath))
    return path.read_bytes() if image.filepath and path.is_file() else None


class _Maker:
    """Makes one material. See Maker; uv_maps: names in the order of TEXCOORD_0, _1 and so on."""

    def __init__(self, shared, material, uv_maps):
        self._shared, self._material, self._uv_maps = shared, material, uv_maps
        self._warnings, self._size = shared.warnings, shared.size

    def _warn(self, text):
        self._warnings.append(f"material '{self._material.name}': {text}")

    def _placed(self, texture, uv_map, transform):
        """The Texture with its UV map and transform set."""
        (a, b, c), (d, e, f) = transform
        if max(abs(b), abs(d)) > 1e-6:
            self._warn(f"the texture '{texture.name}' is rotated: it was exported without rotation")
        if uv_map and uv_map not in self._uv_maps:
            self._warn(
                f"the texture '{texture.name}' uses the UV map '{uv_map}', which is not exported: "
                "it was exported with the first UV map"
            )
        texture.texcoord = self._uv_maps.index(uv_map) if uv_map in self._uv_maps else 0
        texture.scale, texture.offset = (a, e), (c, f)
        return texture

    def _texture(self, node):
        """The Texture of an image texture node; None if the image is missing. A file that glTF allows, and that is not
        too large, stays unchanged."""
        image = node.image
        data = _file_of(image) if image is not None else None
        kind = kind_of(data) if data else None
        if kind is None or (self._size and max(image.size) > self._size):
            rgb = _colors(image)
            if rgb is None:
                self._warn(f"the image '{image.name if image else 'of a texture node'}' is missing")
                return None
            data, kind = encoded(texels.limited(rgb, self._size))
        return self._placed(Texture(Path(image.name).stem, data, kind), *self._coordinates(node))

    def _coordinates(self, node):
        try:
            return material_alpha.coordinates(node.inputs["Vector"])
        except material_alpha.UnknownAlpha as error:
            self._warn(f"{error}: exported with the first UV map")
            return "", material_alpha.IDENTITY

    def _opacity(self):
        try:
            return material_alpha.of_material(self._material)
        except material_alpha.UnknownAlpha as error:
            self._warn(f"{error}: exported as opaque")
            return None

    def _masked(self, opacity, node, color):
        """The Texture of an image texture node, or of one colour if that is None, with the opacity as alpha."""
        alpha = opacity.pixels.astype(np.float32) / 255.0
        rgb = _colors(node.image) if node is not None else None
        place = (opacity.uv_map, opacity.transform)
        if rgb is None:
            rgb = np.broadcast_to(srgb(color), (1, 1, 3))
        elif self._coordinates(node) != place:
            place = self._coordinates(node)
            self._warn(
                f"the colour and the mask '{opacity.name}' use different UVs: "
                "the mask was exported with the UVs of the colour"
            )
        name = Path(node.image.name if node is not None and node.image is not None else opacity.name).stem
        rgb, alpha = texels.limited(rgb, self._size), texels.limited(alpha[..., None], self._size)[..., 0]
        data, kind = encoded(texels.masked(rgb, alpha).astype(np.float32) / 255.0)
        return self._placed(Texture(name, data, kind), *place)

    def _normal(self, surface):
        node = _node_behind(surface.inputs["Normal"])
        if node is not None and node.type == "BUMP":
            height = _node_behind(node.inputs["Height"])
            if height is not None and height.type == "TEX_IMAGE":
                self._warn("its bump map was not exported: bake it to a normal map")
            node = _node_behind(node.inputs["Normal"])
        image = _node_behind(node.inputs["Color"]) if node is not None and node.type == "NORMAL_MAP" else None
        return self._texture(image) if image is not None and image.type == "TEX_IMAGE" else None

    def _baked(self):
        """(colour, normals) of procedural bark as Textures; None if it cannot be baked."""
        try:
            baked = self._shared.bake(self._material)
        except RuntimeError as error:
            self._warn(
                f"its procedural bark was exported as one colour, because it could not be baked: {error}"
            )
            return None
        names = (self._material.name, f"{self._material.name}_normal")
        return tuple(Texture(name, *encoded(pixels)) for name, pixels in zip(names, baked))

    def make(self):
        name = self._material.name
        tree = self._material.node_tree if self._material.use_nodes else None
        surface = next((n for n in tree.nodes if n.type == "BSDF_PRINCIPLED"), None) if tree else None
        if surface is None:
            self._warn("it has no Principled BSDF: its viewport colour was exported")
            return Material(name, color=tuple(self._material.diffuse_color[:3]))
        made = Material(name, roughness=float(surface.inputs["Roughness"].default_value))
        base = surface.inputs["Base Color"]
        node = _node_behind(base)
        image = node if node is not None and node.type == "TEX_IMAGE" else None
        color = tuple(base.default_value[:3])
        if node is not None and node.type == "VALTORGB":
            # Procedural bark: the mean colour of its ramp.
            color = tuple(np.mean([node.color_ramp.evaluate(t / 15)[:3] for t in range(16)], axis=0).tolist())
            baked = self._baked() if self._size else None
            if baked is not None:
                made.base, made.normal = baked
                return made
            if not self._size:
                self._warn("its procedural bark was exported as one colour: set a Texture Size to bake it")
        opacity = self._opacity()
        if opacity is not None:
            made.base, made.cutoff = self._masked(opacity, image, color), CUTOFF
        else:
            made.base = self._texture(image) if image is not None else None
        made.color = color if made.base is None else (1.0, 1.0, 1.0)
        made.normal = self._normal(surface)
        return made


class Maker:
    """Makes the materials of one tree. circumference: of the trunk, in metres; size: maximum side of textures in
    texels, 0 for textures as they are and no baked bark; warnings: receives the losses."""

    def __init__(self, context, circumference, size, warnings):
        self._context, self._circumference = context, circumference
        self.size, self.warnings = size, warnings

    def bake(self, material):
        return bark_bake.bake(self._context, material, self._circumference, self.size)

    def of_object(self, obj, uv_maps, double_sided):
        """[Material] of an object's slots, in their order; one grey material if there are no slots. uv_maps: names in
        the order of TEXCOORD_0, _1 and so on."""
        made = []
        for slot in obj.material_slots:
            if slot.material is None:
                made.append(Material("none", color=(0.5, 0.5, 0.5)))
            else:
                made.append(_Maker(self, slot.material, uv_maps).make())
        made = made or [Material(obj.name, color=(0.5, 0.5, 0.5))]
        for material in made:
            material.double_sided = double_sided
        return made
