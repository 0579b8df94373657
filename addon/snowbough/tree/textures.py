# SPDX-License-Identifier: GPL-3.0-or-later
"""Image textures of an export's materials."""

from pathlib import Path
from types import SimpleNamespace

import bpy

# The textures of a native ObjMaterial.
KINDS = ("diffuse_texture", "alpha_texture", "specular_texture", "bump_texture", "normal_texture")


def _uv_node(tree, uv_map):
    node = tree.nodes.new("ShaderNodeUVMap")
    node.uv_map = uv_map
    node.location = (-1300, 0)
    return node


class Textures:
    """Image texture nodes of one material, all on the same UV map."""

    def __init__(self, tree, uv_map):
        self._tree, self._uv_map, self._uv, self._nodes = tree, uv_map, None, {}

    def node(self, texture, color_space, height=0):
        """The image texture node of a native MaterialTexture; None without a file."""
        if not texture.path:
            return None
        key = (texture.path, texture.scale, texture.offset, color_space)
        if key not in self._nodes:
            self._nodes[key] = self._new(texture, color_space, height)
        return self._nodes[key]

    def _new(self, texture, color_space, height):
        nodes, link = self._tree.nodes, self._tree.links.new
        if self._uv is None:
            self._uv = _uv_node(self._tree, self._uv_map)
        place = self._uv.outputs["UV"]
        if texture.scale != (1.0, 1.0) or texture.offset != (0.0, 0.0):
            mapping = nodes.new("ShaderNodeMapping")
            mapping.location = (-1100, height)
            mapping.inputs["Scale"].default_value = (*texture.scale, 1.0)
            mapping.inputs["Location"].default_value = (*texture.offset, 0.0)
            link(place, mapping.inputs["Vector"])
            place = mapping.outputs["Vector"]
        node = nodes.new("ShaderNodeTexImage")
        node.image = _image(texture.path, color_space)
        node.location = (-900, height)
        link(place, node.inputs["Vector"])
        return node


def _image(path, color_space):
    """The image, once per colour space: a file may be both a colour and a mask."""
    path = Path(path)
    for image in bpy.data.images:
        # An image without users was only loaded by Check. On Windows, Blender may turn slashes round in a path.
        if Path(bpy.path.abspath(image.filepath)) == path and (
            image.colorspace_settings.name == color_space or image.users == 0
        ):
            image.colorspace_settings.name = color_space
            return image
    image = bpy.data.images.load(str(path))
    image.colorspace_settings.name = color_space
    return image


def _is_readable(path):
    """Whether Blender can read an image file; others would be shown in pink."""
    known = {image.as_pointer() for image in bpy.data.images}
    try:
        image = bpy.data.images.load(path, check_existing=True)
    except RuntimeError:
        return False
    # Reading the size loads the file, which stays in memory for the material.
    if all(image.size):
        return True
    if image.as_pointer() not in known:
        bpy.data.images.remove(image)
    return False


class Check:
    """Finds out which textures of a tree's materials Blender can read.

    warnings: a list that gets one line for each unreadable file.
    """

    def __init__(self, warnings):
        self._warnings, self._answers = warnings, {}

    def readable(self, sources):
        """The materials `sources` without unreadable textures, so that they use their colour."""
        return [_without(source, self._broken(source)) for source in sources]

    def _broken(self, source):
        return [kind for kind in KINDS if not self._fits(getattr(source, kind).path, source.name)]

    def _fits(self, path, name):
        if not path:
            return True
        if path not in self._answers:
            self._answers[path] = _is_readable(path)
            if not self._answers[path]:
                self._warnings.append(f"texture '{Path(path).name}' of material '{name}' cannot be read")
        return self._answers[path]


def _without(source, kinds):
    if not kinds:
        return source
    names = [name for name in dir(source) if not name.startswith("_")]
    copy = SimpleNamespace(**{name: getattr(source, name) for name in names})
    for kind in kinds:
        setattr(copy, kind, SimpleNamespace(path="", scale=(1.0, 1.0), offset=(0.0, 0.0)))
    return copy
