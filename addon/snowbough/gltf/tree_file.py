# SPDX-License-Identifier: GPL-3.0-or-later
"""A tree as glTF 2.0: skin, meshes in levels of detail, materials, motion, and parameters for shaders. No ``bpy``.

The extension MSFT_lod (Khronos Group's registry of extensions, vendor MSFT) connects the levels: the node of the finest
level is in the scene and lists the others. Axes and units are glTF's: metres, Y up, +X right seen from +Z, UV origin
top-left.
"""

import numpy as np

from ..tree.wind_attributes import AXIS, LENGTH, PHASE, PIVOT
from . import quantise
from .document import INDICES, VERTICES, Document
from .tangents import orientations, tangents
from .tree_data import SNOW_COLOR, SNOW_ROUGHNESS, STILL, Material, local_rests, quaternion, times
from .triangle_mesh import limb_widths, point_normals, split

GENERATOR = "Snowbough"
MSFT_LOD, TEXTURE_TRANSFORM = "MSFT_lod", "KHR_texture_transform"
QUANTIZATION = "KHR_mesh_quantization"
# From Blender's axes to glTF's: (x, y, z) -> (x, z, -y).
TO_Y_UP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
UPRIGHT = np.eye(4)
UPRIGHT[:3, :3] = TO_Y_UP
FORMULA = "T = T_p * (1 - level / levels)"
# Significant digits of the numbers of nodes.
DIGITS = 7


def _y_up(points):
    return np.ascontiguousarray(np.asarray(points) @ TO_Y_UP.T, dtype=np.float32)


def _numbers(values):
    return [float(f"{value:.{DIGITS}g}") for value in values]


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


def screen_coverage(levels):
    """MSFT_screencoverage: the share of the screen at which each level ends. Each level ends at half the height of the
    level before, a quarter of the area; the last level never ends."""
    return [*(0.25 ** (number + 1) for number in range(levels - 1)), 0.0]


class _Writer:
    """Writes one tree to a new Document.

    quantised: store vertices with the extension KHR_mesh_quantization, all on one grid, so that meshes of one place
    fit. Joints ignore the transforms of the meshes' nodes, so the inverse bind matrices contain the grid. compressed:
    see Document.
    """

    def __init__(self, tree, quantised, compressed):
        self.document = Document(GENERATOR, compressed)
        self._tree, self._grid = tree, None
        if quantised:
            self._grid = quantise.Grid(np.concatenate([_y_up(points) for points in _all_points(tree)]))
            self.document.use_extension(QUANTIZATION, required=True)
        self._root, self._joints = self._add_joints()
        self._skin = self._add_skin() if tree.parts else None

    def _add_joints(self):
        """Adds the joints as nodes below a root node with the tree's name. Returns (root node, [node])."""
        document, joints = self.document, self._tree.joints
        root, nodes = document.add("nodes", {"name": self._tree.name}), []
        locals_ = local_rests(joints, UPRIGHT)
        self._rests = [quaternion(local[:3, :3]) for local in locals_]
        for joint, local, rotation in zip(joints, locals_, self._rests):
            node = {
                "name": joint.name,
                "translation": _numbers(local[:3, 3]),
                "rotation": _numbers(rotation),
            }
            nodes.append(document.add("nodes", node))
            above = root if joint.parent < 0 else nodes[joint.parent]
            document.json["nodes"][above].setdefault("children", []).append(nodes[-1])
        return root, nodes

    def _add_skin(self):
        inverse = []
        for joint in self._tree.joints:
            bind = np.linalg.inv(UPRIGHT @ joint.rest)
            if self._grid is not None:
                bind = bind @ self._grid.matrix
            bind[3] = (0.0, 0.0, 0.0, 1.0)  # exactly, as the specification requires
            inverse.append(bind.T)
        bind = self.document.add_accessor(np.array(inverse, dtype=np.float32))
        skin = {"name": self._tree.name, "inverseBindMatrices": bind, "skeleton": self._root}
        return self.document.add("skins", {**skin, "joints": self._joints})

    def _add_motion(self, motion):
        """Adds a looping animation. Joints that do not move have no channel."""
        local = times(np.array(self._rests), motion.turns)
        # Neighbouring keys on the same side of the sphere of quaternions: players interpolate along the shorter arc.
        dots = (local[1:] * local[:-1]).sum(axis=-1, keepdims=True)
        local[1:] *= np.cumprod(np.where(dots < 0, -1.0, 1.0), axis=0)
        moved = np.flatnonzero(np.abs(motion.turns[..., :3]).max(axis=(0, 2)) >= STILL)
        clock = self.document.add_accessor(motion.times.astype(np.float32), bounds=True)
        tracks = self.document.add_tracks(quantise.rotations(local[:, moved].transpose(1, 0, 2)))
        samplers = [{"input": clock, "output": track} for track in tracks]
        channels = [
            {"sampler": number, "target": {"node": self._joints[joint], "path": "rotation"}}
            for number, joint in enumerate(moved.tolist())
        ]
        name = f"{self._tree.name}_sway"
        self.document.add("animations", {"name": name, "samplers": samplers, "channels": channels})

    def _shape(self, points, normals):
        """The attributes POSITION and NORMAL of points and normals (N, 3), Z up."""
        points, normals, small = _y_up(points), _y_up(normals), self._grid is not None
        if small:
            points, normals = self._grid.numbers(points), quantise.normals(normals)
        add = self.document.add_accessor
        return {
            "POSITION": add(points, VERTICES, bounds=True),
            "NORMAL": add(normals, VERTICES, normalized=small),
        }

    def _add_uv(self, uv):
        flipped = np.stack([uv[:, 0], 1.0 - uv[:, 1]], axis=1).astype(np.float32)
        if self._grid is not None:
            flipped = quantise.texture_coordinates(flipped)
        return self.document.add_accessor(flipped, VERTICES, normalized=flipped.dtype == np.uint16)

    def _add_influences(self, joints, weights):
        if self._grid is None:
            joints, weights = joints.astype(np.uint16), weights.astype(np.float32)
        else:
            weights = quantise.weights(weights)
            joints = np.where(weights > 0, joints, 0)
            joints = joints.astype(np.uint8 if len(self._joints) <= 256 else np.uint16)
        add = self.document.add_accessor
        return {
            "JOINTS_0": add(joints, VERTICES),
            "WEIGHTS_0": add(weights, VERTICES, normalized=weights.dtype == np.uint8),
        }

    def _add_indices(self, triangles, vertices):
        width = _index_type(vertices)
        return self.document.add_accessor(triangles.reshape(-1).astype(width), INDICES)

    def _add_tangents(self, points, vertices, uv):
        made = tangents(points, vertices.normals, uv, vertices.triangles)
        made[:, :3] = _y_up(made[:, :3])
        if self._grid is not None:
            made = quantise.normals(made)
        return self.document.add_accessor(made, VERTICES, normalized=self._grid is not None)

    def _add_primitive(self, surface, chosen, material, bump):
        """material: its number in the document; bump: its normal texture, which needs tangents, or None."""
        labels = None
        if bump is not None:
            labels = orientations(surface.corner_uvs[bump.texcoord][surface.triangles[chosen]])
        vertices = split(surface, chosen, labels)
        add = self.document.add_accessor
        points = surface.points[vertices.point]
        attributes = self._shape(points, vertices.normals)
        if bump is not None:
            attributes["TANGENT"] = self._add_tangents(points, vertices, vertices.uvs[bump.texcoord])
        for number, uv in enumerate(vertices.uvs):
            attributes[f"TEXCOORD_{number}"] = self._add_uv(uv)
        if surface.level is not None:
            level = surface.level[vertices.point]
            color = level_color(level, self._tree.branch_levels)
            attributes["COLOR_0"] = add(color, VERTICES, normalized=True)
            attributes["_BRANCH_LEVEL"] = add(level.astype(np.float32), VERTICES)
            if "snow" in self._tree.extras:
                attributes["_LIMB_WIDTH"] = add(limb_widths(surface)[vertices.point], VERTICES)
        if surface.wind is not None:
            pivot, axis, length, phase = (
                values[vertices.point].astype(np.float32) for values in surface.wind
            )
            for name, values in (
                (PIVOT, _y_up(pivot)),
                (AXIS, _y_up(axis)),
                (LENGTH, length),
                (PHASE, phase),
            ):
                attributes[name] = add(values, VERTICES)
        joints, weights = surface.joints[vertices.point], surface.weights[vertices.point]
        attributes.update(self._add_influences(joints, weights))
        indices = self._add_indices(vertices.triangles, len(vertices.point))
        return {"attributes": attributes, "indices": indices, "material": material}

    def _add_node(self, name, primitives, skinned):
        """Adds a mesh and its node. The node has the grid's transform unless joints move it."""
        mesh = self.document.add("meshes", {"name": name, "primitives": primitives})
        placed = {} if self._grid is None else self._grid.transform
        return self.document.add(
            "nodes", {"name": name, "mesh": mesh, **({"skin": self._skin} if skinned else placed)}
        )

    def _add_surface(self, name, surface, part, materials):
        primitives = [
            self._add_primitive(
                surface, surface.material == number, materials[number], part.materials[number].normal
            )
            for number in np.unique(surface.material).tolist()
        ]
        return self._add_node(name, primitives, skinned=True)

    def _add_empty(self, name):
        return self.document.add("nodes", {"name": name})

    def _link(self, nodes, coverage):
        """Lists the nodes after the first in MSFT_lod. coverage: see screen_coverage."""
        self.document.use_extension(MSFT_LOD)
        finest = self.document.json["nodes"][nodes[0]]
        finest["extensions"] = {MSFT_LOD: {"ids": nodes[1:]}}
        finest["extras"] = {"MSFT_screencoverage": coverage}

    def _add_part(self, part, first_level, last):
        """Adds a part. Returns the node of its finest level, which lists the coarser levels and `last` in MSFT_lod."""
        used = np.unique(np.concatenate([surface.material for surface in part.levels])).tolist()
        materials = {number: _add_material(self.document, part.materials[number]) for number in used}
        nodes = [
            self._add_surface(f"{part.name}_LOD{number}", surface, part, materials)
            for number, surface in enumerate(part.levels, first_level)
        ]
        nodes += last
        if len(nodes) > 1:
            self._link(nodes, screen_coverage(len(nodes)))
        return nodes[0]

    def _add_cards(self):
        cards = self._tree.cards
        attributes = {**self._shape(cards.points, cards.normals), "TEXCOORD_0": self._add_uv(cards.uv)}
        indices = self._add_indices(cards.triangles, len(cards.points))
        material = _add_material(self.document, cards.material)
        return self._add_node(
            cards.name, [{"attributes": attributes, "indices": indices, "material": material}], skinned=False
        )

    def _add_snow(self, mesh, material):
        """Adds a SnowMesh. Returns its node."""
        attributes = self._shape(mesh.points, point_normals(mesh.points, mesh.triangles))
        indices = self._add_indices(mesh.triangles, len(mesh.points))
        return self._add_node(
            mesh.name, [{"attributes": attributes, "indices": indices, "material": material}], skinned=False
        )

    def _add_all(self, first_level):
        """Adds all meshes. Returns the nodes of the finest levels."""
        tree, nodes = self._tree, []
        for part in tree.parts:
            last = []
            if tree.cards is not None:
                # The cards replace everything: the first part lists them, the others list an empty node.
                last = [
                    self._add_empty(f"{part.name}_LOD{first_level + len(part.levels)}")
                    if nodes
                    else self._add_cards()
                ]
            # Nodes with a skin are siblings of the joints, because their parents do not move them.
            nodes.append(self._add_part(part, first_level, last))
        if tree.cards is not None and not tree.parts:
            nodes.append(self._add_cards())
        if tree.snow_meshes:
            snow = _add_material(self.document, Material("Snow", SNOW_COLOR, SNOW_ROUGHNESS))
            for mesh in tree.snow_meshes:
                nodes.append(self._add_snow(mesh, snow))
                if tree.cards is not None:
                    ends = screen_coverage(1 + len(tree.parts[0].levels))[-2]
                    self._link([nodes[-1], self._add_empty(f"{mesh.name}_none")], [ends, 0.0])
        return nodes

    def write(self, first_level):
        tree, document = self._tree, self.document
        if tree.motion is not None:
            self._add_motion(tree.motion)
        nodes = self._add_all(first_level)
        said = {"branch_levels": tree.branch_levels, "tessellation": FORMULA, **tree.extras}
        scene = {"name": tree.name, "nodes": [self._root, *nodes], "extras": {"snowbough": said}}
        document.add("scenes", scene)
        document.json["scene"] = 0
        return document


def _all_points(tree):
    """[float (N, 3)]: the points of all meshes."""
    surfaces = [surface.points for part in tree.parts for surface in part.levels]
    cards = [tree.cards.points] if tree.cards is not None else []
    return [*surfaces, *cards, *(mesh.points for mesh in tree.snow_meshes)]


def build(tree, first_level=0, quantised=False, compressed=False):
    """The Document of a Tree. first_level: number in the name of the finest level, _LOD<first_level>; quantised,
    compressed: see _Writer. Raises ValueError for a number of bones that glTF cannot store."""
    if not tree.joints or len(tree.joints) > 65536:
        raise ValueError(f"a glTF skin must have 1 to 65,536 bones, not {len(tree.joints)}")
    return _Writer(tree, quantised, compressed).write(first_level)
