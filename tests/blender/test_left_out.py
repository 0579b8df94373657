# SPDX-License-Identifier: GPL-3.0-or-later
"""Receivers that cannot carry snow are listed, and the others receive snow."""

import argparse
import json

import bpy
import pytest
import snow_scene as s


def scatter(obj, instance, with_mesh=False):
    """A nodes modifier that gives an object instances of another one on its points, and nothing else."""
    tree, given, made = s.node_tree()
    points, join = tree.nodes.new("GeometryNodeInstanceOnPoints"), tree.nodes.new("GeometryNodeJoinGeometry")
    tree.links.new(given.outputs[0], points.inputs["Points"])
    tree.links.new(s.instance_geometry(tree, instance), points.inputs["Instance"])
    tree.links.new(points.outputs["Instances"], join.inputs[0])
    if with_mesh:
        tree.links.new(given.outputs[0], join.inputs[0])
    tree.links.new(join.outputs[0], made.inputs[0])
    obj.modifiers.new("Scatter", "NODES").node_group = tree


def run_cli(addon, tmp_path, **options):
    """(exit code, report) of a bake from the command line."""
    cli = addon("bake.cli")
    parser = argparse.ArgumentParser()
    cli.add_arguments(parser)
    args = parser.parse_args(["--json", str(tmp_path / "report.json"), *(f"--{name}" for name in options)])
    return cli.run(args), json.loads((tmp_path / "report.json").read_text())


def test_a_hidden_receiver_does_not_stop_the_others(addon, native, tmp_path):
    ground, hidden = s.square("Ground"), s.square("Hidden", z=1.0)
    hidden.hide_render = True
    s.receive(ground, hidden)
    s.settings(tmp_path / "cache")
    code, report = run_cli(addon, tmp_path)
    assert code == 0 and list(report["refused"]) == ["Hidden"]
    assert "make it renderable" in report["refused"]["Hidden"]
    assert s.open_ground(s.height(native, tmp_path / "cache", "Ground", 4)) == pytest.approx(0.1, rel=0.02)


def test_one_without_a_map_does_not_stop_the_others_and_still_gives_shelter(addon, native, tmp_path):
    bare = s.mesh_object("Bare", [(-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)], [(0, 1, 2, 3)])
    s.receive(s.square("Ground", 6.0), bare)
    s.settings(tmp_path / "cache")
    code, report = run_cli(addon, tmp_path)
    assert code == 0 and "'Bare' has no UV map" in report["refused"]["Bare"]
    height = s.height(native, tmp_path / "cache", "Ground", 4)
    assert s.texel(height, 0.5, 0.5) == 0.0 and s.texel(height, 0.1, 0.1) > 0.09


def test_the_command_line_has_what_the_check_finds(addon, tmp_path, capfd):
    uv = [(0, 0), (1, 0), (1, 1), (0, 1)]
    points = [(x, y, z) for z in (0, 1) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    s.receive(s.mesh_object("Stack", points, [(0, 1, 2, 3), (4, 5, 6, 7)], uv * 2))
    s.settings(tmp_path / "cache")
    code, report = run_cli(addon, tmp_path)
    assert code == 0 and report["warnings"][0].startswith("100% of 'Stack's UV map 'snow' overlaps")
    assert "SNOWBOUGH warning=\"100% of 'Stack's UV map 'snow' overlaps" in capfd.readouterr().err
    assert report["notes"][0].startswith("1 map, up to 64 texels a side: at most about 32 KiB on disk")


def test_a_strict_bake_stops_before_it_begins(addon, tmp_path):
    hidden = s.square("Hidden")
    hidden.hide_render = True
    s.receive(s.square("Ground"), hidden)
    s.settings(tmp_path / "cache")
    code, report = run_cli(addon, tmp_path, strict=True)
    assert code == 1 and "make it renderable" in report["error"]
    assert not (tmp_path / "cache").exists()


def test_what_was_asked_for_by_name_is_not_left_out_in_silence(addon, tmp_path):
    hidden = s.square("Hidden")
    hidden.hide_render = True
    s.receive(s.square("Ground"), hidden)
    s.settings(tmp_path / "cache")
    assert "make it renderable" in str(s.bake_part(addon, objects=["Hidden"]).error)


@pytest.mark.parametrize("receiver", ["Scatterer", "Stone"])
def test_scattered_objects_are_refused_with_the_way_out(addon, tmp_path, receiver):
    ground, scatterer, stone = s.square("Ground", 6.0), s.square("Scatterer", z=1.0), s.square("Stone", 0.2)
    scatter(scatterer, stone)
    bpy.context.scene.collection.objects.unlink(stone)
    s.receive(ground, bpy.data.objects[receiver])
    s.settings(tmp_path / "cache")
    code, report = run_cli(addon, tmp_path)
    assert code == 0 and "exists only as 4 instances" in report["refused"][receiver]
    assert "Realize Instances" in report["refused"][receiver]


def test_ground_that_scatters_and_is_there_itself_carries_snow(addon, native, tmp_path):
    ground, stone = s.square("Ground", 4.0), s.square("Stone", 0.2, z=0.5)
    scatter(ground, stone, with_mesh=True)
    bpy.context.scene.collection.objects.unlink(stone)
    s.receive(ground)
    s.settings(tmp_path / "cache")
    code, report = run_cli(addon, tmp_path)
    assert code == 0 and report["refused"] == {}
    assert s.texel(s.height(native, tmp_path / "cache", "Ground", 4), 0.5, 0.5) == pytest.approx(
        0.1, rel=0.02
    )
