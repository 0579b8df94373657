# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a material lets snow through: its opacity as an image, found by following its nodes.

of_material() follows the nodes backwards from the material's output: Principled BSDF's Alpha, Mix with Transparent,
groups, arithmetic, Separate Color. This covers what importers make of an MTL's ``map_d`` and of glTF's masks, and
Snowbough's own leaves. The opacity must come from one image with UVs. Otherwise (a procedural texture, two images, a
missing file) UnknownAlpha is raised, and the surface is treated as opaque. So is a constant opacity: glass blocks snow.
"""

from dataclasses import dataclass

import numpy as np

from ..base.names import SNOW_GROUP
from .inputs import fingerprint

# Largest side of an alpha image; larger ones are averaged down. It takes one bit per texel on the GPU.
MAX_SIZE = 1024
# The smallest opaque alpha, of 255. The native module has the same.
THRESHOLD = 128

LUMINANCE = (0.2126, 0.7152, 0.0722)

IDENTITY = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0))


class UnknownAlpha(ValueError):
    """A material's opacity is unknown, for the reason in the message. The surface is treated as opaque."""


@dataclass(frozen=True)
class AlphaImage:
    """A material's opacity."""

    name: str
    """The image's."""
    pixels: np.ndarray
    """(H, W) uint8, row 0 = v 0; 255 is opaque."""
    extension: str
    """REPEAT, MIRROR, EXTEND or CLIP."""
    uv_map: str
    """Empty for the mesh's UV map for rendering."""
    transform: tuple
    """Two rows (a, b, c): u' = a u + b v + c, likewise v'; from a Mapping node."""
    print: str
    """Fingerprint of all that affects where snow falls through."""


def of_material(material):
    """The AlphaImage of a material, or None if it is opaque everywhere. Raises UnknownAlpha."""
    tree = material.node_tree if material is not None and material.use_nodes else None
    output = tree.get_output_node("ALL") or tree.get_output_node("CYCLES") if tree is not None else None
    if output is None:
        return None
    image, opacity = _shader(output.inputs["Surface"], ())
    if image is None:
        return None
    pixels = _shrunk(np.broadcast_to(np.asarray(opacity, dtype=np.float32), _shape(image.image)))
    if (pixels >= THRESHOLD).all():
        return None
    extension = image.extension
    uv_map, transform = coordinates(image.inputs["Vector"])
    printed = fingerprint(
        pixels >= THRESHOLD,
        np.frombuffer(f"{extension} {uv_map}".encode(), np.uint8),
        np.array(transform, np.float64),
    )
    pixels.flags.writeable = False
    return AlphaImage(image.image.name, pixels, extension, uv_map, transform, printed)


# A value is (the image texture node it comes from or None, a float or an array (H, W)). `groups` are the enclosing
# group nodes, the innermost last.


def source(socket, groups):
    """(output socket that gives an input its value or None, the group nodes around that socket, the last input)."""
    while socket.is_linked:
        link = socket.links[0]
        node, output = link.from_node, link.from_socket
        if link.is_muted or node.mute:
            raise UnknownAlpha("its alpha comes from a muted node")
        if node.type == "REROUTE":
            socket = node.inputs[0]
        elif node.type == "GROUP_INPUT" and groups:
            socket, groups = _same(groups[-1].inputs, output), groups[:-1]
        elif node.type == "GROUP" and node.node_tree is not None:
            if node.node_tree.name.startswith(SNOW_GROUP):
                socket = node.inputs["Shader"]  # skip our own snow
            else:
                ends = [inner for inner in node.node_tree.nodes if inner.type == "GROUP_OUTPUT"]
                active = next((end for end in ends if end.is_active_output), None)
                if active is None:
                    raise UnknownAlpha("its alpha comes from a node group without an output")
                socket, groups = _same(active.inputs, output), (*groups, node)
        else:
            return output, groups, socket
    return None, groups, socket


def _same(sockets, wanted):
    return next(socket for socket in sockets if socket.identifier == wanted.identifier)


def _shader(socket, groups):
    """The opacity of the shader that an input shows."""
    output, groups, _ = source(socket, groups)
    node = output.node if output is not None else None
    if node is None:
        return None, 1.0
    if node.type == "BSDF_PRINCIPLED":
        alpha = node.inputs["Alpha"]
        return _value(alpha, groups) if alpha.is_linked else (None, 1.0)
    if node.type == "BSDF_TRANSPARENT":
        return None, 0.0
    if node.type == "ADD_SHADER":
        return _combine(np.maximum, _shader(node.inputs[0], groups), _shader(node.inputs[1], groups))
    if node.type == "MIX_SHADER":
        first, second = _shader(node.inputs[1], groups), _shader(node.inputs[2], groups)
        if first == (None, 1.0) and second == (None, 1.0):
            return None, 1.0  # opaque, whatever the factor
        factor = _value(node.inputs[0], groups)
        if factor[0] is None and first[0] is None and second[0] is None:
            return None, 1.0  # a constant: glass
        kept = _combine(lambda f, a: (1.0 - f) * a, factor, first)
        return _combine(np.add, kept, _combine(np.multiply, factor, second))
    return None, 1.0


def _combine(operation, first, second):
    if first[0] is not None and second[0] is not None and first[0] != second[0]:
        names = f"'{first[0].image.name}' and '{second[0].image.name}'"
        raise UnknownAlpha(f"its alpha comes from two images, {names}")
    return first[0] or second[0], operation(first[1], second[1])


MATH = {
    "ADD": np.add,
    "SUBTRACT": np.subtract,
    "MULTIPLY": np.multiply,
    "DIVIDE": lambda a, b: np.where(np.asarray(b) == 0, 0.0, a / np.where(np.asarray(b) == 0, 1.0, b)),
    "POWER": lambda a, b: np.power(np.maximum(a, 0.0), b),
    "MINIMUM": np.minimum,
    "MAXIMUM": np.maximum,
    "LESS_THAN": lambda a, b: np.where(np.asarray(a) < b, 1.0, 0.0),
    "GREATER_THAN": lambda a, b: np.where(np.asarray(a) > b, 1.0, 0.0),
    "ROUND": lambda a, _: np.floor(np.asarray(a) + 0.5),
    "ABSOLUTE": lambda a, _: np.abs(a),
}
ONE_INPUT = ("ROUND", "ABSOLUTE")


def _value(socket, groups):
    """The value of a float or colour input; of colours the luminance."""
    output, groups, end = source(socket, groups)
    if output is None:
        given = end.default_value
        return None, float(given) if isinstance(given, (int, float)) else float(np.dot(given[:3], LUMINANCE))
    node = output.node
    if node.type == "TEX_IMAGE":
        channels = channels_of(node)
        if output.name == "Alpha":
            return node, channels[..., 3]
        return node, channels[..., :3] @ np.array(LUMINANCE, np.float32)
    if node.type in ("SEPARATE_COLOR", "SEPRGB") and getattr(node, "mode", "RGB") == "RGB":
        image, _, _ = source(node.inputs[0], groups)
        if image is not None and image.node.type == "TEX_IMAGE" and image.name == "Color":
            return image.node, channels_of(image.node)[..., list(node.outputs).index(output)]
    if node.type == "RGBTOBW":
        return _value(node.inputs[0], groups)
    if node.type == "VALUE":
        return None, float(output.default_value)
    if node.type == "INVERT":
        factor, color = _value(node.inputs[0], groups), _value(node.inputs[1], groups)
        return _combine(lambda f, c: f * (1.0 - c) + (1.0 - f) * c, factor, color)
    if node.type == "CLAMP":
        low, high = (_value(node.inputs[i], groups)[1] for i in (1, 2))
        image, value = _value(node.inputs[0], groups)
        return image, np.clip(value, low, high)
    if node.type == "MATH" and node.operation in MATH:
        first = _value(node.inputs[0], groups)
        second = (None, 0.0) if node.operation in ONE_INPUT else _value(node.inputs[1], groups)
        image, value = _combine(MATH[node.operation], first, second)
        return image, np.clip(value, 0.0, 1.0) if node.use_clamp else value
    raise UnknownAlpha(f"its alpha comes from a node '{node.name}', which cannot be followed to an image")


def _shape(image):
    return image.size[1], image.size[0]


def channels_of(node):
    """(H, W, 4) float32 of an image texture node: linear colour and alpha."""
    image = node.image
    if image is None:
        raise UnknownAlpha("its alpha comes from an image texture without an image")
    if image.source not in ("FILE", "GENERATED"):
        raise UnknownAlpha(f"its alpha image '{image.name}' is a {image.source.lower()}, not a single image")
    if node.projection != "FLAT":
        raise UnknownAlpha(f"its alpha image '{image.name}' is not projected flat")
    height, width = _shape(image)
    count = image.channels
    if not width or not height or not count:
        raise UnknownAlpha(f"its alpha image '{image.name}' is missing: {image.filepath or 'it has no file'}")
    flat = np.empty(width * height * count, dtype=np.float32)
    image.pixels.foreach_get(flat)
    given = flat.reshape(height, width, count)
    channels = np.ones((height, width, 4), dtype=np.float32)
    channels[..., :3] = given[..., :3] if count >= 3 else given[..., :1]
    if count == 4 and image.alpha_mode != "NONE":
        channels[..., 3] = given[..., 3]
    if not image.is_float and image.colorspace_settings.name == "sRGB":
        color = channels[..., :3]
        channels[..., :3] = np.where(color <= 0.04045, color / 12.92, ((color + 0.055) / 1.055) ** 2.4)
    return channels


def _shrunk(opacity):
    """(H, W) uint8 of at most MAX_SIZE a side."""
    return np.floor(np.clip(block_means(opacity), 0.0, 1.0) * 255.0 + 0.5).astype(np.uint8)


def block_means(opacity):
    """(H, W) of at most MAX_SIZE a side, as means of blocks of texels."""
    for axis in (0, 1):
        size = opacity.shape[axis]
        if size > MAX_SIZE:
            begin = np.arange(MAX_SIZE) * size // MAX_SIZE
            counts = np.diff(np.append(begin, size)).astype(np.float32)
            sums = np.add.reduceat(opacity, begin, axis=axis)
            opacity = sums / (counts[:, None] if axis == 0 else counts)
    return opacity


def coordinates(socket):
    """(UV map or "", transform) of an image texture's Vector input. Raises UnknownAlpha."""
    output, groups, _ = source(socket, ())
    if output is None:
        return "", IDENTITY
    node = output.node
    if node.type == "UVMAP":
        return node.uv_map, IDENTITY
    if node.type == "TEX_COORD" and output.name == "UV":
        return "", IDENTITY
    if node.type == "ATTRIBUTE" and node.attribute_type == "GEOMETRY" and output.name == "Vector":
        return node.attribute_name, IDENTITY
    if node.type == "MAPPING" and node.vector_type in ("POINT", "TEXTURE") and not groups:
        return _mapped(node)
    raise UnknownAlpha(f"its alpha image gets its coordinates from the node '{node.name}', not from a UV map")


def _mapped(node):
    parts = [node.inputs[name] for name in ("Location", "Rotation", "Scale")]
    if any(part.is_linked for part in parts):
        raise UnknownAlpha(f"its alpha image is moved by links to the node '{node.name}'")
    location, rotation, scale = (part.default_value for part in parts)
    if abs(rotation[0]) > 1e-6 or abs(rotation[1]) > 1e-6:
        raise UnknownAlpha(f"its alpha image is rotated out of its plane by the node '{node.name}'")
    uv_map, inner = coordinates(node.inputs["Vector"])
    cosine, sine = float(np.cos(rotation[2])), float(np.sin(rotation[2]))
    own = np.array(
        [
            [cosine * scale[0], -sine * scale[1], location[0]],
            [sine * scale[0], cosine * scale[1], location[1]],
            [0.0, 0.0, 1.0],
        ]
    )
    if node.vector_type == "TEXTURE":
        if scale[0] == 0 or scale[1] == 0:
            raise UnknownAlpha(f"its alpha image is scaled to nothing by the node '{node.name}'")
        own = np.linalg.inv(own)
    both = own @ np.array([*inner, (0.0, 0.0, 1.0)])
    return uv_map, tuple(tuple(map(float, row)) for row in both[:2])
