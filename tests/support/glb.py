# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads glTF 2.0 back and checks it against the specification. Written from the text alone, independent of our writer:
Khronos Group, glTF 2.0 Specification, 2021; each rule names its section.
"""

import json
import struct
from pathlib import Path
from urllib.parse import unquote

import meshopt
import numpy as np

COMPONENTS = {
    5120: np.int8,
    5121: np.uint8,
    5122: np.int16,
    5123: np.uint16,
    5125: np.uint32,
    5126: np.float32,
}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
VERTICES, INDICES = 34962, 34963
# 3.7.2.1: type, component types, and whether numbers that are not floats must be normalised.
ATTRIBUTES = {
    "POSITION": ("VEC3", {5126}, False),
    "NORMAL": ("VEC3", {5126}, False),
    "TANGENT": ("VEC4", {5126}, False),
    "TEXCOORD": ("VEC2", {5121, 5123, 5126}, True),
    "COLOR": (("VEC3", "VEC4"), {5121, 5123, 5126}, True),
    "JOINTS": ("VEC4", {5121, 5123}, False),
    "WEIGHTS": ("VEC4", {5121, 5123, 5126}, True),
}
# KHR_mesh_quantization: further component types of these attributes.
SMALL = {"POSITION": {5120, 5121, 5122, 5123}, "NORMAL": {5120, 5122}, "TANGENT": {5120, 5122}}
SMALL["TEXCOORD"] = {5120, 5122}
# Largest error of the length of a normal of 8 bits, half a step in each direction.
SMALL_LENGTH = 3**0.5 * 0.5 / 127


class Gltf:
    """A .glb or .gltf file: its JSON, and its accessors as arrays."""

    def __init__(self, path):
        path = Path(path)
        data = path.read_bytes()
        self.folder, self.errors, self._decoded = path.parent, [], {}
        if data[:4] == b"glTF":
            self._read_glb(data)
        else:
            self.json = json.loads(data)
            self.binary = (path.parent / unquote(self.json["buffers"][0]["uri"])).read_bytes()
        self.say(len(self.binary) >= self.json["buffers"][0]["byteLength"], "3.6.1: the buffer is too short")

    def say(self, holds, text):
        if not holds:
            self.errors.append(text)

    def _read_glb(self, data):
        """4.4: a header of 12 bytes, then chunks that begin at multiples of four."""
        magic, version, length = struct.unpack_from("<4sII", data)
        self.say((magic, version, length) == (b"glTF", 2, len(data)), "4.4.2: the header")
        size, kind = struct.unpack_from("<I4s", data, 12)
        self.say(kind == b"JSON" and size % 4 == 0, "4.4.3.2: the first chunk is no JSON")
        text = data[20 : 20 + size]
        self.say(text.rstrip(b" ").endswith(b"}"), "4.4.3.2: JSON is padded with blanks")
        self.json = json.loads(text)
        at = 20 + size
        size, kind = struct.unpack_from("<I4s", data, at)
        self.say(
            kind == b"BIN\0" and size % 4 == 0 and at + 8 + size == len(data), "4.4.3.3: the second chunk"
        )
        self.say("uri" not in self.json["buffers"][0], "4.4.3.3: the chunk's buffer has a uri")
        self.say(0 <= size - self.json["buffers"][0]["byteLength"] <= 3, "4.4.3.3: the buffer's length")
        self.binary = data[at + 8 : at + 8 + size]

    def _bytes_of(self, number):
        """(bytes, offset) of a buffer view, decompressed."""
        view = self.json["bufferViews"][number]
        packed = view.get("extensions", {}).get(meshopt.NAME)
        if packed is None:
            return self.binary, view.get("byteOffset", 0)
        if number not in self._decoded:
            first = packed.get("byteOffset", 0)
            data = self.binary[first : first + packed["byteLength"]]
            self._decoded[number] = meshopt.decoded(
                data, packed["mode"], packed["count"], packed["byteStride"]
            )
            self.say(
                len(self._decoded[number]) == view["byteLength"], f"{meshopt.NAME}: length of view {number}"
            )
        return self._decoded[number], 0

    def array(self, number):
        """The values of an accessor, (N, width)."""
        accessor = self.json["accessors"][number]
        view = self.json["bufferViews"][accessor["bufferView"]]
        binary, begin = self._bytes_of(accessor["bufferView"])
        kind, width = np.dtype(COMPONENTS[accessor["componentType"]]), WIDTHS[accessor["type"]]
        start = begin + accessor.get("byteOffset", 0)
        stride = view.get("byteStride", kind.itemsize * width)
        rows = np.ndarray((accessor["count"], width), kind, binary, start, (stride, kind.itemsize))
        return rows.copy()

    def values(self, number):
        """The values of an accessor as floats; normalised integers from -1 or 0 to 1 (3.6.2.2)."""
        values = self.array(number)
        if self.json["accessors"][number].get("normalized"):
            return np.maximum(values / np.iinfo(values.dtype).max, -1.0)
        return values.astype(float)

    def attributes(self, primitive):
        return {name: self.array(number) for name, number in primitive["attributes"].items()}

    def node(self, name):
        return next(node for node in self.json["nodes"] if node.get("name") == name)

    def primitives(self, node):
        return self.json["meshes"][node["mesh"]]["primitives"]

    def image(self, texture):
        """(bytes, MIME type) of a texture's image."""
        image = self.json["images"][self.json["textures"][texture]["source"]]
        if "uri" in image:
            return (self.folder / unquote(image["uri"])).read_bytes(), None
        view = self.json["bufferViews"][image["bufferView"]]
        start = view.get("byteOffset", 0)
        return self.binary[start : start + view["byteLength"]], image["mimeType"]

    def local_matrix(self, node):
        x, y, z, w = node.get("rotation", (0, 0, 0, 1))
        matrix = np.eye(4)
        matrix[:3, :3] = [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
        matrix[:3, :3] *= np.array(node.get("scale", (1, 1, 1)))
        matrix[:3, 3] = node.get("translation", (0, 0, 0))
        return matrix

    def world_matrices(self):
        world = [None] * len(self.json["nodes"])

        def visit(number, parent):
            world[number] = parent @ self.local_matrix(self.json["nodes"][number])
            for child in self.json["nodes"][number].get("children", ()):
                visit(child, world[number])

        children = {c for node in self.json["nodes"] for c in node.get("children", ())}
        for number in set(range(len(world))) - children:
            visit(number, np.eye(4))
        return world

    def skinned(self, node):
        """Positions (V, 3) of each primitive of a node as its joints bend them (3.7.3.3)."""
        skin = self.json["skins"][node["skin"]]
        inverse = self.array(skin["inverseBindMatrices"]).reshape(-1, 4, 4).transpose(0, 2, 1).astype(float)
        world = self.world_matrices()
        joints = np.array([world[joint] for joint in skin["joints"]]) @ inverse
        found = []
        for primitive in self.primitives(node):
            given = self.attributes(primitive)
            place = np.c_[given["POSITION"], np.ones(len(given["POSITION"]))]
            weights = self.values(primitive["attributes"]["WEIGHTS_0"])
            blend = np.einsum("vk,vkij->vij", weights, joints[given["JOINTS_0"]])
            found.append(np.einsum("vij,vj->vi", blend, place)[:, :3])
        return found

    def lods(self, node):
        """The nodes of a node's levels of detail, the finest first (MSFT_lod)."""
        ids = node.get("extensions", {}).get("MSFT_lod", {}).get("ids", [])
        return [node, *(self.json["nodes"][number] for number in ids)]

    def welded(self, node):
        """(places (V, 3), triangles (T, 3)) of a node's primitives, vertices of one place joined."""
        places, triangles, count = [], [], 0
        for primitive in self.primitives(node):
            place = self.array(primitive["attributes"]["POSITION"])
            triangles.append(self.array(primitive["indices"]).reshape(-1, 3).astype(np.int64) + count)
            places.append(place)
            count += len(place)
        unique, number = np.unique(np.concatenate(places), axis=0, return_inverse=True)
        return unique, number.reshape(-1)[np.concatenate(triangles)]


def is_closed(triangles):
    """Every edge has one triangle on each side, which run along it in opposite directions."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    forward = edges[:, 0] * (triangles.max() + 1) + edges[:, 1]
    backward = edges[:, 1] * (triangles.max() + 1) + edges[:, 0]
    return len(np.unique(forward)) == len(forward) and np.array_equal(np.sort(forward), np.sort(backward))


def volume(places, triangles):
    """Of a closed mesh; below 0 where it is inside out."""
    a, b, c = (places[triangles[:, k]].astype(float) for k in range(3))
    return float((a * np.cross(b, c)).sum() / 6.0)


# -- rules ----------------------------------------------------------------------------------------------


def _check_accessors(gltf):
    for view in gltf.json["bufferViews"]:
        end = view.get("byteOffset", 0) + view["byteLength"]
        gltf.say(
            view["byteLength"] > 0 and end <= gltf.json["buffers"][view["buffer"]]["byteLength"],
            "3.6.1: a view leaves its buffer",
        )
    for number, accessor in enumerate(gltf.json["accessors"]):
        view = gltf.json["bufferViews"][accessor["bufferView"]]
        kind, width = np.dtype(COMPONENTS[accessor["componentType"]]), WIDTHS[accessor["type"]]
        size = kind.itemsize
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        gltf.say(accessor["count"] >= 1, f"3.6.2: accessor {number} is empty")
        gltf.say(start % size == 0, f"3.6.2.4: accessor {number} is not aligned to its components")
        stride = view.get("byteStride", size * width)
        used = accessor.get("byteOffset", 0) + stride * (accessor["count"] - 1) + size * width
        gltf.say(used <= view["byteLength"], f"3.6.2.4: accessor {number} leaves its view")
        if view.get("target") == VERTICES:
            gltf.say(
                start % 4 == 0 and stride % 4 == 0, f"3.6.2.4: vertices of {number} are not aligned to 4"
            )
        values = gltf.array(number)
        if kind == np.float32:
            gltf.say(np.isfinite(values).all(), f"3.6.2.1: accessor {number} holds what is no number")
        for name, bound in (("min", values.min(axis=0)), ("max", values.max(axis=0))):
            if name in accessor:
                said = np.array(accessor[name], dtype=kind)
                gltf.say(
                    np.array_equal(said, bound), f"3.6.2.5: {name} of accessor {number} is not its data's"
                )


def _check_attribute(gltf, name, number):
    accessor = gltf.json["accessors"][number]
    view = gltf.json["bufferViews"][accessor["bufferView"]]
    gltf.say(view.get("target") in (None, VERTICES), f"3.6.1: {name} is bound as indices")
    if name.startswith("_"):
        gltf.say(accessor["componentType"] != 5125, f"3.7.2.1: {name} is of 32-bit integers")
        return
    kinds, components, normalized = ATTRIBUTES[name.split("_")[0]]
    gltf.say(accessor["type"] in kinds, f"3.7.2.1: {name} is {accessor['type']}")
    small = "KHR_mesh_quantization" in gltf.json.get("extensionsRequired", ())
    components = components | SMALL.get(name.split("_")[0], set()) if small else components
    gltf.say(accessor["componentType"] in components, f"3.7.2.1: {name}'s components")
    if small and name.split("_")[0] in SMALL:
        must = name in ("NORMAL", "TANGENT") and accessor["componentType"] != 5126
        gltf.say(not must or accessor.get("normalized"), f"KHR_mesh_quantization: {name} is not normalised")
    elif normalized and accessor["componentType"] != 5126:
        gltf.say(accessor.get("normalized") is True, f"3.7.2.1: {name} is not normalised")
    else:
        gltf.say("normalized" not in accessor, f"3.7.2.1: {name} is normalised")


def _check_primitive(gltf, primitive, joint_count):
    for name, number in primitive["attributes"].items():
        _check_attribute(gltf, name, number)
    given = gltf.attributes(primitive)
    counts = {len(values) for values in given.values()}
    gltf.say(len(counts) == 1, "3.7.2.1: attributes of different length")
    position = gltf.json["accessors"][primitive["attributes"]["POSITION"]]
    gltf.say("min" in position and "max" in position, "3.7.2.1: positions without bounds")
    normal = primitive["attributes"]["NORMAL"]
    lengths = np.linalg.norm(gltf.values(normal), axis=1)
    error = 1e-4 if gltf.json["accessors"][normal]["componentType"] == 5126 else SMALL_LENGTH
    gltf.say(np.abs(lengths - 1).max() < error, "3.7.2.1: normals are not of unit length")
    bumpy = "normalTexture" in gltf.json["materials"][primitive["material"]]
    gltf.say(bumpy == ("TANGENT" in given), "3.7.2.1: tangents are there exactly for a normal texture")
    if bumpy:
        tangent = gltf.values(primitive["attributes"]["TANGENT"])
        away = np.abs(np.linalg.norm(tangent[:, :3], axis=1) - 1).max()
        gltf.say(away < error, "3.7.2.1: tangents are not of unit length")
        gltf.say((np.abs(tangent[:, 3]) == 1).all(), "3.7.2.1: a tangent's w is not 1 or -1")
    for stem in ("TEXCOORD", "COLOR", "JOINTS", "WEIGHTS"):
        there = sorted(int(name.split("_")[1]) for name in given if name.startswith(stem + "_"))
        gltf.say(there == list(range(len(there))), f"3.7.2.1: {stem} is not numbered from 0 on")
    accessor = gltf.json["accessors"][primitive["indices"]]
    gltf.say(accessor["type"] == "SCALAR" and "normalized" not in accessor, "3.7.2.1: indices' type")
    gltf.say(accessor["componentType"] in (5121, 5123, 5125), "3.7.2.1: indices' components")
    view = gltf.json["bufferViews"][accessor["bufferView"]]
    gltf.say(view.get("target") in (None, INDICES) and "byteStride" not in view, "3.6.2.4: indices' view")
    indices = gltf.array(primitive["indices"])
    restart = np.iinfo(indices.dtype).max
    gltf.say(indices.max() < min(counts) and indices.max() < restart, "3.7.2.1: an index leaves the vertices")
    gltf.say(len(indices) % 3 == 0, "3.7.2.2: indices are not whole triangles")
    _check_skinning(gltf, primitive, joint_count)
    _check_texcoords(gltf, primitive, given)


def _check_skinning(gltf, primitive, joint_count):
    """3.7.3.3"""
    given = gltf.attributes(primitive)
    gltf.say(("JOINTS_0" in given) == (joint_count > 0), "3.7.3.3: joints without a skin, or a skin without")
    if not joint_count:
        return
    joints, weights = given["JOINTS_0"], gltf.values(primitive["attributes"]["WEIGHTS_0"])
    gltf.say(joints.max() < joint_count, "3.7.3.3: a joint that the skin has not")
    gltf.say(weights.min() >= 0, "3.7.3.3: a weight below 0")
    gltf.say(np.abs(weights.sum(axis=1) - 1).max() < 2e-7 * 4, "3.7.3.3: weights do not sum to 1")
    gltf.say((joints[weights == 0] == 0).all(), "3.7.3.3: a joint without weight is not 0")
    used = np.where(weights > 0, joints, -1 - np.arange(4))
    gltf.say(all(len(set(row)) == 4 for row in np.unique(used, axis=0).tolist()), "3.7.3.3: a joint twice")


def _check_texcoords(gltf, primitive, given):
    material = gltf.json["materials"][primitive["material"]]
    surface = material["pbrMetallicRoughness"]
    for info in (surface.get("baseColorTexture"), material.get("normalTexture")):
        if info is not None:
            gltf.say(
                f"TEXCOORD_{info.get('texCoord', 0)}" in given, "3.9.2: a texture on UVs that are not there"
            )
            data, kind = gltf.image(info["index"])
            png, jpeg = data.startswith(b"\x89PNG\r\n\x1a\n"), data.startswith(b"\xff\xd8\xff")
            gltf.say(png or jpeg, "3.8.3: an image that is neither PNG nor JPEG")
            gltf.say(kind in (None, "image/png" if png else "image/jpeg"), "3.8.3: the wrong MIME type")
    cutoff = "alphaCutoff" in material
    gltf.say(cutoff == (material.get("alphaMode") == "MASK"), "3.9.4: a cutoff without MASK")


def _check_nodes(gltf):
    """3.5: a strict tree, whose roots are in the scene or levels of detail of one that is."""
    nodes = gltf.json["nodes"]
    children = [child for node in nodes for child in node.get("children", ())]
    gltf.say(len(children) == len(set(children)), "3.5.2: a node with two parents")
    roots = set(range(len(nodes))) - set(children)
    shown = set(gltf.json["scenes"][gltf.json["scene"]]["nodes"])
    coarser = [
        number for node in nodes for number in node.get("extensions", {}).get("MSFT_lod", {}).get("ids", ())
    ]
    gltf.say(shown <= roots, "3.5.1: the scene names a node that is no root")
    gltf.say(
        not shown & set(coarser) and len(coarser) == len(set(coarser)), "MSFT_lod: a level is used twice"
    )
    gltf.say(roots == shown | set(coarser), "a node that nobody shows")
    for node in nodes:
        length = np.linalg.norm(node.get("rotation", (0, 0, 0, 1)))
        gltf.say(abs(length - 1) < 1e-6, f"5.25: the rotation of {node['name']} is not of unit length")
        gltf.say("skin" not in node or "mesh" in node, "3.7.3.2: a skin without a mesh")
        if "MSFT_lod" in node.get("extensions", {}):
            coverage = node["extras"]["MSFT_screencoverage"]
            ids = node["extensions"]["MSFT_lod"]["ids"]
            gltf.say(len(coverage) == len(ids) + 1, "MSFT_lod: as many coverages as levels")
            gltf.say(coverage == sorted(coverage, reverse=True), "MSFT_lod: coverages do not fall")


def _check_animations(gltf):
    """3.11"""
    for animation in gltf.json.get("animations", ()):
        targets = [
            (channel["target"]["node"], channel["target"]["path"]) for channel in animation["channels"]
        ]
        gltf.say(len(targets) == len(set(targets)), "3.11: two channels move one node")
        for sampler in animation["samplers"]:
            clock = gltf.json["accessors"][sampler["input"]]
            gltf.say("min" in clock and "max" in clock, "3.11: times without bounds")
            moments, turns = gltf.array(sampler["input"])[:, 0], gltf.values(sampler["output"])
            gltf.say((np.diff(moments) > 0).all() and moments[0] >= 0, "3.11: times do not rise")
            gltf.say(len(moments) == len(turns), "3.11: as many keys as times")
            away = np.abs(np.linalg.norm(turns, axis=1) - 1).max()
            gltf.say(away < 1e-4, "3.11: rotations are not of unit length")


def _check_skins(gltf):
    """3.7.3.1"""
    nodes = gltf.json["nodes"]
    for skin in gltf.json.get("skins", ()):
        accessor = gltf.json["accessors"][skin["inverseBindMatrices"]]
        gltf.say(
            accessor["type"] == "MAT4" and accessor["componentType"] == 5126, "3.7.3.1: bind matrices' type"
        )
        gltf.say(accessor["count"] == len(skin["joints"]), "3.7.3.1: as many bind matrices as joints")
        gltf.say(len(set(skin["joints"])) == len(skin["joints"]), "3.7.3.1: a joint twice")
        last_rows = gltf.array(skin["inverseBindMatrices"]).reshape(-1, 4, 4)[:, :, 3]
        gltf.say((last_rows == (0, 0, 0, 1)).all(), "3.7.3.1: a bind matrix is not affine")
        below, waiting = set(), [skin["skeleton"]]
        while waiting:
            below.add(waiting[-1])
            waiting += nodes[waiting.pop()].get("children", ())
        gltf.say(set(skin["joints"]) <= below, "3.7.3.1: skeleton is no root of all joints")


def errors(path):
    """The violations of the specification in a file, as texts."""
    gltf = Gltf(path)
    gltf.say(gltf.json["asset"]["version"] == "2.0", "3.2: the version")
    gltf.say(not [k for k, v in gltf.json.items() if isinstance(v, list) and not v], "3.1: an empty table")
    _check_accessors(gltf)
    _check_nodes(gltf)
    _check_skins(gltf)
    _check_animations(gltf)
    for node in gltf.json["nodes"]:
        if "mesh" in node:
            joint_count = len(gltf.json["skins"][node["skin"]]["joints"]) if "skin" in node else 0
            for primitive in gltf.primitives(node):
                _check_primitive(gltf, primitive, joint_count)
    text = json.dumps(gltf.json)
    for name in ("MSFT_lod", "KHR_texture_transform"):
        gltf.say((f'"{name}": {{' in text) == (name in gltf.json.get("extensionsUsed", ())), f"3.12: {name}")
    return gltf.errors
