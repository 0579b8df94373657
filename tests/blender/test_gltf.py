# SPDX-License-Identifier: GPL-3.0-or-later
"""Trees leave Blender through glTF with their skin: the .glb is read back and bent as Blender bends it.

The reader below is our own (Khronos Group, glTF 2.0 Specification, sections 3.6 and 3.7.3): the importer
that comes with Blender 3.4 fails on current numpy.
"""

import json
import math
import struct

import bpy
import numpy as np
import pytest
from conftest import ROOT
from synthetic_tree import evaluated_vertices

MAPLE = ROOT / "tests" / "data" / "small_maple.obj"
COMPONENTS = {5121: np.uint8, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}


class Glb:
    """A .glb file's JSON and its accessors as arrays."""

    def __init__(self, path):
        data = path.read_bytes()
        magic, version, length = struct.unpack_from("<4sII", data)
        assert (magic, version, length) == (b"glTF", 2, len(data))
        size, _kind = struct.unpack_from("<I4s", data, 12)
        self.json = json.loads(data[20 : 20 + size])
        self.binary = data[20 + size + 8 :]

    def array(self, number):
        accessor = self.json["accessors"][number]
        view = self.json["bufferViews"][accessor["bufferView"]]
        width, kind = WIDTHS[accessor["type"]], COMPONENTS[accessor["componentType"]]
        assert "byteStride" not in view, "interleaved buffers are not written by Blender"
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        flat = np.frombuffer(self.binary, kind, accessor["count"] * width, start)
        return flat.reshape(accessor["count"], width)

    def local_matrix(self, node):
        x, y, z, w = node.get("rotation", (0, 0, 0, 1))
        rotation = np.array(
            [
                [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
            ]
        )
        matrix = np.eye(4)
        matrix[:3, :3] = rotation * np.array(node.get("scale", (1, 1, 1)))
        matrix[:3, 3] = node.get("translation", (0, 0, 0))
        return matrix

    def world_matrices(self):
        nodes = self.json["nodes"]
        world = [None] * len(nodes)

        def visit(number, parent):
            world[number] = parent @ self.local_matrix(nodes[number])
            for child in nodes[number].get("children", ()):
                visit(child, world[number])

        for root in self.json["scenes"][0]["nodes"]:
            visit(root, np.eye(4))
        return world

    def skinned(self, name):
        """(positions (V, 3) in Blender's axes, deformed by the joints; the primitive's attributes)."""
        node = next(n for n in self.json["nodes"] if n.get("name") == name and "skin" in n)
        skin = self.json["skins"][node["skin"]]
        (primitive,) = self.json["meshes"][node["mesh"]]["primitives"]
        attributes = {key: self.array(number) for key, number in primitive["attributes"].items()}
        inverse = self.array(skin["inverseBindMatrices"]).reshape(-1, 4, 4).transpose(0, 2, 1).astype(float)
        world = self.world_matrices()
        joints = np.array([world[joint] for joint in skin["joints"]]) @ inverse
        positions = np.c_[attributes["POSITION"], np.ones(len(attributes["POSITION"]))]
        blend = np.einsum(
            "vk,vkij->vij", attributes["WEIGHTS_0"].astype(float), joints[attributes["JOINTS_0"]]
        )
        bent = np.einsum("vij,vj->vi", blend, positions)[:, :3]
        return bent[:, (0, 2, 1)] * (1, -1, 1), attributes


def _export(path, **wanted):
    """Exports the scene with the settings that this Blender's exporter supports."""
    if not hasattr(bpy.ops.export_scene, "gltf") or "export_scene" not in dir(bpy.ops):
        pytest.skip("this Blender has no glTF exporter")
    known = bpy.ops.export_scene.gltf.get_rna_type().properties.keys()
    bpy.ops.export_scene.gltf(filepath=str(path), **{k: v for k, v in wanted.items() if k in known})
    return Glb(path)


@pytest.fixture(scope="module", autouse=True)
def exporter():
    import addon_utils

    if addon_utils.enable("io_scene_gltf2", default_set=True) is None:
        pytest.skip("this Blender has no glTF exporter")


@pytest.fixture
def bent_tree(tmp_path):
    """The maple with three bones bent; (bark object, Glb)."""
    bpy.ops.import_scene.xfrog_tree(filepath=str(MAPLE), max_bones=120)
    rig, bark = bpy.data.objects["small_maple"], bpy.data.objects["small_maple_bark"]
    for number, angle in ((1, 0.3), (5, -0.4), (40, 0.8)):
        bone = rig.pose.bones[number]
        bone.rotation_mode = "XYZ"
        bone.rotation_euler = (angle, 0.0, math.radians(10))
    bpy.context.view_layer.update()
    glb = _export(
        tmp_path / "tree.glb",
        export_current_frame=True,
        export_rest_position_armature=False,
        export_animations=False,
        export_attributes=True,
        export_materials="NONE",
        export_all_influences=False,
    )
    return bark, glb


def _nearest(points, reference):
    """Distance of each point to the nearest of `reference`."""
    best = np.full(len(points), np.inf)
    for start in range(0, len(reference), 500):
        distance = np.linalg.norm(points[:, None] - reference[None, start : start + 500], axis=2)
        best = np.minimum(best, distance.min(axis=1))
    return best


def test_the_skin_bends_outside_blender_as_inside(bent_tree):
    bark, glb = bent_tree
    inside = evaluated_vertices(bark)
    rest = np.array([vertex.co for vertex in bark.data.vertices])
    assert np.linalg.norm(inside - rest, axis=1).max() > 0.1
    outside, _attributes = glb.skinned("small_maple_bark")
    # glTF splits vertices at UV seams, so their order is not Blender's.
    assert _nearest(outside, inside).max() < 1e-3
    assert _nearest(inside, outside).max() < 1e-3


def test_four_influences_that_sum_to_one(bent_tree):
    _bark, glb = bent_tree
    _bent, attributes = glb.skinned("small_maple_bark")
    assert "JOINTS_1" not in attributes
    assert np.abs(attributes["WEIGHTS_0"].sum(axis=1) - 1).max() < 1e-5


def test_both_uv_maps_and_the_branch_level_of_points_survive(bent_tree):
    _bark, glb = bent_tree
    _bent, attributes = glb.skinned("small_maple_bark")
    assert attributes["TEXCOORD_0"].max() > 1.0  # bark tiles
    assert 0 <= attributes["TEXCOORD_1"].min() and attributes["TEXCOORD_1"].max() <= 1  # snow does not
    assert set(np.unique(attributes["_BRANCH_LEVEL"])) == {0.0, 1.0}


def test_every_bone_is_a_joint(bent_tree):
    bark, glb = bent_tree
    names = {bone.name for bone in bark.modifiers[0].object.data.bones}
    joints = {glb.json["nodes"][joint]["name"] for skin in glb.json["skins"] for joint in skin["joints"]}
    # Newer exporters add a joint of their own for vertices without a bone.
    assert names <= joints and len(joints) <= len(names) + 1
