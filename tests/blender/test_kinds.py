# SPDX-License-Identifier: GPL-3.0-or-later
"""Kinds of snow set the sliders of all snow there is, and of what is made later."""

import math

import bpy
import numpy as np
import pytest
import shell_scene
import snow_scene as s


@pytest.fixture
def receivers(addon, tmp_path):
    """A ground with a shell and one whose own material is snowy."""
    native = addon("native").load()
    for name, mode in (("Shell", "SHELL"), ("Plain", "NONE")):
        obj = s.square(name)
        entry = bpy.context.scene.snowbough.receivers.add()
        entry.object = obj
        entry.folder = str(shell_scene.write_maps(native, tmp_path / name, [np.full((64, 64), 0.1)]))
        addon("result.displacement").apply(bpy.context.scene, entry, mode)
    return bpy.data.objects["Shell snow"], bpy.data.objects["Plain"]


def slider(obj, name):
    nodes = obj.material_slots[0].material.node_tree.nodes
    return next(node for node in nodes if node.type == "GROUP").inputs[name].default_value


def relief(addon, shell):
    return addon("compat_nodes").modifier_input(shell.modifiers[0], "Relief")


@pytest.mark.parametrize("kind", ["POWDER", "FRESH", "WET", "OLD"])
def test_a_kind_sets_all_sliders(addon, receivers, kind):
    shell, plain = receivers
    bpy.ops.snowbough.set_kind(kind=kind)
    look = addon("result.look").LOOKS[kind]
    for obj in receivers:
        for name, value in look.inputs().items():
            assert np.allclose(slider(obj, name), value), name
    assert relief(addon, shell) == pytest.approx(look.relief)


def test_snow_that_is_made_later_is_of_the_scenes_kind(addon, receivers, tmp_path):
    bpy.ops.snowbough.set_kind(kind="WET")
    bpy.ops.snowbough.setup_displacement(mode="SHELL")
    assert slider(bpy.data.objects["Plain snow"], "Grain") == pytest.approx(0.5)
    assert relief(addon, bpy.data.objects["Plain snow"]) == pytest.approx(0.4)


def test_what_an_artist_sets_stays_until_another_kind_is_chosen(receivers):
    shell, _ = receivers
    node = next(node for node in shell.material_slots[0].material.node_tree.nodes if node.type == "GROUP")
    node.inputs["Sparkle"].default_value = 0.9
    bpy.context.scene.frame_set(5)
    assert slider(shell, "Sparkle") == pytest.approx(0.9)
    bpy.ops.snowbough.set_kind(kind="OLD")
    assert slider(shell, "Sparkle") == pytest.approx(0.15)


def test_a_group_of_an_earlier_version_keeps_its_materials(addon):
    old = bpy.data.node_groups.new("Snowbough Snow", "ShaderNodeTree")
    made = addon("result.snow_nodes").ensure_group()
    assert (
        made is not old
        and made.name == "Snowbough Snow"
        and "Position" in addon("compat_nodes").group_sockets(made, "INPUT")
    )
    assert old.name != "Snowbough Snow"


@pytest.mark.parametrize(
    "kind, degrees, millimetres", [("POWDER", 40, 2), ("FRESH", 65, 5), ("WET", 80, 12), ("OLD", 60, 4)]
)
def test_a_kind_says_how_steep_snow_lies(kind, degrees, millimetres):
    bpy.context.scene.snowbough.repose = 0.5
    bpy.ops.snowbough.set_kind(kind=kind)
    assert math.degrees(bpy.context.scene.snowbough.repose) == pytest.approx(degrees)
    assert bpy.context.scene.snowbough.cohesion == pytest.approx(millimetres / 1000.0)
