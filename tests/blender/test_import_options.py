# SPDX-License-Identifier: GPL-3.0-or-later
"""Detail, sizes, several files at once, bones, wind attributes and assets of an import."""

import json
import subprocess

import bpy
import numpy as np
import pytest
from conftest import ROOT
from exported_tree import MAPLE, assert_follows, assert_weighted, import_collection
from synthetic_tree import evaluated_vertices


def _points(obj):
    points = np.empty(len(obj.data.vertices) * 3, np.float32)
    obj.data.vertices.foreach_get("co", points)
    return points.reshape(-1, 3)


def _attribute(mesh, name, width=1):
    values = np.empty(len(mesh.attributes[name].data) * width, np.float32)
    mesh.attributes[name].data.foreach_get("vector" if width == 3 else "value", values)
    return values.reshape(-1, width) if width > 1 else values


# -- detail -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("detail", ["DRAFT", "GAME", "DEFAULT", "FILM"])
def test_a_tree_of_any_detail_is_closed_weighted_unwrapped_and_follows_its_bones(addon, detail):
    collection = import_collection(detail=detail)
    report = json.loads(collection["snowbough_report"])
    assert report["meshes"][0]["detail"] == detail
    bark = collection.objects["small_maple_bark"]
    corners = addon("base.compat").read_corner_vertices(bark.data).reshape(-1, 4)
    check = addon("base.native").load().check_mesh(addon("base.compat").read_positions(bark.data), corners)
    assert check["closed"] and list(check["euler"]) == [2]
    assert len(bark.data.polygons) == report["meshes"][0]["faces"]
    assert len(bark.data.materials) == 1
    assert_weighted(bark)
    for layer in bark.data.uv_layers:
        uv = addon("base.compat").read_uv(layer, corners.size).reshape(-1, 4, 2)
        (a, b), (c, d) = (uv[:, 2] - uv[:, 0]).T, (uv[:, 3] - uv[:, 1]).T
        area = a * d - b * c
        assert (np.abs(area) > 0).all(), layer.name
    assert_follows(bark, collection.objects["small_maple"])


def test_details_get_finer_and_default_is_the_default():
    faces = []
    for detail in ("DRAFT", "GAME", "DEFAULT", "FILM"):
        bpy.ops.wm.read_homefile(use_empty=True)
        faces.append(len(import_collection(detail=detail).objects["small_maple_bark"].data.polygons))
    assert faces == sorted(faces) and len(set(faces)) == 4
    bpy.ops.wm.read_homefile(use_empty=True)
    bark = import_collection().objects["small_maple_bark"]
    assert len(bark.data.polygons) == faces[2]
    assert "snowbough_lod" not in bark


# -- sizes ------------------------------------------------------------------------------------------------


def _height(collection):
    return json.loads(collection["snowbough_report"])["height"]


@pytest.mark.parametrize(
    "settings, scene_scale, factor",
    [
        ({"unit": "CENTIMETRES"}, 1.0, 0.01),
        ({"unit": "FEET"}, 1.0, 0.3048),
        ({"unit": "METRES"}, 0.01, 100.0),
        ({"unit": "FILE"}, 0.01, 1.0),
    ],
    ids=str,
)
def test_a_tree_comes_in_the_files_units(settings, scene_scale, factor):
    plain = import_collection()
    points, height = _points(plain.objects["small_maple_bark"]), _height(plain)
    bpy.ops.wm.read_homefile(use_empty=True)
    bpy.context.scene.unit_settings.scale_length = scene_scale
    scaled = import_collection(**settings)
    assert _height(scaled) == pytest.approx(factor * height, rel=1e-4)
    ours = _points(scaled.objects["small_maple_bark"])
    assert np.ptp(ours, axis=0) == pytest.approx(factor * np.ptp(points, axis=0), rel=0.02)


@pytest.mark.parametrize("scene_scale", [1.0, 0.01])
def test_a_tree_comes_to_a_height_in_metres(scene_scale):
    bpy.context.scene.unit_settings.scale_length = scene_scale
    collection = import_collection(height=9.0, unit="FEET")
    assert _height(collection) * scene_scale == pytest.approx(9.0, rel=1e-4)
    assert np.ptp(_points(collection.objects["small_maple_bark"])[:, 2]) * scene_scale == pytest.approx(
        9.0, rel=0.03
    )


# -- several files ----------------------------------------------------------------------------------------


@pytest.fixture
def forest(tmp_path):
    """A folder with two trees, a file that is not a tree, and another folder with a third tree."""
    for name in ("one.obj", "two.OBJ", "more/three.obj"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_bytes(MAPLE.read_bytes())
    (tmp_path / "letter.obj").write_text("Dear reader,\n")
    (tmp_path / "notes.txt").write_text("not a tree either\n")
    return tmp_path


def _trees():
    return sorted(collection.name for collection in bpy.data.collections)


def test_several_files_and_folders_come_in_at_once(forest):
    files = [{"name": name} for name in ("one.obj", "more")]
    assert bpy.ops.import_scene.xfrog_tree(directory=str(forest), files=files) == {"FINISHED"}
    assert _trees() == ["one", "three"]
    selected = {obj.name for obj in bpy.context.selected_objects}
    assert selected == {"one", "one_bark", "three", "three_bark"}


def test_several_trees_stand_side_by_side(forest):
    files = [{"name": name} for name in ("one.obj", "two.OBJ", "more")]
    bpy.ops.import_scene.xfrog_tree(directory=str(forest), files=files)
    spans = []
    for name in ("one", "two", "three"):
        x = evaluated_vertices(bpy.data.objects[f"{name}_bark"])[:, 0]
        spans.append((x.min(), x.max()))
    assert bpy.data.objects["one"].location.x == 0
    assert all(before[1] < after[0] for before, after in zip(spans, spans[1:]))


def test_a_folder_stands_for_its_trees_and_what_is_none_keeps_no_other_out(forest):
    assert bpy.ops.import_scene.xfrog_tree(filepath=str(forest)) == {"FINISHED"}
    assert _trees() == ["one", "two"]


def test_where_nothing_is_a_tree_all_are_told_and_nothing_is_made(forest):
    (forest / "poem.obj").write_text("v a b c\n")
    files = [{"name": name} for name in ("letter.obj", "poem.obj")]
    with pytest.raises(RuntimeError) as error:
        bpy.ops.import_scene.xfrog_tree(directory=str(forest), files=files)
    assert "letter.obj" in str(error.value) and "poem.obj" in str(error.value)
    assert _trees() == []


def test_the_command_line_takes_several_files_and_folders(forest):
    if getattr(bpy.app, "module", False) or not bpy.app.binary_path:
        pytest.skip("the command line needs the Blender program; this is the bpy module")
    cli, out, report = ROOT / "addon" / "snowbough" / "cli.py", forest / "all.blend", forest / "all.json"
    program = [bpy.app.binary_path, "-b", "--factory-startup", "--python-exit-code", "1", "-P", str(cli)]

    def run(*paths):
        command = [*program, "--", "import", *map(str, paths), "--out", str(out), "--json", str(report)]
        return subprocess.run([*command, "--detail", "DRAFT"], capture_output=True, text=True, timeout=120)

    done = run(forest / "one.obj", forest / "more")
    assert done.returncode == 0, done.stderr
    assert "2 trees" in done.stdout
    said = json.loads(report.read_text())
    assert [tree["file"] for tree in said["trees"]] == ["one.obj", "three.obj"] and said["failures"] == []
    assert out.is_file()
    out.unlink()

    done = run(forest)
    assert done.returncode == 1 and "letter.obj" in done.stderr
    assert len(json.loads(report.read_text())["trees"]) == 2 and out.is_file()


# -- bones, wind, assets ----------------------------------------------------------------------------------


def _shown_bones(rig):
    if hasattr(rig.data, "collections"):
        return [bone for bone in rig.data.bones if any(group.is_visible for group in bone.collections)]
    layers = list(rig.data.layers)
    return [bone for bone in rig.data.bones if any(a and b for a, b in zip(bone.layers, layers))]


@pytest.mark.parametrize("shown", [False, True])
def test_bones_are_shown_on_demand(shown):
    rig = import_collection(show_bones=shown).objects["small_maple"]
    assert not rig.hide_get()
    assert len(_shown_bones(rig)) == (len(rig.data.bones) if shown else 0)


def test_a_tree_whose_bones_are_hidden_sways():
    import_collection(max_bones=20)
    assert bpy.ops.snowbough.add_sway() == {"FINISHED"}
    assert len(bpy.data.actions) == 1


def test_wind_attributes_tell_each_points_branch(addon):
    collection = import_collection(wind_attributes=True, detail="BASE")
    bark = collection.objects["small_maple_bark"]
    options = addon("tree.import_options").ImportOptions(detail="BASE")
    tree = addon("tree.native_tree").read_native(MAPLE, options)
    branches = tree.skeleton.branches
    pivots = np.array([branch.points[0] for branch in branches])
    pivot, axis = _attribute(bark.data, "_PIVOT", 3), _attribute(bark.data, "_AXIS", 3)
    phase, length = _attribute(bark.data, "_PHASE"), _attribute(bark.data, "_LENGTH")
    distance = np.linalg.norm(pivot[:, None] - pivots[None], axis=2)
    of, native = distance.argmin(axis=1), tree.meshes[0].native
    assert distance.min(axis=1).max() < 1e-6
    # Every face belongs to its branch, except for vertices shared with the parent.
    for face, branch in zip(native.quads, native.face_branch):
        assert set(of[face]) <= {branch, branches[branch].parent}
    assert np.allclose(np.linalg.norm(axis, axis=1), 1, atol=1e-5)
    tips = np.array([branch.points[-1] for branch in branches])
    assert np.allclose(pivot + axis * length[:, None], tips[of], atol=1e-4)
    assert 0 <= phase.min() and phase.max() < 1
    assert len(np.unique(phase)) == len(np.unique(of)) == len(branches)


def test_without_the_option_there_are_no_wind_attributes():
    assert "_PIVOT" not in import_collection().objects["small_maple_bark"].data.attributes


def test_an_asset_has_a_picture_of_its_tree_that_is_saved(tmp_path):
    collection = import_collection(mark_asset=True)
    assert collection.asset_data is not None and "small_maple" in collection.asset_data.description
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "asset.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "asset.blend"))
    preview = bpy.data.collections["small_maple"].preview
    width, height = preview.image_size
    pixels = np.array(preview.image_pixels_float).reshape(height, width, 4)
    shown = pixels[..., 3] > 0.5
    assert 0.02 < shown.mean() < 0.8
    # It stands upright: the foot is narrower than the crown, and the whole height is used.
    rows = np.nonzero(shown.any(axis=1))[0]
    assert len(rows) > 0.8 * height
    assert shown[rows[0] : rows[0] + 20].sum() < shown[height // 2 : height // 2 + 20].sum()
    assert np.ptp(pixels[shown][:, :3]) > 0.1


def test_without_the_option_it_is_no_asset():
    assert import_collection().asset_data is None


@pytest.mark.parametrize("height, hints", [(6010.0, ["the tree is 6,010 m high"]), (100.0, [])])
def test_a_tree_of_thousands_of_metres_gets_a_hint_at_its_units(addon, height, hints):
    options = addon("tree.import_options").ImportOptions(height=height)
    warnings = addon("tree.native_tree").read_native(MAPLE, options).report["warnings"]
    assert [text.split(":")[0] for text in warnings if "high" in text] == hints
