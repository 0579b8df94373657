# SPDX-License-Identifier: GPL-3.0-or-later
"""A tree as glTF 2.0: skin, meshes in levels of detail, materials, and parameters for shaders. No ``bpy``.

The extension MSFT_lod (Khronos Group's registry of extensions, vendor MSFT) connects the levels: the node of the finest
level is in the scene and lists the others. Axes and units are glTF's: metres, Y up, +X right seen from +Z, UV origin
top-left.
"""

from dataclasses import dataclass, field

import numpy as np

from ..tree.wind_attributes import AXIS, LENGTH, PHASE, PIVOT
from .document import INDICES, VERTICES, Document
from .surface import split, unit

GENERATOR = "Snowbough"
MSFT_LOD, TEXTURE_TRANSFORM = "MSFT_lod", "KHR_texture_transform"
# From Blender's axes to glTF's: (x, y, z) -> (x, z, -y).
TO_Y_UP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
FORMULA = "T = T_p * (1 - level / levels)"
# Linear, the same as in the real-time renderer.
SNOW_COLOR, SNOW_ROUGHNESS = (0.86, 0.88, 0.91), 0.6


@dataclass
class Joint:
    """A bone. parent: index of its parent, -1 for a root; parents come first. rest: its rest matrix (4, 4) in Blender's
    axes, only rotation and translation."""

    name: str
    parent: int
    rest: np.ndarray


@dataclass
class Texture:
    """The bytes of an image file, sampled at uv * scale + offset of TEXCOORD_<texcoord>, with v upwards."""

    name: str
    data: bytes
    mime_type: str
    texcoord: int = 0
    scale: tuple = (1.0, 1.0)
    offset: tuple = (0.0, 0.0)


@dataclass
class Material:
    """A metallic-roughness material of glTF, not metallic. cutoff: texels with lower alpha are invisible; None:
    opaque."""

    name: str
    color: tuple = (1.0, 1.0, 1.0)
    roughness: float = 0.9
    base: Texture | None = None
    normal: Texture | None = None
    cutoff: float | None = None
    double_sided: bool = False


@dataclass
class Part:
    """Bark or leaves. levels: one Surface per level of detail, the finest first. materials: indexed by
    Surface.material."""

    name: str
    levels: list
    materials: list


@dataclass
class Heap:
    """Snow as a static mesh: float32 points (V, 3) and int32 triangles (T, 3), smooth shaded."""

    name: str
    points: np.ndarray
    triangles: np.ndarray


@dataclass
class Tree:
    """name; joints: [Joint]; parts: [Part]; branch_levels: number of levels, including the trunk; extras:
    plain data that is added to the scene's extras; heaps: [Heap]."""

    name: str
    joints: list
    parts: list
    branch_levels: int
    extras: dict = field(default_factory=dict)
    heaps: list = field(default_factory=list)


def _y_up(points):
    return np.ascontiguousarray(np.asarray(points) @ TO_Y_UP.T, dtype=np.float32)


def _quaternion(rotation):
    """(x, y, z, w) of a (3, 3) rotation. The largest component is computed first, for full precision.

    Source: S. W. Shepperd, Quaternion from Rotation Matrix, Journal of Guidance and Control 1 (3), 1978.
    """
    m = rotation
    squares = np.array([m[0, 0], m[1, 1], m[2, 2], m.trace()])
    largest = int(np.argmax(squares))
    if largest == 3:
        q = (m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1], 1.0 + m.trace())
    else:
        i, j, k = largest, (largest + 1) % 3, (largest + 2) % 3
        q = [0.0, 0.0, 0.0, m[k, j] - m[j, k]]
        q[i] = 1.0 - m.trace() + 2.0 * m[i, i]
        q[j], q[k] = m[j, i] + m[i, j], m[k, i] + m[i, k]
    q = np.asarray(q, dtype=np.float64)
    return q / np.linalg.norm(q)


def _add_skin(document, tree):
    """Adds the joints as nodes below a root node with the tree's name. Returns (root node, skin)."""
    root = document.add("nodes", {"name": tree.name})
    upright = np.eye(4)
    upright[:3, :3] = TO_Y_UP
    world = [upright @ joint.rest for joint in tree.joints]
    nodes, inverse = [], []
    for joint, matrix in zip(tree.joints, world):
        local = matrix if joint.parent < 0 else np.linalg.inv(world[joint.parent]) @ matrix
        node = {
            "name": joint.name,
            "translation": local[:3, 3].tolist(),
            "rotation": _quaternion(local[:3, :3]).tolist(),
        }
        nodes.append(document.add("nodes", node))
        above = root if joint.parent < 0 else nodes[joint.parent]
        document.json["nodes"][above].setdefault("children", []).append(nodes[-1])
        bind = np.linalg.inv(matrix)
        bind[3] = (0.0, 0.0, 0.0, 1.0)  # exactly, as the specification requires
        inverse.append(bind.T)
    bind = document.add_accessor(np.array(inverse, dtype=np.float32))
    skin = {"name": tree.name, "inverseBindMatrices": bind, "skeleton": root, "joints": nodes}
    return root, document.add("skins", skin)


def _texture_info(document, texture):
    info = {"index": document.add_texture(texture.name, texture.data, texture.mime_type)}
    if texture.texcoord:
        info["texCoord"] = texture.texcoord
    if texture.scale != (1.0, 1.0) or texture.offset != (0.0, 0.0):
        document.use_extension(TEXTURE_TRANSFORM)
        # v points down in glTF: 1 - (s (1 - v) + o) = s v + (1 - s - o).
        offset = [texture.offset[0], 1.0 - texture.scale[1] - texture.offset[1]]
        info["extensions"] = {TEXTURE_TRANSFORM: {"offset": offset, "scale": list(texture.scale)}}
    return info


def _add_material(document, material):
    surface = {"metallicFactor": 0.0, "roughnessFactor": material.roughness}
    surface["baseColorFactor"] = [*map(float, material.color), 1.0]
    if material.base is not None:
        surface["baseColorTexture"] = _texture_info(document, material.base)
    entry = {"name": material.name, "pbrMetallicRoughness": surface}
    if material.normal is not None:
        entry["normalTexture"] = _texture_info(document, material.normal)
    if material.cutoff is not None:
        entry.update(alphaMode="MASK", alphaCutoff=material.cutoff)
    if material.double_sided:
        entry["doubleSided"] = True
    return document.add("materials", entry)


def level_color(level, branch_levels):
    """uint8 (N, 4): white, which keeps the base colour, and in alpha the tessellation factor 1 - level / levels. Opaque
    materials ignore alpha."""
    color = np.full((len(level), 4), 255, dtype=np.uint8)
    color[:, 3] = np.rint(255.0 * (1.0 - np.asarray(level, dtype=np.float64) / branch_levels))
    return color


def _index_type(vertices):
    # The highest value of an index type is reserved for primitive restart.
    return np.uint16 if vertices < 65535 else np.uint32


def _add_primitive(document, surface, chosen, material, branch_levels):
    vertices = split(surface, chosen)
    joints, weights = surface.joints[vertices.point], surface.weights[vertices.point]
    attributes = {
        "POSITION": document.add_accessor(_y_up(surface.points[vertices.point]), VERTICES, bounds=True),
        "NORMAL": document.add_accessor(_y_up(vertices.normals), VERTICES),
    }
    for number, uv in enumerate(vertices.uvs):
        flipped = np.stack([uv[:, 0], 1.0 - uv[:, 1]], axis=1).astype(np.float32)
        attributes[f"TEXCOORD_{number}"] = document.add_accessor(flipped, VERTICES)
    if surface.level is not None:
        level = surface.level[vertices.point]
        color = level_color(level, branch_levels)
        attributes["COLOR_0"] = document.add_accessor(color, VERTICES, normalized=True)
        attributes["_BRANCH_LEVEL"] = document.add_accessor(level.astype(np.float32), VERTICES)
    if surface.wind is not None:
        pivot, axis, length, phase = (values[vertices.point].astype(np.float32) for values in surface.wind)
        for name, values in ((PIVOT, _y_up(pivot)), (AXIS, _y_up(axis)), (LENGTH, length), (PHASE, phase)):
            attributes[name] = document.add_accessor(values, VERTICES)
    attributes["JOINTS_0"] = document.add_accessor(joints.astype(np.uint16), VERTICES)
    attributes["WEIGHTS_0"] = document.add_accessor(weights.astype(np.float32), VERTICES)
    width = _index_type(len(vertices.point))
    indices = document.add_accessor(vertices.triangles.reshape(-1).astype(width), INDICES)
    return {"attributes": attributes, "indices": indices, "material": material}


def _add_mesh(document, name, surface, materials, branch_levels):
    primitives = []
    for number in np.unique(surface.material).tolist():
        chosen = surface.material == number
        primitives.append(_add_primitive(document, surface, chosen, materials[number], branch_levels))
    return document.add("meshes", {"name": name, "primitives": primitives})


def screen_coverage(levels):
    """MSFT_screencoverage: the share of the screen at which each level ends. Each level ends at half the height of the
    level before, a quarter of the area; the last level never ends."""
    return [*(0.25 ** (number + 1) for number in range(levels - 1)), 0.0]


def _add_part(document, part, skin, branch_levels, first_level):
    """Adds a part. Returns the node of its finest level, which lists the coarser levels in MSFT_lod."""
    used = np.unique(np.concatenate([surface.material for surface in part.levels])).tolist()
    materials = {number: _add_material(document, part.materials[number]) for number in used}
    nodes = []
    for number, surface in enumerate(part.levels, first_level):
        name = f"{part.name}_LOD{number}"
        mesh = _add_mesh(document, name, surface, materials, branch_levels)
        nodes.append(document.add("nodes", {"name": name, "mesh": mesh, "skin": skin}))
    if len(nodes) > 1:
        document.use_extension(MSFT_LOD)
        finest = document.json["nodes"][nodes[0]]
        finest["extensions"] = {MSFT_LOD: {"ids": nodes[1:]}}
        finest["extras"] = {"MSFT_screencoverage": screen_coverage(len(nodes))}
    return nodes[0]


def _add_heap(document, heap, material):
    """Adds a heap of snow. Returns its node."""
    a, b, c = (heap.points[heap.triangles[:, k]].astype(np.float64) for k in range(3))
    normals = np.zeros(heap.points.shape)
    for k in range(3):
        np.add.at(normals, heap.triangles[:, k], np.cross(b - a, c - a))
    attributes = {
        "POSITION": document.add_accessor(_y_up(heap.points), VERTICES, bounds=True),
        "NORMAL": document.add_accessor(_y_up(unit(normals)), VERTICES),
    }
    width = _index_type(len(heap.points))
    indices = document.add_accessor(heap.triangles.reshape(-1).astype(width), INDICES)
    primitive = {"attributes": attributes, "indices": indices, "material": material}
    mesh = document.add("meshes", {"name": heap.name, "primitives": [primitive]})
    return document.add("nodes", {"name": heap.name, "mesh": mesh})


def build(tree, first_level=0):
    """The Document of a Tree. first_level: number in the name of the finest level, _LOD<first_level>. Raises ValueError
    for a number of bones that glTF cannot store."""
    if not tree.joints or len(tree.joints) > 65536:
        raise ValueError(f"a glTF skin must have 1 to 65,536 bones, not {len(tree.joints)}")
    document = Document(GENERATOR)
    root, skin = _add_skin(document, tree)
    # Nodes with a skin are siblings of the joints, because their parents do not move them.
    parts = [_add_part(document, part, skin, tree.branch_levels, first_level) for part in tree.parts]
    if tree.heaps:
        snow = _add_material(document, Material("Snow", SNOW_COLOR, SNOW_ROUGHNESS))
        parts += [_add_heap(document, heap, snow) for heap in tree.heaps]
    said = {"branch_levels": tree.branch_levels, "tessellation": FORMULA, **tree.extras}
    document.add("scenes", {"name": tree.name, "nodes": [root, *parts], "extras": {"snowbough": said}})
    document.json["scene"] = 0
    return document
