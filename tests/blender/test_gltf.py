# SPDX-License-Identifier: GPL-3.0-or-later
"""Trees leave Blender through glTF with their skin: the .glb is read back and bent as Blender bends it.

tests/support/glb.py reads it: the importer that comes with Blender 3.4 fails on current numpy.
"""

import math

import bpy
import numpy as np
import pytest
from exported_tree import MAPLE, glb, rest_points
from mathutils.kdtree import KDTree
from synthetic_tree import evaluated_vertices


def bark_of(read):
    """(positions (V, 3) in Blender's axes, deformed by the joints; the primitive's attributes)."""
    node = next(n for n in read.json["nodes"] if n.get("name") == "small_maple_bark" and "skin" in n)
    (primitive,), (bent,) = read.primitives(node), read.skinned(node)
    return bent[:, (0, 2, 1)] * (1, -1, 1), read.attributes(primitive)


def _export(path, **wanted):
    """Exports the scene with the settings that this Blender's exporter supports."""
    if not hasattr(bpy.ops.export_scene, "gltf") or "export_scene" not in dir(bpy.ops):
        pytest.skip("this Blender has no glTF exporter")
    known = bpy.ops.export_scene.gltf.get_rna_type().properties.keys()
    bpy.ops.export_scene.gltf(filepath=str(path), **{k: v for k, v in wanted.items() if k in known})
    return glb.Gltf(path)


@pytest.fixture(scope="module", autouse=True)
def exporter():
    import addon_utils

    if addon_utils.enable("io_scene_gltf2", default_set=True) is None:
        pytest.skip("this Blender has no glTF exporter")


@pytest.fixture
def bent_tree(tmp_path):
    """The maple with three bones bent; (bark object, Gltf)."""
    bpy.ops.import_scene.xfrog_tree(filepath=str(MAPLE), max_bones=120)
    rig, bark = bpy.data.objects["small_maple"], bpy.data.objects["small_maple_bark"]
    for number, angle in ((1, 0.3), (5, -0.4), (40, 0.8)):
        bone = rig.pose.bones[number]
        bone.rotation_mode = "XYZ"
        bone.rotation_euler = (angle, 0.0, math.radians(10))
    bpy.context.view_layer.update()
    read = _export(
        tmp_path / "tree.glb",
        export_current_frame=True,
        export_rest_position_armature=False,
        export_animations=False,
        export_attributes=True,
        export_materials="NONE",
        export_all_influences=False,
    )
    return bark, read


def _nearest(points, reference):
    """Distance of each point to the nearest of `reference`."""
    tree = KDTree(len(reference))
    for number, place in enumerate(reference):
        tree.insert(place, number)
    tree.balance()
    return np.array([tree.find(point)[2] for point in points])


def test_the_skin_bends_outside_blender_as_inside(bent_tree):
    bark, read = bent_tree
    inside = evaluated_vertices(bark)
    assert np.linalg.norm(inside - rest_points(bark), axis=1).max() > 0.1
    outside, _attributes = bark_of(read)
    # glTF splits vertices at UV seams, so their order is not Blender's.
    assert _nearest(outside, inside).max() < 1e-3
    assert _nearest(inside, outside).max() < 1e-3


def test_four_influences_that_sum_to_one(bent_tree):
    _bark, read = bent_tree
    _bent, attributes = bark_of(read)
    assert "JOINTS_1" not in attributes
    assert np.abs(attributes["WEIGHTS_0"].sum(axis=1) - 1).max() < 1e-5


def test_both_uv_maps_and_the_branch_level_of_points_survive(bent_tree):
    _bark, read = bent_tree
    _bent, attributes = bark_of(read)
    assert attributes["TEXCOORD_0"].max() > 1.0  # bark tiles
    assert 0 <= attributes["TEXCOORD_1"].min() and attributes["TEXCOORD_1"].max() <= 1  # snow does not
    assert set(np.unique(attributes["_BRANCH_LEVEL"])) == {0.0, 1.0}


def test_every_bone_is_a_joint(bent_tree):
    bark, read = bent_tree
    names = {bone.name for bone in bark.modifiers[0].object.data.bones}
    joints = {read.json["nodes"][joint]["name"] for skin in read.json["skins"] for joint in skin["joints"]}
    # Newer exporters add a joint of their own for vertices without a bone.
    assert names <= joints and len(joints) <= len(names) + 1
