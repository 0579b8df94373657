# SPDX-License-Identifier: GPL-3.0-or-later
"""The armature: names, hierarchy, bone budget, weights and what they deform."""

import math
import sys

import bpy
import numpy as np
import pytest
from conftest import ROOT
from exported_tree import PLAIN, assert_follows, assert_weighted, export, import_tree
from synthetic_tree import build_synthetic, evaluated_vertices, synthetic_bones

sys.path.insert(0, str(ROOT / "tests" / "support"))
import tube_tree  # noqa: E402


def _weights(obj):
    """{group name: {vertex: weight}}"""
    names = [group.name for group in obj.vertex_groups]
    table = {name: {} for name in names}
    for vertex in obj.data.vertices:
        for entry in vertex.groups:
            table[names[entry.group]][vertex.index] = entry.weight
    return table


def test_one_bone_a_segment_with_names_parents_and_positions(addon):
    bones = synthetic_bones()
    rig, _bark = build_synthetic(addon, bones)
    assert len(rig.data.bones) == len(bones["names"])
    for name, head, tail, parent in zip(bones["names"], bones["heads"], bones["tails"], bones["parents"]):
        bone = rig.data.bones[name]
        assert np.allclose(bone.head_local, head, atol=1e-5)
        assert np.allclose(bone.tail_local, tail, atol=1e-5)
        assert (bone.parent.name if bone.parent else None) == (
            bones["names"][parent] if parent >= 0 else None
        )


def test_bones_carry_the_limbs_radii_and_are_plain(addon):
    bones = synthetic_bones()
    rig, _bark = build_synthetic(addon, bones)
    bone = rig.data.bones["branch1.0"]
    assert math.isclose(bone.head_radius, 0.05, abs_tol=1e-6)
    assert math.isclose(bone.tail_radius, 0.04, abs_tol=1e-6)
    assert {b.bbone_segments for b in rig.data.bones} == {1}


def test_only_segments_that_continue_their_branch_are_connected(addon):
    rig, _bark = build_synthetic(addon)
    assert rig.data.bones["trunk1.1"].use_connect
    assert rig.data.bones["branch1.2"].use_connect
    assert not rig.data.bones["branch1.0"].use_connect


@pytest.fixture
def stems(tmp_path):
    """The file of two stems."""
    path = tmp_path / "stems.obj"
    limbs = [((x, 0, 0), (0.1 * x, 0, 1), 5.0, 0.2) for x in (0, 1)]
    path.write_text(tube_tree.obj_text(limbs, groups=("trunk1", "trunk2")))
    return path


@pytest.mark.parametrize("keep_surface", [False, True])
def test_stems_hang_from_one_root_bone(addon, stems, keep_surface):
    rig, bark = import_tree(stems, keep_surface=keep_surface)
    bones = rig.data.bones
    assert [bone.name for bone in bones if bone.parent is None] == ["root"]
    assert len(bones["root"].children) == 2
    assert_weighted(bark)
    assert keep_surface or not _weights(bark)["root"]
    assert_follows(bark, rig)


@pytest.mark.parametrize("suffix", ["glb", "usda"])
def test_files_have_the_root_bone_as_the_only_root_joint(addon, tmp_path, stems, suffix):
    path = tmp_path / f"stems.{suffix}"
    import_tree(stems)
    if suffix == "glb":
        file = export(path).json
        joints = file["skins"][0]["joints"]
        below = {child for joint in joints for child in file["nodes"][joint].get("children", ())}
        roots = [file["nodes"][joint]["name"] for joint in joints if joint not in below]
    else:
        usd = pytest.importorskip("pxr.Usd")
        assert bpy.ops.export_scene.snowbough_tree(filepath=str(path), **PLAIN) == {"FINISHED"}
        joints = usd.Stage.Open(str(path)).GetPrimAtPath("/stems/Skin/Skeleton").GetAttribute("joints").Get()
        roots = [joint for joint in joints if "/" not in joint]
    assert roots == ["root"]


def test_stems_sway_about_a_root_bone_that_hardly_moves(addon, stems):
    rig, bark = import_tree(stems)
    rest = evaluated_vertices(bark)
    bpy.context.view_layer.objects.active = rig
    assert bpy.ops.snowbough.add_sway(loop_frames=48, seed=3) == {"FINISHED"}
    moved = np.zeros(len(rest))
    for frame in range(1, 49, 6):
        bpy.context.scene.frame_set(frame)
        moved = np.maximum(moved, np.linalg.norm(evaluated_vertices(bark) - rest, axis=1))
    assert moved[rest[:, 2] < 0.01].max() < 0.05 * moved.max()
    for side in (rest[:, 0] < 0.5, rest[:, 0] > 0.5):
        assert moved[side].max() > 0.05


def test_an_older_rig_with_a_root_bone_each_keeps_its_bones(addon, stems):
    rig, _bark = import_tree(stems)
    kept_skeleton, texts = addon("tree.kept_skeleton"), addon("tree.skeleton_text")
    branches, built = texts.from_text(rig.data.snowbough_skeleton)
    assert built.pop("root_bone")
    now = kept_skeleton.base_arrays(rig.data)
    rig.data.snowbough_skeleton = texts.to_text(branches, built)
    old = kept_skeleton.base_arrays(rig.data)
    # The vertices' bones by number, as the older armature has them.
    assert old["bone_indices"].max() == now["bone_indices"].max() - 1


def test_bones_are_grouped_by_branch_level(addon):
    rig, _bark = build_synthetic(addon)
    if hasattr(rig.data, "collections"):
        assert [c.name for c in rig.data.collections] == ["Level 0", "Level 1", "Level 2"]
        assert {b.name for b in rig.data.collections["Level 0"].bones} == {f"trunk1.{k}" for k in range(4)}
    else:
        assert [i for i, on in enumerate(rig.data.layers) if on] == [0, 1, 2]
        assert [i for i, on in enumerate(rig.data.bones["branch1.0"].layers) if on] == [1]


def test_a_bone_too_short_for_blender_stays(addon):
    bones = synthetic_bones()
    last = len(bones["names"]) - 1
    bones["tails"][last] = bones["heads"][last]
    rig, _bark = build_synthetic(addon, bones)
    assert bones["names"][last] in rig.data.bones


def test_names_are_shortened_to_63_bytes_and_stay_unique(addon):
    fitting_names = addon("tree.bone_names").fitting_names
    long = "Ä" * 40
    names = [f"{long}.1", f"{long}é.1", f"{long}.2", "short.1", "short.1"]
    fitted = fitting_names(names)
    assert all(len(name.encode()) <= 63 for name in fitted)
    assert len(set(fitted)) == len(names)
    assert fitted[0].endswith(".1") and fitted[2].endswith(".2")
    assert fitted[3] == "short.1" and fitted[4] != "short.1"
    assert fitting_names(names) == fitted


def test_long_names_reach_bones_and_vertex_groups_alike(addon):
    bones = synthetic_bones()
    bones["names"] = [f"{'a very long branch name ' * 4}{name}" for name in bones["names"]]
    rig, bark = build_synthetic(addon, bones)
    assert {g.name for g in bark.vertex_groups} == {b.name for b in rig.data.bones}
    assert len(rig.data.bones) == len(bones["names"])


def test_bending_a_bone_moves_only_what_it_or_its_descendants_carry(addon):
    bones = synthetic_bones()
    rig, bark = build_synthetic(addon, bones)
    rest = evaluated_vertices(bark)
    bone = rig.pose.bones["branch1.1"]
    bone.rotation_mode = "XYZ"
    bone.rotation_euler = (math.radians(45), 0, 0)
    moved = np.linalg.norm(evaluated_vertices(bark) - rest, axis=1)
    carried = {bone.name} | {child.name for child in rig.data.bones["branch1.1"].children_recursive}
    table = _weights(bark)
    touched = {vertex for name in carried for vertex in table[name]}
    others = sorted(set(range(len(moved))) - touched)
    assert moved[others].max() < 1e-5
    assert moved[sorted(touched)].max() > 0.1


def test_a_thousand_bones_are_all_made(addon):
    bones = synthetic_bones(branches=60, segments=3, twigs=5)
    assert len(bones["names"]) > 1000
    rig, _bark = build_synthetic(addon, bones)
    assert len(rig.data.bones) == len(bones["names"])
