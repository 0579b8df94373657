# SPDX-License-Identifier: GPL-3.0-or-later
"""Bend under Snow: the pose of the keys, what they add to, and what they leave alone."""

import math
import sys
from pathlib import Path

import bpy
import numpy as np
import pytest
from conftest import ROOT
from exported_tree import import_tree
from snow_scene import manifest_of, receive, settings, square
from synthetic_tree import build_synthetic, evaluated_vertices

sys.path.insert(0, str(ROOT / "tests" / "support"))
import tube_tree  # noqa: E402

MAPLE = Path(__file__).resolve().parent.parent / "data" / "small_maple.obj"


def activate(obj):
    bpy.context.view_layer.objects.active = obj


def bend(rig, **values):
    """Presses the button; returns the bend's action."""
    for name, value in values.items():
        setattr(rig.snowbough.bending, name, value)
    activate(rig)
    assert bpy.ops.snowbough.bend_under_snow() == {"FINISHED"}
    return rig.animation_data.nla_tracks["Snow Load"].strips[0].action


def pose_at(rig, frame):
    """[(head, matrix_basis)] of the bones as Blender poses them."""
    bpy.context.scene.frame_set(frame)
    bones = rig.evaluated_get(bpy.context.evaluated_depsgraph_get()).pose.bones
    return [(np.array(bone.head), np.array(bone.matrix_basis)[:3, :3]) for bone in bones]


def lowest_tip(rig, frame):
    bpy.context.scene.frame_set(frame)
    bones = rig.evaluated_get(bpy.context.evaluated_depsgraph_get()).pose.bones
    return min(bone.tail[2] - bone.bone.tail_local[2] for bone in bones)


@pytest.fixture
def tree(addon, tmp_path):
    rig, bark = build_synthetic(addon)
    receive(bark)
    settings(tmp_path, frames=(1, 9), repose=math.radians(80.0))
    return rig, bark


@pytest.fixture
def maple(tmp_path):
    before = set(bpy.data.objects)
    bpy.ops.import_scene.xfrog_tree(filepath=str(MAPLE))
    made = [obj for obj in bpy.data.objects if obj not in before]
    receive(*(obj for obj in made if obj.type == "MESH"))
    settings(tmp_path, frames=(1, 9), repose=math.radians(80.0), cohesion=0.012, end_depth=0.15)
    return next(obj for obj in made if obj.type == "ARMATURE")


def spy_on_the_bend(addon, monkeypatch):
    """Records the arguments and the results of Cantilevers.bend."""
    cantilevers = addon("bending.cantilevers")
    seen = []

    class Spy(cantilevers.Cantilevers):
        def bend(self, *arguments):
            bent = super().bend(*arguments)
            seen.append((self, arguments, bent))
            return bent

    monkeypatch.setattr(addon("bending.bend"), "Cantilevers", Spy)
    return seen


def test_blenders_pose_is_the_computed_one(addon, monkeypatch, maple):
    seen = spy_on_the_bend(addon, monkeypatch)
    bend(maple, weight=130.0)
    [(chain, (masses, *_), bent)] = seen
    assert masses.sum() == pytest.approx(130.0)
    assert len(masses) > 300 and bent.error < 1e-3
    for share, frame in ((-1, 9), (4, 5)):
        _turns, heads = chain.pose(bent.vectors[share])
        posed = np.array([head for head, _ in pose_at(maple, frame)])
        assert np.abs(posed - heads).max() < 1e-5
    assert np.abs(heads - chain.heads).max() > 0.01


def test_several_stems_bend_each_by_its_own_load_and_their_root_stays(addon, monkeypatch, tmp_path):
    """The left of three stems leans to the left, the right to the right, and the middle one stands upright."""
    limbs = [((x, 0, 0), (lean, 0, 1), 5.0, 0.08) for x, lean in ((-1, -0.5), (0, 0), (1, 0.5))]
    path = tmp_path / "stems.obj"
    path.write_text(tube_tree.obj_text(limbs, groups=("trunk1", "trunk2", "trunk3")))
    rig, bark = import_tree(path)
    receive(bark)
    settings(tmp_path, frames=(1, 9), repose=math.radians(80.0))
    seen = spy_on_the_bend(addon, monkeypatch)
    bend(rig, weight=120.0)
    [(chain, _arguments, bent)] = seen
    posed = pose_at(rig, 9)
    _turns, heads = chain.pose(bent.vectors[-1])
    assert np.abs(np.array([head for head, _ in posed]) - heads).max() < 1e-5

    bones = rig.evaluated_get(bpy.context.evaluated_depsgraph_get()).pose.bones
    moved = {bone.name: np.array(bone.tail - bone.bone.tail_local) for bone in bones}
    assert np.linalg.norm(moved["root"]) < 1e-3
    left, middle, right = (
        max((name for name in moved if name.startswith(stem)), key=lambda name: bones[name].tail[2])
        for stem in ("trunk1", "trunk2", "trunk3")
    )
    # Each bends outwards and down, the middle one hardly.
    assert moved[left][0] < -0.02 and moved[right][0] > 0.02
    assert moved[left][2] < -0.01 and moved[right][2] < -0.01
    assert moved[left] == pytest.approx(moved[right] * (-1, 1, 1), abs=0.3 * np.linalg.norm(moved[right]))
    assert np.linalg.norm(moved[middle]) < 0.2 * np.linalg.norm(moved[right])


def test_a_turned_small_tree_in_centimetres_bends_towards_the_ground(addon, monkeypatch, tree):
    """The same wood and load in other units and another orientation: the same angles, up to the maps' texels."""
    rig, _bark = tree
    scene = bpy.context.scene
    seen = spy_on_the_bend(addon, monkeypatch)
    bend(rig, weight=40.0)
    scene.unit_settings.scale_length = 0.01
    rig.scale = (100.0, 100.0, 100.0)
    rig.rotation_euler = (0.0, 0.0, 1.0)
    bend(rig)
    rig.scale = (100.0, -100.0, 100.0)
    bend(rig)
    tips = [chain.bent_tails(bent.vectors[-1])[:, 2] - chain.tails[:, 2] for chain, _, bent in seen]
    assert tips[0].min() < -0.02
    for other in tips[1:]:
        assert other.min() == pytest.approx(tips[0].min(), rel=0.05)


def test_it_adds_to_sway_before_and_after_and_sway_goes_on_looping(tree, addon):
    rig, _bark = tree
    activate(rig)
    bpy.ops.snowbough.add_sway(loop_frames=24, keys=8)
    swaying = {frame: pose_at(rig, frame) for frame in (9, 33, 130)}
    bend(rig, weight=40.0)
    rig.animation_data.action_influence = 0.0
    bent = pose_at(rig, 9)
    rig.animation_data.action_influence = 1.0

    def furthest_from_both(frame):
        angles = []
        for (_, got), (_, load), (_, sway) in zip(pose_at(rig, frame), bent, swaying[frame]):
            angles.append(math.acos(min(1.0, (np.trace(got.T @ load @ sway) - 1.0) / 2.0)))
        return math.degrees(max(angles))

    largest = math.degrees(max(math.acos(min(1.0, (np.trace(load) - 1.0) / 2.0)) for _, load in bent))
    assert largest > 1.0
    assert max(map(furthest_from_both, swaying)) < 0.1
    bpy.ops.snowbough.add_sway(loop_frames=24, keys=8)  # again, after the bend
    assert max(map(furthest_from_both, swaying)) < 0.1


def test_keys_of_the_whole_armature_keep_their_effect(tree):
    """Where strips add, a keyed scale of 1 would become 2."""
    rig, _bark = tree
    for path, value in (("location", (1.0, 0.0, 0.0)), ("scale", (2.0, 2.0, 2.0))):
        setattr(rig, path, value)
        rig.keyframe_insert(path, frame=1)
    bpy.context.scene.frame_set(2)
    before = np.array(rig.matrix_world)
    bend(rig, weight=40.0)
    bpy.context.scene.frame_set(3)
    assert np.array(rig.matrix_world) == pytest.approx(before, abs=1e-6)
    assert before[0, 0] == pytest.approx(2.0)


def test_the_bend_grows_with_the_snow(tree):
    rig, _bark = tree
    action = bend(rig, weight=40.0)
    sags = [lowest_tip(rig, frame) for frame in range(0, 12)]
    assert sags[0] == sags[1] > 0.15 * sags[9]  # the first frame's own snow, of nine
    assert sags[1:10] == sorted(sags[1:10], reverse=True)
    assert sags[9] == sags[11] < -0.02
    assert "40 kg" in action["snowbough_bend"]


def test_automatic_weight_of_a_bare_tree_is_the_snow_on_it(addon, monkeypatch, tree, tmp_path):
    rig, bark = tree
    seen = spy_on_the_bend(addon, monkeypatch)
    bend(rig, snow_density=200.0)
    rig.animation_data.nla_tracks["Snow Load"].mute = True
    assert bpy.ops.snowbough.bake() == {"FINISHED"}
    held = manifest_of(tmp_path, bark.name)["frames"][-1]["volume"]
    assert held > 0.0
    assert seen[0][1][0].sum() == pytest.approx(200.0 * held, rel=0.02)


def test_automatic_weight_of_a_tree_with_leaves_follows_from_its_crown(addon, monkeypatch, tree):
    rig, _bark = tree
    leaves = square("Leaves", 1.0, z=3.03)
    leaves.location = (0.5, 0.5, 0.0)
    leaves.data.attributes.new("snowbough_bone", "INT", "POINT")
    group = leaves.vertex_groups.new(name=rig.data.bones[-1].name)
    group.add(range(4), 1.0, "REPLACE")
    addon("tree.objects").bind(leaves, rig)
    seen = spy_on_the_bend(addon, monkeypatch)
    bend(rig, snow_density=100.0)
    # 1 m2 (and the cells that its edges touch), 0.1 m of snow of 100 kg/m3, 60 % of it.
    assert seen[0][1][0].sum() == pytest.approx(6.0, rel=0.02)


def test_a_roof_keeps_the_load_off_the_limbs_below_it(addon, monkeypatch, tree):
    rig, _bark = tree
    seen = spy_on_the_bend(addon, monkeypatch)
    bend(rig)
    square("Roof", 4.0, z=6.0, x=2.5)
    bend(rig)
    (chain, (open_, *_), _), (_, (sheltered, *_), _) = seen
    right = (chain.heads[:, 0] > 0.6) & (chain.tails[:, 0] > 0.6)
    left = (chain.heads[:, 0] < -0.6) & (chain.tails[:, 0] < -0.6)
    assert sheltered[right].sum() < 0.01 * open_[right].sum()
    assert sheltered[left].sum() == pytest.approx(open_[left].sum(), rel=0.05)


def test_subdivided_bark_gives_the_same_bend(addon, monkeypatch, tree):
    rig, bark = tree
    seen = spy_on_the_bend(addon, monkeypatch)
    bend(rig, weight=40.0)
    bark.modifiers.new("finer", "SUBSURF").subdivision_type = "SIMPLE"
    bend(rig)
    (_, (coarse, *_), _), (_, (fine, *_), _) = seen
    assert len(bark.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.vertices) > len(
        bark.data.vertices
    )
    assert fine == pytest.approx(coarse, abs=0.02 * coarse.max())


def test_a_running_preview_goes_on_with_the_bent_tree(addon, tree):
    rig, bark = tree
    bpy.context.scene.frame_set(9)
    live = addon("preview.live")
    live.start(bpy.context.scene, bpy.context.evaluated_depsgraph_get(), draws=False)
    try:
        bend(rig, weight=40.0)
        preview = addon("base.session").preview
        [pose] = [obj for obj in preview.simulated.pose.objects.values() if obj.receives]
        assert np.abs(pose.positions - evaluated_vertices(bark)).max() < 1e-5
    finally:
        live.stop()


def test_limbs_that_would_break_are_reported(tree, addon):
    rig, _bark = tree
    action = bend(rig, weight=40.0, species="CUSTOM", wood_stiffness=4.0, wood_strength=1.0)
    assert "would break" in action["snowbough_bend"]
    action = bend(rig, wood_strength=10000.0)
    assert "would break" not in action["snowbough_bend"]


def test_a_stiffer_wood_bends_less(tree):
    rig, _bark = tree
    sags = []
    for stiffness in (2.0, 8.0):
        bend(rig, weight=20.0, species="CUSTOM", wood_stiffness=stiffness, wood_strength=1000.0)
        sags.append(lowest_tip(rig, 9))
    assert sags[0] / sags[1] == pytest.approx(4.0, rel=0.1)


def test_again_replaces_the_bend_and_starts_from_the_tree_at_rest(tree, addon):
    rig, _bark = tree
    compat = addon("base.compat")

    def keyed(action):
        rig.animation_data.action = action
        found = [tuple(key.co) for curve in compat.curves_of(rig) for key in curve.keyframe_points]
        rig.animation_data.action = None
        return found

    first = keyed(bend(rig, weight=40.0))
    second = keyed(bend(rig))
    assert first == second and len(first) > 100
    assert [track.name for track in rig.animation_data.nla_tracks] == ["Snow Load"]
    assert len(bpy.data.actions) == 1


def test_remove_leaves_all_other_animation(tree):
    rig, bark = tree
    rest = evaluated_vertices(bark)
    hand = bpy.data.actions.new("hand")
    hand.use_fake_user = True
    track = rig.animation_data_create().nla_tracks.new()
    track.name = "Snow Load"  # of the user
    track.strips.new("hand", 1, hand)
    bpy.context.scene.frame_set(5)
    activate(rig)
    assert bpy.ops.snowbough.bend_under_snow() == {"FINISHED"}
    assert len(rig.animation_data.nla_tracks) == 2
    assert bpy.context.scene.frame_current == 5 and rig.data.pose_position == "POSE"
    assert np.abs(evaluated_vertices(bark) - rest).max() > 1e-6
    assert bpy.ops.snowbough.remove_bend() == {"FINISHED"}
    assert [strip.action for track in rig.animation_data.nla_tracks for strip in track.strips] == [hand]
    assert list(bpy.data.actions) == [hand]
    assert rig.animation_data.action_blend_type == "REPLACE"
    assert np.abs(evaluated_vertices(bark) - rest).max() < 1e-6
    assert not bpy.ops.snowbough.remove_bend.poll()


def refusal(rig):
    activate(rig)
    with pytest.raises(RuntimeError) as error:
        bpy.ops.snowbough.bend_under_snow()
    return str(error.value)


def test_refusals_say_what_to_do(tree):
    rig, bark = tree
    own = bpy.context.scene.snowbough
    own.end_depth = 0.0
    assert "raise End Depth" in refusal(rig)
    own.end_depth = 0.1
    rig.scale = (1.0, 1.0, 2.0)
    assert "apply its scale" in refusal(rig)
    rig.scale = (1.0, 1.0, 1.0)
    bone = rig.pose.bones[0]
    bone.keyframe_insert("rotation_quaternion", frame=1)
    assert "Convert Rotation Modes" in refusal(rig)
    rig.animation_data_clear()
    bark.vertex_groups.clear()
    assert "no weights" in refusal(rig)
    own.receivers.clear()
    assert "add snow" in refusal(rig)
    activate(None)
    assert not bpy.ops.snowbough.bend_under_snow.poll()
    assert rig.animation_data is None and rig.data.pose_position == "POSE"


def test_a_bake_without_the_button_knows_nothing_of_it(tree, addon):
    rig, _bark = tree
    request = addon("bake.from_scene").make_request(bpy.context.scene)
    assert "bending" not in str(request.shot()) and rig.animation_data is None
