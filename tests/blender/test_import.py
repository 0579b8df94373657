# SPDX-License-Identifier: GPL-3.0-or-later
"""The import operator and the command line: results, reports, and bad input."""

import json
import os
import signal
import subprocess
import time
from pathlib import Path
from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from conftest import ROOT, SHARED_DATA
from exported_tree import MAPLE, assert_follows, assert_weighted, import_collection
from forest import write_forest

PRESETS = {"Broad-leaf", "Evergreen", "Game_engine", "Film_close-up"}
CLI = ROOT / "addon" / "snowbough" / "cli.py"


def _report(collection):
    return json.loads(collection["snowbough_report"])


def _data_names():
    kinds = ("objects", "meshes", "armatures", "collections", "materials", "images", "actions", "node_groups")
    return {kind: sorted(block.name for block in getattr(bpy.data, kind)) for kind in kinds}


def _refused(path, **settings):
    """The operator's error message; checks that Blender's data is unchanged."""
    before = _data_names()
    with pytest.raises(RuntimeError) as error:
        bpy.ops.import_scene.xfrog_tree(filepath=str(path), **settings)
    assert _data_names() == before
    return str(error.value)


class _PresetMenu:
    """Blender's menu of operator presets, which notes the files of its entries instead of drawing them."""

    bl_idname = "WM_MT_operator_presets"
    preset_operator, preset_subdir = "script.execute_preset", "operator/import_scene.xfrog_tree"
    path_menu = bpy.types.Menu.path_menu

    def __init__(self):
        self.entries = []
        self.layout = self
        self.operator_context = "INVOKE_DEFAULT"

    def operator(self, _name, **_shown):
        self.entries.append(SimpleNamespace())
        return self.entries[-1]

    def column(self, **_shown):
        return self

    def row(self, **_shown):
        return self

    def separator(self):
        pass


def shown_presets():
    """The files of the operator's presets by name, in the order of the menu."""
    menu = _PresetMenu()
    drawn = getattr(bpy.types.WM_MT_operator_presets.draw, "_draw_funcs", [])
    for draw in [bpy.types.Menu.draw_preset, *drawn[1:]]:  # the first one is Blender's own
        draw(menu, bpy.context)
    paths = [Path(entry.filepath) for entry in menu.entries]
    assert len({path.stem for path in paths}) == len(paths)
    return {path.stem: path for path in paths}


def test_collection_armature_and_bark_have_the_files_name():
    collection = import_collection()
    assert sorted(obj.name for obj in collection.objects) == ["small_maple", "small_maple_bark"]
    rig, bark = bpy.data.objects["small_maple"], bpy.data.objects["small_maple_bark"]
    assert rig.type == "ARMATURE" and bark.parent == rig
    assert [(m.type, m.object) for m in bark.modifiers] == [("ARMATURE", rig)]
    assert bpy.context.view_layer.objects.active == bark
    # The selection includes the armature, so moving it moves the meshes.
    assert set(bpy.context.selected_objects) == {rig, bark}


def test_bark_has_its_uv_maps_in_order_and_the_branch_levels():
    mesh = import_collection().objects["small_maple_bark"].data
    assert [layer.name for layer in mesh.uv_layers] == ["bark", "snow"]
    faces = mesh.attributes["branch_level"]
    assert (faces.domain, faces.data_type, len(faces.data)) == ("FACE", "INT", len(mesh.polygons))
    points = mesh.attributes["_BRANCH_LEVEL"]
    assert (points.domain, len(points.data)) == ("POINT", len(mesh.vertices))
    assert {item.value for item in faces.data} == {0, 1}
    assert {item.value for item in points.data} == {0.0, 1.0}


def test_bark_is_what_the_native_module_built(addon):
    options = addon("tree.import_options").ImportOptions()
    tree = addon("tree.import_tree").read_native(MAPLE, options).meshes[0][1]
    mesh = import_collection().objects["small_maple_bark"].data
    assert not mesh.validate()
    points = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.vertices.foreach_get("co", points)
    assert np.array_equal(points.reshape(-1, 3), tree.vertices)
    corners = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    assert np.array_equal(corners.reshape(-1, 4), tree.quads)
    # Two faces share an edge, and each corner's edge runs to the next.
    assert len(mesh.edges) == 2 * len(mesh.polygons) and not any(edge.is_loose for edge in mesh.edges)
    assert all(
        set(mesh.edges[mesh.loops[a].edge_index].vertices) == {corners[a], corners[b]}
        for face in mesh.polygons
        for a, b in zip(face.loop_indices, [*face.loop_indices[1:], face.loop_indices[0]])
    )
    for name in ("bark", "snow"):
        uv = addon("base.compat").read_uv(mesh.uv_layers[name], len(corners)).reshape(-1, 4, 2)
        assert np.array_equal(uv, getattr(tree, f"uv_{name}"))


def test_weights_sum_to_one_with_at_most_four_bones():
    bark = import_collection(max_bones=50).objects["small_maple_bark"]
    names = {bone.name for bone in bpy.data.objects["small_maple"].data.bones}
    assert {group.name for group in bark.vertex_groups} == names
    assert_weighted(bark)


@pytest.mark.parametrize("budget", [1, 20, 100])
def test_max_bones_keeps_that_many_and_the_whole_tree_still_follows(budget):
    collection = import_collection(max_bones=budget)
    rig, bark = collection.objects["small_maple"], collection.objects["small_maple_bark"]
    assert len(rig.data.bones) == budget
    assert_follows(bark, rig)


def test_weights_are_those_of_the_native_module(addon):
    options = addon("tree.import_options").ImportOptions(detail="GAME")
    tree = addon("tree.import_tree").read_native(MAPLE, options).meshes[0][1]
    bark = import_collection(detail="GAME").objects["small_maple_bark"]
    names = addon("tree.bone_names").fitting_names(tree.bone_names)
    assert [group.name for group in bark.vertex_groups] == names
    for vertex, bones, weights in zip(
        bark.data.vertices, tree.bone_indices.tolist(), tree.bone_weights.tolist()
    ):
        expected = {bone: weight for bone, weight in zip(bones, weights) if weight > 0}
        assert {entry.group: entry.weight for entry in vertex.groups} == expected


def test_max_bone_level_keeps_the_trunk_only():
    rig = import_collection(max_bone_level=0).objects["small_maple"]
    assert {bone.name.rpartition(".")[0] for bone in rig.data.bones} == {"trunk1"}


def test_the_levels_of_a_chain_share_one_armature():
    collection = import_collection(lod_chain=True)
    rig = collection.objects["small_maple"]
    barks = [collection.objects[f"small_maple_bark_LOD{k}"] for k in range(4)]
    faces = [len(bark.data.polygons) for bark in barks]
    assert faces == sorted(faces, reverse=True) and len(set(faces)) == 4
    assert {bark.modifiers[0].object for bark in barks} == {rig}
    assert [bark.hide_render for bark in barks] == [False, True, True, True]
    bpy.ops.wm.read_homefile(use_empty=True)
    single = import_collection(detail="BASE").objects["small_maple_bark"]
    assert len(single.data.polygons) == faces[3]


def test_importing_twice_makes_two_trees():
    import_collection()
    import_collection()
    assert len(bpy.data.collections) == 2 and len(bpy.data.armatures) == 2


def test_importing_from_another_objects_edit_mode_works():
    bpy.ops.mesh.primitive_cube_add()
    bpy.ops.object.mode_set(mode="EDIT")
    assert "small_maple" in import_collection().objects


def test_the_report_is_on_the_collection():
    report = _report(import_collection(max_bones=100))
    assert report["form"] == "SQUARES_PER_GROUP"
    assert sum(report["branches_per_level"]) == report["branches"] == 18
    assert report["bones"] == 100
    assert report["surface"]["closed"] and report["surface"]["components"] == 1
    for key in ("skipped_parts", "extra_roots", "foliage_parts", "warnings", "up_axis", "seconds"):
        assert key in report


LEAF = """
mtllib leaves.mtl
g trunk1
v 0.1 0 0.1
v -0.1 0 0.1
v -0.1 0 -0.1
v 0.1 0 -0.1
v 0.08 1 0.08
v -0.08 1 0.08
v -0.08 1 -0.08
v 0.08 1 -0.08
v 0.05 2 0.05
v -0.05 2 0.05
v -0.05 2 -0.05
v 0.05 2 -0.05
v 0.05 2 0
v 0.35 2.1 0
v 0.35 2.3 0.05
v 0.05 2.2 0.05
vt 0 0
vt 1 0
vt 1 1
vt 0 1
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f 4 1 5 8
f 5 6 10 9
f 6 7 11 10
f 7 8 12 11
f 8 5 9 12
g leaves
usemtl leaf
f 13/1 14/2 15/3 16/4
"""


def _leafy(folder, texture):
    path = folder / "leafy.obj"
    path.write_text(LEAF)
    (folder / "leaves.mtl").write_text(f"newmtl leaf\nKd 0.1 0.5 0.2\nmap_Kd {texture}\nmap_d {texture}\n")
    return path


def test_leaves_are_a_second_object_on_the_armature(tmp_path):
    image = bpy.data.images.new("leaf", 4, 4, alpha=True)
    image.filepath_raw, image.file_format = str(tmp_path / "leaf.png"), "PNG"
    image.save()
    bpy.data.images.remove(image)
    collection = import_collection(_leafy(tmp_path, "leaf.png"))
    leaves, rig = collection.objects["leafy_leaves"], collection.objects["leafy"]
    assert [layer.name for layer in leaves.data.uv_layers] == ["leaf", "snow"]
    assert leaves.parent == rig and leaves.modifiers[0].object == rig
    for vertex in leaves.data.vertices:
        assert [entry.weight for entry in vertex.groups] == [1.0]
    material = leaves.data.materials[leaves.data.polygons[0].material_index]
    assert material.name == "leaf"
    surface = next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
    assert surface.inputs["Alpha"].is_linked and surface.inputs["Base Color"].is_linked


def test_a_missing_texture_is_a_warning_with_its_name(tmp_path):
    report = _report(import_collection(_leafy(tmp_path, "not_there.png")))
    assert any("not_there.png" in text for text in report["warnings"])


def test_foliage_can_be_left_out(tmp_path):
    assert "leafy_leaves" not in import_collection(_leafy(tmp_path, "x.png"), foliage=False).objects


def test_foliage_is_what_is_named(tmp_path):
    path = _leafy(tmp_path, "x.png")
    assert "leafy_leaves" in import_collection(path, foliage_names="leaves").objects
    assert "starts with 'petals'" in _refused(path, foliage_names="petals")


def test_snow_maps_remember_the_resolution_they_are_for(addon, tmp_path):
    objects = import_collection(_leafy(tmp_path, "x.png"), snow_resolution=512).objects
    assert [objects[f"leafy_{part}"]["snowbough_snow_resolution"] for part in ("bark", "leaves")] == [
        512,
        512,
    ]
    receiver = bpy.context.scene.snowbough.receivers.add()
    receiver.object, receiver.uv_map = objects["leafy_bark"], "snow"
    resolution = addon("scene.receivers").receiver_resolution
    assert resolution(receiver) == 512
    receiver.resolution = 256
    assert resolution(receiver) == 256
    receiver.resolution, receiver.uv_map = 0, "bark"
    assert resolution(receiver) == 0


def test_wood_that_is_left_out_is_reported_with_its_share(addon, tmp_path):
    path = tmp_path / "sheet.obj"
    path.write_text(MAPLE.read_text() + "\ng bark_sheet\nv 9 9 9\nv 9 8 9\nv 8 8 9\nv 8 9 9\nf -4 -3 -2 -1\n")
    report = _report(import_collection(path, foliage=False))
    (line,) = addon("tree.import_tree").warning_lines({**report, "warnings": []})
    assert line.startswith("bark_sheet was left out: a single plane, not a limb: ")
    assert line.endswith(" % of the wood's area")


def test_a_lone_pole_comes_in_with_a_warning_and_a_tree_without(tmp_path):
    corners = [
        (0.1 * x, 3 * ring, 0.1 * z) for ring in range(2) for x, z in ((1, 1), (1, -1), (-1, -1), (-1, 1))
    ]
    lines = ["v {} {} {}".format(*corner) for corner in corners]
    lines += [f"f {k + 1} {(k + 1) % 4 + 1} {(k + 1) % 4 + 5} {k + 5}" for k in range(4)]
    pole = tmp_path / "pole.obj"
    pole.write_text("g post\n" + "\n".join(lines) + "\n")
    expected = "nothing in the file has branches or leaves"
    assert [text for text in _report(import_collection(pole))["warnings"] if text.startswith(expected)]
    assert not [text for text in _report(import_collection())["warnings"] if text.startswith(expected)]


def test_too_little_memory_is_reported(stand_in):
    def fail(*_arguments, **_options):
        raise MemoryError

    stand_in(read_tree=fail)
    assert "memory" in _refused(MAPLE)


def test_bad_input_gets_one_message_and_leaves_nothing(tmp_path):
    (tmp_path / "empty.obj").write_text("")
    (tmp_path / "text.obj").write_text("Dear reader,\nthis is a letter.\n")
    (tmp_path / "broken.obj").write_text("v 0 0 zero\n")
    leaves_only = (
        LEAF.replace("g trunk1", "").split("f 1 2")[0] + "g leaves\nusemtl leaf\nf 13/1 14/2 15/3 16/4\n"
    )
    (tmp_path / "leaves.obj").write_text(leaves_only)
    assert "not found" in _refused(tmp_path / "missing.obj")
    (tmp_path / "empty").mkdir()
    assert "folder without OBJ files" in _refused(tmp_path / "empty")
    assert "empty.obj" in _refused(tmp_path / "empty.obj")
    assert "text.obj" in _refused(tmp_path / "text.obj")
    assert "broken.obj:1" in _refused(tmp_path / "broken.obj")
    assert "leaves.obj" in _refused(tmp_path / "leaves.obj")


@pytest.mark.parametrize("before", [0, 1])
def test_an_error_while_objects_are_made_leaves_nothing(addon, before):
    """In the first tree of two, or in the second."""
    import_tree, materials = addon("tree.import_tree"), addon("tree.materials")
    left = iter(range(before))

    class Failing(materials.OwnMaterials):
        def copy(self, source, uv_map):
            if next(left, None) is None:
                raise RuntimeError("no room")

    options = addon("tree.import_options").ImportOptions(detail="DRAFT")
    trees, failures = import_tree.read_files([MAPLE, MAPLE], options)
    assert len(trees) == 2 and failures == []
    names = _data_names()
    with pytest.raises(RuntimeError, match="no room"):
        import_tree.create_trees(bpy.context, trees, options, Failing())
    assert _data_names() == names


@pytest.mark.parametrize("detail, chain", [("BASE", False), ("FILM", False), ("DEFAULT", True)])
@pytest.mark.parametrize(
    "until", [0.3, 0.5, 0.6, 0.8]
)  # while it reads, builds the surface, packs the charts; Film mostly while it refines
def test_stopping_the_native_part_makes_nothing(addon, until, detail, chain):
    import_tree = addon("tree.import_tree")
    before = _data_names()
    options = addon("tree.import_options").ImportOptions(detail=detail, lod_chain=chain)
    shares = []

    def go_on(share):
        shares.append(share)
        return share < until

    with pytest.raises(KeyboardInterrupt):
        import_tree.import_files(bpy.context, [MAPLE], options, go_on)
    assert _data_names() == before
    assert shares[-1] <= 0.95  # from where on Blender's objects are made


def test_long_and_foreign_file_names(tmp_path):
    path = tmp_path / f"{'Ahorn ä ' * 12}.obj"
    path.write_bytes(MAPLE.read_bytes())
    bpy.ops.import_scene.xfrog_tree(filepath=str(path))
    assert len(bpy.data.collections) == 1
    names = [obj.name for obj in bpy.data.objects]
    assert any(name.endswith("_bark") for name in names)


def test_presets_set_only_what_the_operator_has():
    presets = shown_presets()
    assert PRESETS <= set(presets)
    for path in presets.values():
        lines = [line for line in path.read_text().splitlines() if line.startswith("op.")]
        values = {key[3:]: eval(value) for key, value in (line.split(" = ") for line in lines)}
        assert len(values) >= 5
        if path.stem == "Film_close-up":
            values["detail"] = "GAME"  # keeps this test quick
        bpy.ops.wm.read_homefile(use_empty=True)
        import_collection(**values)


def test_presets_stay_when_another_blender_of_the_user_ends():
    if not bpy.app.binary_path:
        pytest.skip("this Blender is a Python module, which starts with the factory's preferences")
    folders = (Path(bpy.utils.user_resource("SCRIPTS")) / "presets" / "operator", bpy.app.tempdir)
    before = {path for folder in folders for path in Path(folder).rglob("*")}
    program = "import bpy; bpy.ops.import_scene.xfrog_tree.get_rna_type(); print('has it')"
    command = [
        bpy.app.binary_path,
        "-b",
        "--addons",
        os.environ["SNOWBOUGH_TEST_ADDON"],
        "--python-expr",
        program,
    ]
    other = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert other.returncode == 0 and "has it" in other.stdout, other.stdout + other.stderr
    assert PRESETS <= {name for name, path in shown_presets().items() if path.is_file()}
    assert {path for folder in folders for path in Path(folder).rglob("*")} == before


@pytest.mark.parametrize("name", sorted(PRESETS))
def test_blender_applies_a_preset_to_the_operator(name):
    path = shown_presets()[name]
    lines = [line for line in path.read_text().splitlines() if line.startswith("op.")]
    expected = {key[3:]: eval(value) for key, value in (line.split(" = ") for line in lines)}
    # What the file browser shows beside its list: the properties of the operator that will run.
    operator = bpy.context.window_manager.operator_properties_last("import_scene.xfrog_tree")
    for key in expected:
        operator.property_unset(key)
    with bpy.context.temp_override(active_operator=operator):
        bpy.ops.script.execute_preset(filepath=str(path), menu_idname="WM_MT_operator_presets")
    assert {key: getattr(operator, key) for key in expected} == expected
    for key in expected:
        operator.property_unset(key)


def test_the_import_menu_has_the_entry_once(addon):
    drawn = bpy.types.TOPBAR_MT_file_import._dyn_ui_initialize()
    assert drawn.count(addon("ui.import_operators")._draw_menu) == 1
    entries = []
    layout = SimpleNamespace(operator=lambda name, text: entries.append((name, text)))
    addon("ui.import_operators")._draw_menu(SimpleNamespace(layout=layout), None)
    assert entries == [("import_scene.xfrog_tree", "Xfrog Tree (.obj)")]


def test_obj_files_can_be_dropped_where_trees_are_shown():
    if not hasattr(bpy.types, "FileHandler"):
        pytest.skip("this Blender has no file handlers (they came with 4.1)")
    handler = bpy.types.SNOWBOUGH_FH_xfrog_tree
    assert (handler.bl_import_operator, handler.bl_file_extensions) == ("import_scene.xfrog_tree", ".obj")
    areas = {
        kind: SimpleNamespace(area=SimpleNamespace(type=kind))
        for kind in ("VIEW_3D", "OUTLINER", "TEXT_EDITOR")
    }
    assert [handler.poll_drop(context) for context in areas.values()] == [True, True, False]
    assert not handler.poll_drop(SimpleNamespace(area=None))


def _program():
    if getattr(bpy.app, "module", False) or not bpy.app.binary_path:
        pytest.skip("the command line needs the Blender program; this is the bpy module")
    return [bpy.app.binary_path, "-b", "--factory-startup", "--python-exit-code", "1"]


def _blender(*arguments):
    command = [*_program(), "-P", str(CLI), "--", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=120)


def test_the_command_line_imports_saves_and_reports(tmp_path):
    done = _blender("import", MAPLE, "--out", tmp_path / "t.blend", "--json", tmp_path / "r.json")
    assert done.returncode == 0, done.stderr
    assert json.loads((tmp_path / "r.json").read_text())["branches"] == 18
    assert sorted(path.name for path in tmp_path.iterdir()) == ["r.json", "t.blend"]
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "t.blend"))
    assert sorted(obj.name for obj in bpy.data.objects) == ["small_maple", "small_maple_bark"]


def test_the_command_line_refuses_bad_input_with_a_message(tmp_path):
    (tmp_path / "empty.obj").write_text("")
    for arguments, code, word in (
        (("import", tmp_path / "no.obj", "--out", tmp_path / "t.blend"), 1, "not found"),
        (("import", tmp_path / "empty.obj", "--out", tmp_path / "t.blend"), 1, "empty.obj"),
        (("import", MAPLE, "--out", tmp_path / "none" / "t.blend"), 1, "no folder"),
        (("import",), 2, "usage"),
    ):
        done = _blender(*arguments)
        assert done.returncode == code and word in done.stderr, done.stderr
        assert "Traceback" not in done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["empty.obj"]


def test_ctrl_c_stops_the_command_line_and_leaves_nothing(tmp_path):
    if not Path("/proc/self/fd").is_dir():
        pytest.skip("needs /proc to see when the file is being read")
    forest, results = tmp_path / "forest.obj", tmp_path / "results"
    results.mkdir()
    write_forest(forest, limbs=4000, rings=30)  # about 22 MB, seconds of work
    arguments = ["import", forest, "--out", results / "t.blend", "--json", results / "r.json"]
    running = subprocess.Popen(
        [*_program(), "-P", str(CLI), "--", *map(str, arguments)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )

    def reads_it():
        try:
            return any(
                os.readlink(entry.path) == str(forest) for entry in os.scandir(f"/proc/{running.pid}/fd")
            )
        except FileNotFoundError:  # a file that was closed meanwhile
            return False

    try:
        for _ in range(30000):
            if reads_it():
                break
            assert running.poll() is None, running.communicate()
            time.sleep(0.002)
        running.send_signal(signal.SIGINT)
        _output, errors = running.communicate(timeout=60)
    finally:
        if running.poll() is None:
            running.kill()
    assert running.returncode == 130, errors
    assert "stopped" in errors and "Traceback" not in errors
    assert list(results.iterdir()) == []


def test_the_command_of_the_installed_add_on(tmp_path):
    if not hasattr(bpy.utils, "register_cli_command"):
        pytest.skip("this Blender has no -c (it came with 4.2)")
    command = [*_program()[:3], "--addons", os.environ["SNOWBOUGH_TEST_ADDON"], "-c", "snowbough"]
    done = subprocess.run(
        [*command, "import", str(MAPLE), "--out", str(tmp_path / "t.blend")],
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert (tmp_path / "t.blend").is_file()
    done = subprocess.run(
        [*command, "import", str(tmp_path / "no.obj")], capture_output=True, text=True, timeout=120
    )
    assert done.returncode == 1 and "not found" in done.stderr


def _shared_trees():
    return sorted(
        str(path.relative_to(SHARED_DATA / "trees")) for path in (SHARED_DATA / "trees").rglob("*.obj")
    )


@pytest.mark.parametrize("name", _shared_trees() or ["tubes/AL06a.obj"])
def test_every_shared_tree_comes_in_closed_without_options(addon, shared_tree, name):
    path = shared_tree(name)
    collection = import_collection(path)
    mesh = collection.objects[f"{path.stem}_bark"].data
    corners = addon("base.compat").read_corner_vertices(mesh).reshape(-1, 4)
    check = addon("base.native").load().check_mesh(addon("base.compat").read_positions(mesh), corners)
    assert check["closed"]
    assert list(check["euler"]) == [2] * check["components"]
    assert check["components"] == 1 + len(_report(collection)["extra_roots"])


@pytest.mark.parametrize("name", ["tubes/AL06a.obj", "squares/AL06a_squares.obj"])
def test_real_exports_come_in_whole(shared_tree, name):
    report = _report(import_collection(shared_tree(name)))
    assert report["branches"] == 199
    assert report["surface"]["components"] == 1 and report["surface"]["closed"]
    assert report["skipped_parts"] == []


def test_a_real_tree_keeps_all_its_branches_under_a_bone_budget(shared_tree):
    report = _report(import_collection(shared_tree("tubes/BL02A_Betula_lenta.obj"), max_bones=1000))
    assert (report["branches"], report["bones"]) == (1348, 1000)


def test_a_tree_far_away_stands_there(tmp_path):
    lines = MAPLE.read_text().splitlines()
    moved = [
        "v " + " ".join(f"{float(n) + by:.6f}" for n, by in zip(line.split()[1:], (1e6, 0, -2e6)))
        if line.startswith("v ")
        else line
        for line in lines
    ]
    (tmp_path / "far.obj").write_text("\n".join(moved))
    bpy.ops.import_scene.xfrog_tree(filepath=str(tmp_path / "far.obj"))
    rig, bark = bpy.data.objects["far"], bpy.data.objects["far_bark"]
    assert tuple(rig.location)[:2] == pytest.approx((1e6, 2e6), abs=20)
    bpy.context.view_layer.update()
    assert tuple(bark.matrix_world.translation)[:2] == pytest.approx((1e6, 2e6), abs=20)
    assert max(abs(number) for vertex in bark.data.vertices for number in vertex.co) < 20


def test_textures_elsewhere_are_read_only_where_that_is_allowed(tmp_path):
    secret = bpy.data.images.new("secret", 2, 2)
    secret.filepath_raw, secret.file_format = str(tmp_path / "secret.png"), "PNG"
    secret.save()
    bpy.data.images.remove(secret)
    folder = tmp_path / "packs" / "maple"
    folder.mkdir(parents=True)
    (folder / "maple.mtl").write_text("newmtl bark\nmap_Kd ../../secret.png\n")
    text = MAPLE.read_text()
    (folder / "maple.obj").write_text(f"mtllib maple.mtl\nusemtl bark\n{text}")

    def images(**options):
        bpy.ops.import_scene.xfrog_tree(filepath=str(folder / "maple.obj"), **options)
        return {Path(image.filepath).name for image in bpy.data.images}

    assert "secret.png" not in images()
    assert "secret.png" in images(outside_files=True)
