# SPDX-License-Identifier: GPL-3.0-or-later
"""The files, scenes and messages of small production shots.

Unless a test says otherwise, 0.1 m of snow falls straight down in frames 1 to 4, a quarter of it in each frame.
"""

import json
import math
import re
import types
from pathlib import Path

import bmesh
import bpy
import child
import pytest
import snow_scene as s
from surface_scene import bake_surfaces, box, level, points_at

# -- files that are lost ----------------------------------------------------------------------------------------


def lose(path):
    path.unlink()


def empty(path):
    path.write_bytes(b"")


def recount(path):
    """One point less in each of two samples."""
    data = bytearray(path.read_bytes())
    points = int.from_bytes(data[16:20], "little") - 1
    data[16:20] = points.to_bytes(4, "little")
    data[28:32] = (2).to_bytes(4, "little")
    path.write_bytes(data[: 32 + 2 * 12 * points])


@pytest.mark.parametrize("harm", [lose, empty, recount])
def test_a_surface_without_its_file_shows_no_snow_and_says_so(tmp_path, addon, harm):
    (surface,) = bake_surfaces(tmp_path / "cache", s.square("Ground"))
    assert level(points_at(surface, 4)) == pytest.approx(0.1, rel=0.02)
    blend = tmp_path / "shot.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(blend))
    harm(s.folder_of(tmp_path / "cache", "Ground") / "surface.pc2")
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    for frame in (1, 4):
        assert points_at(bpy.data.objects["Ground Snow"], frame)[:, 2].max() <= 0.0
    severity, text = addon("base.session").last_outcome
    assert severity == "ERROR" and "'Ground Snow' shows no snow" in text
    assert "'Ground Snow' shows no snow" in s.issues(addon, "WARNING")
    bpy.context.scene.render.engine = "SNOWBOUGH_REALTIME"
    bpy.context.scene.camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    with pytest.raises(RuntimeError, match="'Ground Snow' shows no snow"):
        bpy.ops.render.render()


# -- linked receivers -------------------------------------------------------------------------------------------


def test_a_linked_receiver_keeps_its_bake_when_either_file_is_moved(tmp_path, addon, native):
    (tmp_path / "shots" / "deep").mkdir(parents=True)
    s.write_library(tmp_path / "props.blend", "Rock")
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    rock = s.link(tmp_path / "props.blend", "Rock")
    bake_surfaces(tmp_path / "cache", rock, frames=(1, 4))
    folders = {folder.name for folder in tmp_path.glob("cache/*/v*/Rock-*")}
    moved = tmp_path / "shots" / "deep" / "shot.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(moved))
    (tmp_path / "shot.blend").unlink()
    (tmp_path / "store").mkdir()
    (tmp_path / "props.blend").rename(tmp_path / "store" / "props.blend")
    bpy.data.libraries[0].filepath = "//../../store/props.blend"
    bpy.ops.wm.save_mainfile()
    bpy.ops.wm.open_mainfile(filepath=str(moved))
    rock = bpy.data.objects["Rock"]
    assert rock.library.filepath == "//../../store/props.blend"
    assert level(points_at(bpy.data.objects["Rock Snow"], 4)) == pytest.approx(0.1, rel=0.02)
    resumed = s.bake_part(addon, resume=True)
    assert resumed.error is None and not resumed.job.results  # everything is baked
    s.bake()
    assert {folder.name for folder in tmp_path.glob("cache/*/v*/Rock-*")} == folders and len(folders) == 1


def test_libraries_of_one_name_are_told_apart_by_their_folders(tmp_path, addon):
    for folder in ("chairs", "tables"):
        s.write_library(tmp_path / folder / "props.blend", "Top")
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    first, second = (s.link(tmp_path / folder / "props.blend", "Top") for folder in ("chairs", "tables"))
    name = addon("scene.libraries").library_name
    assert (name(first), name(second)) == ("chairs/props.blend", "tables/props.blend")
    s.receive(first, second)
    s.settings(tmp_path / "cache")
    s.bake()
    assert len(list(tmp_path.glob("cache/*/v001/Top-*"))) == 2
    stored_name = addon("scene.libraries").stored_name
    stored = ("", "//../props.blend", "C:\\lib\\props.blend", "/lib/props.blend", "chairs/props.blend")
    assert [stored_name(path) for path in stored] == ["", *["props.blend"] * 3, "chairs/props.blend"]


# -- several scenes ---------------------------------------------------------------------------------------------


def new_scene(kind):
    """A copy of the current scene by Scene > New, which becomes the current one."""
    bpy.ops.scene.new(type=kind)
    return bpy.context.window.scene


def surfaces_in(scene):
    return {obj for obj in scene.objects if obj.snowbough.is_shell}


def shown_folder(surface):
    return Path(bpy.path.abspath(surface.modifiers[0].filepath)).parent


@pytest.mark.parametrize("in_collection", [False, True])
@pytest.mark.parametrize("kind", ["FULL_COPY", "LINK_COPY"])
def test_a_bake_in_a_copy_of_a_scene_leaves_the_first_one_its_surface(tmp_path, kind, in_collection):
    """The copy has twice as much snow."""
    first, ground = bpy.context.scene, s.square("Ground")
    if in_collection:
        collection = bpy.data.collections.new("Set")
        first.collection.children.link(collection)
        collection.objects.link(ground)
        first.collection.objects.unlink(ground)
    (surface,) = bake_surfaces(tmp_path / "cache", ground)
    folder = shown_folder(surface)
    copy = new_scene(kind)
    assert len(surfaces_in(copy)) == 1  # it shows the same snow until it bakes
    copy.snowbough.end_depth = 0.2
    s.bake()
    assert surfaces_in(first) == {surface} and shown_folder(surface) == folder
    (own,) = surfaces_in(copy)
    assert own != surface and shown_folder(own) != folder
    assert own.active_material != surface.active_material
    assert level(points_at(own, 4)) == pytest.approx(0.2, rel=0.05)
    bpy.context.window.scene = first
    assert level(points_at(surface, 4)) == pytest.approx(0.1, rel=0.02)
    s.bake()
    (again,) = surfaces_in(first)
    assert surfaces_in(copy) == {own} and level(points_at(again, 4)) == pytest.approx(0.1, rel=0.02)


def test_two_scenes_that_share_a_receiver_have_a_surface_each(tmp_path):
    first, ground = bpy.context.scene, s.square("Ground")
    (surface,) = bake_surfaces(tmp_path / "cache", ground)
    other = new_scene("NEW")
    other.collection.objects.link(ground)
    (own,) = bake_surfaces(tmp_path / "cache", ground, end_depth=0.2) and surfaces_in(other)
    assert surfaces_in(first) == {surface}
    assert level(points_at(own, 4)) == pytest.approx(0.2, rel=0.05)
    bpy.context.window.scene = first
    assert level(points_at(surface, 4)) == pytest.approx(0.1, rel=0.02)
    bpy.context.window.scene = other
    bpy.ops.snowbough.remove()
    assert surfaces_in(first) == {surface} and not surfaces_in(other)


def test_a_shared_material_names_the_scene_whose_maps_it_shows(tmp_path, addon):
    foreign = addon("result.snow_material").foreign_scene
    first, ground = bpy.context.scene, s.square("Ground")
    ground.data.materials.append(bpy.data.materials.new("Earth"))
    s.receive(ground)
    s.settings(tmp_path / "cache")
    bpy.ops.snowbough.setup_displacement(mode="NONE")
    s.bake()
    other = new_scene("NEW")
    other.collection.objects.link(ground)
    s.receive(ground)
    s.settings(tmp_path / "cache")
    bpy.ops.snowbough.setup_displacement(mode="NONE")
    s.bake()
    assert foreign(first.snowbough.receivers[0]) == other.name
    assert foreign(other.snowbough.receivers[0]) == ""
    snow = [node for node in ground.active_material.node_tree.nodes if node.type == "GROUP"]
    assert len(snow) == 1  # not snow on the snow of the other scene
    bpy.ops.snowbough.remove()
    assert [slot.material.name for slot in ground.material_slots] == ["Earth"]


# -- the files of a shot ------------------------------------------------------------------------------------------


@pytest.fixture
def packed_shot(tmp_path):
    """A saved shot with a texture, a sequence of textures and UDIM tiles, and a ground whose bake the .blend does not
    know."""
    for name in ("wood.png", "leaf_0001.png", "leaf_0002.png", "wall.1001.png", "wall.1002.png"):
        image = bpy.data.images.new(name, 4, 4)
        image.filepath_raw, image.file_format = str(tmp_path / name), "PNG"
        image.save()
        bpy.data.images.remove(image)
    for name, source in (("wood.png", "FILE"), ("leaf_0001.png", "SEQUENCE"), ("wall.1001.png", "TILED")):
        image = bpy.data.images.load(str(tmp_path / name))
        image.source, image.use_fake_user = source, True
    s.receive(s.square("Ground"))
    s.settings(tmp_path / "unused", frames=(1, 4))
    bpy.ops.snowbough.setup_displacement(mode="SHELL")
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    assert child.bake(tmp_path / "shot.blend", "--cache", str(tmp_path / "cache")).returncode == 0
    return tmp_path


def test_the_command_line_lists_all_files_of_a_shot(packed_shot):
    command = ["files", "--cache", str(packed_shot / "cache"), "--out", str(packed_shot / "files.txt")]
    ran = child.cli(packed_shot / "shot.blend", *command)
    assert ran.returncode == 0, ran.stderr
    listed = (packed_shot / "files.txt").read_text().splitlines()
    assert len(listed) == len(set(listed)) and all(Path(path).is_file() for path in listed)
    folder = s.folder_of(packed_shot / "cache", "Ground")
    assert {Path(path).name for path in listed if Path(path).parent == folder} == {
        *(f"height_{frame:04d}.exr" for frame in range(1, 5)),
        "ever_covered.exr", "frames.tsv", "object.json", "positions.pc2", "receiver.ply",
        "surface.json", "surface.pc2", "surface.ply",
    }  # fmt: skip
    assert {Path(path).name for path in listed if Path(path).parent == packed_shot} == {
        "shot.blend", "wood.png", "leaf_0001.png", "leaf_0002.png", "wall.1001.png", "wall.1002.png",
    }  # fmt: skip
    printed = child.cli(packed_shot / "shot.blend", "files", "--cache", str(packed_shot / "cache"))
    assert set(listed) <= set(printed.stdout.splitlines())


def test_the_list_of_files_names_what_is_missing(packed_shot):
    (s.folder_of(packed_shot / "cache", "Ground") / "height_0003.exr").unlink()
    (packed_shot / "wood.png").unlink()
    ran = child.cli(packed_shot / "shot.blend", "files", "--cache", str(packed_shot / "cache"))
    assert ran.returncode == 1
    assert "height_0003.exr is missing: resume the bake" in ran.stderr and "wood.png is missing" in ran.stderr
    ran = child.cli(packed_shot / "shot.blend", "files", "--cache", str(packed_shot / "nowhere"))
    assert ran.returncode == 1 and "'Ground' has no bake" in ran.stderr


# -- progress and time ------------------------------------------------------------------------------------------


@pytest.fixture
def common_processor(monkeypatch, addon):
    monkeypatch.setattr(addon("base.session"), "surface_pace", 1.0)


def test_one_progress_covers_maps_and_surfaces(addon, common_processor):
    """Four frames of 2 s each: surfaces are expected to take as long, and then took 1 s for a quarter."""
    job = types.SimpleNamespace(results=[], surface_seconds=8.0)
    running = addon("bake.engine").RunningBake(job, (), 1.0)
    assert (running.fraction, running.status()) == (0.0, "preparing the bake")
    seen = []
    for frame in range(1, 5):
        running.last_result = addon("bake.request").FrameResult(frame, 1, 4, 0.1, 0.0, 0.0, {"total": 2.0})
        job.results.append(running.last_result)
        seen.append((running.fraction, running.status()))
    running.shape(0.0)
    seen.append((running.fraction, running.status()))
    running.shape(0.25)
    running._shaping_begun -= 1.0
    seen.append((running.fraction, running.status()))
    running.shape(1.0)
    seen.append((running.fraction, running.status()))
    assert seen == [
        (0.125, "frame 1 of 1-4, 0:14 left"),
        (0.25, "frame 2 of 1-4, 0:12 left"),
        (0.375, "frame 3 of 1-4, 0:10 left"),
        (0.5, "frame 4 of 1-4, 0:08 left"),
        (0.5, "making snow surfaces, 0:08 left"),
        (0.625, "making snow surfaces, 0:04 left"),
        (1.0, "making snow surfaces, 0:01 left"),
    ]


def test_surfaces_that_take_longer_than_expected_are_not_nearly_done(addon, common_processor):
    running = addon("bake.engine").RunningBake(
        types.SimpleNamespace(results=[], surface_seconds=8.0), (), 1.0
    )
    running.shape(0.0)
    running._shaping_begun -= 40.0
    assert running.status() == "making snow surfaces, 0:11 left"
    running.shape(0.05)
    assert running.status() == "making snow surfaces, 0:11 left"
    running.shape(0.9)
    assert running.status() == "making snow surfaces, 0:05 left"


def test_a_bake_tells_the_next_one_how_long_surfaces_take(addon, common_processor):
    """Those of the first took twice as long as expected."""
    engine, session = addon("bake.engine"), addon("base.session")
    first, second = (
        engine.RunningBake(types.SimpleNamespace(results=[], surface_seconds=seconds), (), 1.0)
        for seconds in (10.0, 30.0)
    )
    first.shape(0.0)
    first._shaping_begun -= 20.0
    first.shape(1.0)
    assert session.surface_pace == pytest.approx(2.0, rel=0.01)
    second.shape(0.0)
    assert second.seconds_left() == pytest.approx(60.0, rel=0.01)


def test_a_bake_knows_how_long_its_surfaces_take(tmp_path, addon):
    """In proportion to their points."""
    small, large = box("Small", 0.5), box("Large", 2.0)
    small.location.x = 4.0
    surfaces = bake_surfaces(tmp_path, small, large)
    points = {surface.name: len(surface.data.vertices) for surface in surfaces}
    job = s.bake_part(addon).job
    seconds = {f"{own.label} Snow": own.surface_seconds for own in job.baked}
    assert seconds["Large Snow"] / seconds["Small Snow"] == pytest.approx(
        points["Large Snow"] / points["Small Snow"], rel=0.3
    )
    assert job.surface_seconds == pytest.approx(sum(seconds.values()) / 2.0)


def test_the_time_of_a_bake_is_that_of_the_whole_button(tmp_path, addon):
    """As if the press of the button were 100 s ago."""
    s.receive(s.square("Ground"))
    s.settings(tmp_path / "cache")
    running = s.bake_part(addon)
    running.begun -= 100.0
    text = addon("bake.outcome").conclude(bpy.context.scene, running)[1]
    assert re.fullmatch(r"Baked 4 frames in 1\d\d\.\d s", text)


# -- the balance of all snow ------------------------------------------------------------------------------------


def ledger_of(root, version=1):
    (path,) = Path(root).glob(f"*/v{version:03d}/ledger.json")
    return json.loads(path.read_text())["frames"]


def steep_roof(folder, **values):
    """A roof of 1 m2 that holds no snow, over a terrace that is no receiver."""
    roof, terrace = s.square("Roof", 1.0, z=2.0), s.square("Terrace", 8.0)
    roof.rotation_euler.x = math.radians(70.0)
    s.receive(roof)
    s.settings(
        folder,
        (1, 8),
        repose=math.radians(40.0),
        max_depth=0.02,
        slide_half_life=0.02,
        end_depth=0.2,
        **values,
    )
    return terrace


@pytest.mark.parametrize("landing", [True, False])
def test_a_ledger_accounts_for_all_snow_of_every_frame(tmp_path, addon, landing):
    """cos 70 degrees of 1 m2 gets 0.2 m of snow."""
    steep_roof(tmp_path / "cache", landing=landing)
    s.bake()
    rows = ledger_of(tmp_path / "cache")
    assert [row["frame"] for row in rows] == list(range(1, 9))
    s.assert_balanced(rows)
    assert rows[-1]["fallen"] == pytest.approx(0.2 * math.cos(math.radians(70.0)), rel=0.02)
    gone = rows[-1]["floor"] if landing else rows[-1]["left"]
    assert gone > 0.5 * rows[-1]["fallen"]
    share = (
        f"{gone / rows[-1]['fallen']:.0%} fell {'on objects that are no receivers' if landing else 'out of'}"
    )
    assert share in addon("bake.changes_since_bake").lost_snow(bpy.context.scene)
    assert share in s.issues(addon, "INFO")


def test_the_ledger_of_a_split_bake_is_that_of_a_whole_one(tmp_path, addon):
    steep_roof(tmp_path / "whole")
    s.receive(bpy.data.objects["Terrace"])
    s.bake()
    assert ledger_of(tmp_path / "whole")[-1]["floor"] == 0.0  # the terrace shows its snow now
    roof, terrace = (s.manifest_of(tmp_path / "whole", name)["frames"][-1] for name in ("Roof", "Terrace"))
    assert terrace["landed"] > 0.5 * roof["slid"] > 0.0 == roof["landed"]
    bpy.context.scene.snowbough.cache_directory = str(tmp_path / "parts")
    assert s.bake_part(addon, objects=["Roof"]).error is None
    assert not list(tmp_path.glob("parts/*/v001/ledger.json"))
    assert s.bake_part(addon, objects=["Terrace"]).error is None
    assert s.files_of(tmp_path / "parts") == s.files_of(tmp_path / "whole")
    bpy.ops.snowbough.free_bake()
    assert not list((tmp_path / "parts").glob("*"))


# -- messages ---------------------------------------------------------------------------------------------------


def test_the_cache_folder_may_begin_with_the_folder_of_the_blend():
    """Blender 4.5 and later shows a path with // in red otherwise."""
    if bpy.app.version < (4, 5, 0):
        pytest.skip("before Blender 4.5, all paths may begin with //")
    settings = bpy.types.Scene.bl_rna.properties["snowbough"].fixed_type.properties
    assert settings["cache_directory"].is_path_supports_blend_relative


def test_nodes_with_instances_do_not_hide_why_their_own_faces_get_no_snow(tmp_path, addon):
    """The nodes of a mesh without a UV map output it with instances of a stone on it."""
    field, stone = s.square("Field"), s.square("Stone", 0.1, z=5.0)
    field.data.uv_layers.remove(field.data.uv_layers[0])
    tree, begin, end = s.node_tree()
    join = tree.nodes.new("GeometryNodeJoinGeometry")
    tree.links.new(begin.outputs[0], join.inputs[0])
    tree.links.new(s.instance_geometry(tree, stone), join.inputs[0])
    tree.links.new(join.outputs[0], end.inputs[0])
    field.modifiers.new("Nodes", "NODES").node_group = tree
    s.receive(field, s.square("Ground", z=-1.0))
    s.settings(tmp_path)
    running = s.bake_part(addon)
    assert list(running.job.refused) == ["Field"] and "has no UV map" in running.job.refused["Field"]


@pytest.fixture
def nested(tmp_path):
    """An empty that instances a collection with a roof, a hidden pole, and an empty that instances a stone without a UV
    map."""

    stone, pole, roof = s.square("Stone", 0.2), s.square("Pole", 0.1), s.square("Roof", z=1.0)
    stone.data.uv_layers.remove(stone.data.uv_layers[0])
    pole.hide_render = True
    inner_empty = s.instanced(stone, name="Inner")
    s.settings(tmp_path)
    return s.instanced(roof, pole, inner_empty, name="Set")


def test_members_that_get_no_snow_are_named(nested, addon):
    bpy.ops.object.select_all(action="DESELECT")
    nested.select_set(True)
    bpy.context.view_layer.objects.active = nested
    assert addon("scene.receivers").members_without_map(nested) == ["Stone"]
    bpy.ops.snowbough.add_receivers()
    assert "Members of 'Set' have no UV map and get no snow: unwrap them: 'Stone'" in s.issues(
        addon, "WARNING"
    )
    assert "Members of 'Set' are hidden in renders and get no snow: 'Pole'" in s.issues(addon, "INFO")


def smooth_more(stone):
    """Subdivision makes the box rounder and smaller."""
    modifier = stone.modifiers.new("Round", "SUBSURF")
    modifier.render_levels = 0
    return lambda: setattr(modifier, "render_levels", 2)


def simplify(stone):
    """As smooth_more, the other way round."""
    stone.modifiers.new("Round", "SUBSURF").render_levels = 2

    def switch_on():
        bpy.context.scene.render.use_simplify = True
        bpy.context.scene.render.simplify_subdivision_render = 0

    return switch_on


def weld(stone):
    """Joins two corners of the box."""
    modifier = stone.modifiers.new("Weld", "WELD")
    stone.vertex_groups.new(name="Two").add([4, 5], 1.0, "REPLACE")
    modifier.vertex_group, modifier.merge_threshold = "Two", 0.001
    return lambda: setattr(modifier, "merge_threshold", 2.5)


@pytest.mark.parametrize("modify", [smooth_more, simplify, weld])
def test_a_modifier_that_changes_the_area_is_not_called_a_setting(tmp_path, addon, modify):
    """The area decides on the automatic pixel."""
    stone = box("Stone", 2.0)
    change = modify(stone)
    s.receive(stone, resolution=128)
    s.settings(tmp_path, pixel_size=0.0)
    s.bake()
    change()
    refused = str(s.bake_part(addon, resume=True).error)
    assert "was baked with other automatic sizes (pixel size: " in refused
    assert (
        "because Texel Size or the area of a receiver differs, which Subdivision Surface, Weld, Simplify"
        in refused
    )


def test_a_duplicate_of_a_surface_stays_and_a_renamed_surface_is_replaced(tmp_path):
    ground = s.square("Ground")
    (surface,) = bake_surfaces(tmp_path, ground)
    copy = surface.copy()
    copy.data = surface.data.copy()
    bpy.context.scene.collection.objects.link(copy)
    s.bake()
    assert {obj.name for obj in surfaces_in(bpy.context.scene)} == {"Ground Snow", copy.name}
    bpy.data.objects.remove(copy)
    bpy.data.objects["Ground Snow"].name = "My Snow"
    s.bake()
    assert {obj.name for obj in surfaces_in(bpy.context.scene)} == {"Ground Snow"}


def test_a_surface_with_a_vertex_less_is_named(tmp_path, addon):
    (surface,) = bake_surfaces(tmp_path, s.square("Ground"))
    assert "shows no snow" not in s.issues(addon, "WARNING")
    mesh = bmesh.new()
    mesh.from_mesh(surface.data)
    mesh.verts.ensure_lookup_table()
    bmesh.ops.delete(mesh, geom=[mesh.verts[0]], context="VERTS")
    mesh.to_mesh(surface.data)
    assert "'Ground Snow' shows no snow: " in s.issues(addon, "WARNING")


def test_udim_tiles_are_called_by_their_name(tmp_path, addon):
    """A box of six equal faces: two of them lie in the second tile."""
    stone = box("Stone", 2.0)
    for polygon in stone.data.polygons:
        for corner in polygon.loop_indices:
            uv = stone.data.uv_layers[0].data[corner].uv
            uv.x += polygon.index >= 4
    s.receive(stone, s.square("Ground", 4.0))
    s.settings(tmp_path)
    text = "uses UDIM tiles (1001: 67% of the faces, 1002: 33% of the faces)"
    assert text in s.issues(addon, "ERROR")
    assert text in s.bake_part(addon).job.refused["Stone"]
