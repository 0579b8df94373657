# SPDX-License-Identifier: GPL-3.0-or-later
"""Approximates a material by one colour or one image.

The search follows the nodes backwards from the output to the first shader with a colour input. It takes the image
there, with its UV map and transform, or the colour. A procedural texture, such as noise, becomes the mean of its input
colours.
"""

from dataclasses import dataclass

import numpy as np

from ..scene import material_alpha
from ..scene.material_alpha import IDENTITY, UnknownAlpha
from .records import Bark, Paint

# Maximum side of images, in texels.
MAX_SIZE = 1024
SNOW_COLOR = (0.86, 0.88, 0.91)
GREY = (0.8, 0.8, 0.8)

# Colour of a sky texture, whose pixels cannot be read.
CLEAR_SKY = (0.35, 0.5, 0.8)

COLOR_INPUTS = ("Base Color", "Color", "Color1", "A", "Image", "Fac")
# Shaders that transmit light. In a mix, the other shaders determine the look.
CLEAR_SHADERS = {"BSDF_TRANSPARENT", "BSDF_TRANSLUCENT", "HOLDOUT"}


@dataclass(frozen=True)
class Look:
    """A material as the renderer can show it."""

    paint: Paint
    uv_map: str = ""
    """UV map of the image; empty for the mesh's active UV map for rendering."""
    transform: tuple = IDENTITY
    """Two rows (a, b, c): u' = a u + b v + c, likewise v'."""
    ramp: tuple = None
    """(dark, light): the ends of the colour ramp that gives the colour, or None."""


@dataclass(frozen=True)
class _Color:
    """The value of a colour input: a constant, an image texture node, or the product of both."""

    constant: tuple
    image: object = None
    ramp: tuple = None


PLAIN = Look(Paint(GREY))
SNOW = Look(Paint(SNOW_COLOR))


def look_of(material):
    """The Look of a material; Blender's default grey for None."""
    if material is None:
        return PLAIN
    color = _color_of(material)
    alpha = _alpha_of(material)
    pixels, uv_map, transform = _pixels(color.image)
    constant = color.constant
    if pixels is None:
        constant = color.constant if color.image is None else GREY
        if alpha is None:
            return Look(Paint(constant), ramp=color.ramp)
        pixels = np.full((*alpha.pixels.shape, 4), 255, np.uint8)
        uv_map, transform = alpha.uv_map, alpha.transform
    if alpha is not None:
        pixels[..., 3] = _resampled(alpha.pixels, pixels.shape[:2])
    pixels.flags.writeable = False
    return Look(Paint(constant, pixels), uv_map, transform, color.ramp)


def bark_of(look):
    """The Bark of a trunk's Look: the ends of its colour ramp; otherwise the mean of the darkest and of the lightest
    fifth of its image; otherwise two shades of its colour."""
    if look.ramp is not None:
        return Bark(*look.ramp)
    color = np.array(look.paint.color)
    if look.paint.image is None:
        return Bark(tuple(0.5 * color), tuple(np.minimum(1.2 * color, 1.0)))
    texels = _linear(look.paint.image[..., :3].reshape(-1, 3)[::7] / np.float32(255.0)) * color
    order = np.argsort(texels @ np.array(material_alpha.LUMINANCE))
    fifth = max(1, len(order) // 5)
    ends = texels[order[:fifth]].mean(axis=0), texels[order[-fifth:]].mean(axis=0)
    return Bark(*(tuple(map(float, end)) for end in ends))


def background_color(output):
    """Linear colour of a world's output node: the background's colour, or the mean of its image, multiplied by the
    strength. None if there is no background."""
    try:
        found, groups, _ = material_alpha.source(output.inputs["Surface"], ())
        if found is None or found.node.type != "BACKGROUND":
            return None
        color = _socket_color(found.node.inputs["Color"], groups)
    except UnknownAlpha:
        return None
    strength = found.node.inputs["Strength"].default_value
    if color.image is None:
        return tuple(strength * c for c in color.constant)
    return tuple(float(strength * c) for c in _mean_light(color.image.image))


def _mean_light(image):
    """Mean linear colour of an environment image, over the sphere. Values are not clipped."""
    if image is None or not len(image.pixels) or image.channels < 3:
        return GREY
    flat = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(flat)
    colors = flat.reshape(image.size[1], image.size[0], image.channels)[..., :3]
    if not image.is_float:
        colors = _linear(colors)
    # The area of a row on the sphere.
    rows = np.cos(np.pi * ((np.arange(len(colors)) + 0.5) / len(colors) - 0.5))
    return np.average(colors.mean(axis=1), axis=0, weights=rows)


def _alpha_of(material):
    try:
        return material_alpha.of_material(material)
    except UnknownAlpha:
        return None


def _color_of(material):
    tree = material.node_tree if material.use_nodes else None
    output = tree.get_output_node("ALL") or tree.get_output_node("EEVEE") if tree is not None else None
    viewport = _Color(tuple(material.diffuse_color[:3]))
    if output is None:
        return viewport
    try:
        return _shader_color(output.inputs["Surface"], ()) or viewport
    except UnknownAlpha:
        return viewport


def _shader_color(socket, groups):
    """_Color of a shader input, or None if it is transparent or not linked."""
    output, groups, _ = material_alpha.source(socket, groups)
    if output is None:
        return None
    node = output.node
    if node.type in CLEAR_SHADERS:
        return None
    if node.type in ("MIX_SHADER", "ADD_SHADER"):
        shaders = [inner for inner in node.inputs if inner.type == "SHADER"]
        return next((found for s in shaders if (found := _shader_color(s, groups)) is not None), None)
    for name in COLOR_INPUTS:
        if name in node.inputs:
            return _socket_color(node.inputs[name], groups)
    return None


def _socket_color(socket, groups):
    """_Color of a colour input."""
    output, groups, end = material_alpha.source(socket, groups)
    if output is None:
        given = end.default_value
        grey = isinstance(given, (int, float))
        return _Color((float(given),) * 3 if grey else tuple(map(float, given[:3])))
    node = output.node
    if node.type in ("TEX_IMAGE", "TEX_ENVIRONMENT"):
        return _Color((1.0, 1.0, 1.0), node)
    if node.type == "RGB":
        return _Color(tuple(map(float, output.default_value[:3])))
    if node.type == "TEX_SKY":
        return _Color(CLEAR_SKY)
    if node.type == "VALTORGB":
        ends = [tuple(map(float, element.color[:3])) for element in node.color_ramp.elements]
        return _Color(tuple(np.mean(ends, axis=0).tolist()), None, (ends[0], ends[-1]))
    return _mixed(node, groups)


def _mixed(node, groups):
    """_Color of a node that combines colours: its first image input, or the mean of its colour inputs."""
    found = []
    for socket in node.inputs:
        if socket.type == "RGBA" and socket.enabled:
            color = _socket_color(socket, groups)
            if color.image is not None:
                return color
            found.append(color.constant)
    return _Color(tuple(np.mean(found, axis=0).tolist()) if found else GREY)


def _pixels(node):
    """(pixels, UV map, transform) of an image texture node. pixels: (H, W, 4) uint8, sRGB, opaque; None if the image
    cannot be shown."""
    if node is None:
        return None, "", IDENTITY
    try:
        channels = material_alpha.channels_of(node)
        uv_map, transform = material_alpha.coordinates(node.inputs["Vector"])
    except UnknownAlpha:
        return None, "", IDENTITY
    step = -(-max(channels.shape[:2]) // MAX_SIZE)
    rows, columns = (size // step * step for size in channels.shape[:2])
    small = (
        channels[:rows, :columns, :3].reshape(rows // step, step, columns // step, step, 3).mean(axis=(1, 3))
    )
    pixels = np.full((*small.shape[:2], 4), 255, np.uint8)
    pixels[..., :3] = np.floor(_encoded(np.clip(small, 0.0, 1.0)) * 255.0 + 0.5)
    return pixels, uv_map, transform


def _resampled(pixels, shape):
    """Resizes an image (H, W) to another shape, by the nearest texel."""
    rows, columns = ((np.arange(n) + 0.5) * m / n for n, m in zip(shape, pixels.shape))
    return pixels[rows.astype(int)[:, None], columns.astype(int)]


def _encoded(linear):
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.power(linear, 1 / 2.4) - 0.055)


def _linear(encoded):
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)
