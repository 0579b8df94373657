# SPDX-License-Identifier: GPL-3.0-or-later
"""Adding receivers, and the checks before a bake."""

import math
import shutil

import bpy
import pytest
import snow_scene as s


def texts(addon, severity):
    issues = addon("bake.preflight").check(bpy.context.scene, bpy.context.evaluated_depsgraph_get())
    return [issue.text for issue in issues if issue.severity == severity]


def select(*objects):
    bpy.ops.object.select_all(action="DESELECT")
    for obj in objects:
        obj.select_set(True)
    bpy.context.view_layer.objects.active = objects[0]


def stacked(name="Stack"):
    """Two squares above each other on the same place of the map."""
    uv = [(0, 0), (1, 0), (1, 1), (0, 1)]
    points = [(x, y, z) for z in (0, 1) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    return s.mesh_object(name, points, [(0, 1, 2, 3), (4, 5, 6, 7)], uv * 2)


def test_a_clean_scene_has_no_errors_and_no_warnings(addon, tmp_path):
    s.receive(s.square("Ground"))
    s.settings(tmp_path)
    assert texts(addon, "ERROR") == [] and texts(addon, "WARNING") == []
    assert "1 map, up to 64 texels" in " ".join(texts(addon, "INFO"))


def test_changed_settings_are_told_at_once(addon, tmp_path):
    ground = s.square("Ground")
    s.receive(ground)
    own = s.settings(tmp_path)
    s.bake()
    changes = addon("bake.changes_since_bake").settings_changes
    assert changes(bpy.context.scene) == []
    own.end_depth = 0.25
    own.receivers[0].resolution = 128
    assert changes(bpy.context.scene) == ["End Depth: 0.25 m, was 0.1 m", "Ground: resolution 128, was 64"]
    own.end_depth = 0.1
    own.receivers[0].resolution = 64
    own.flutter = math.radians(20.0)
    assert changes(bpy.context.scene) == ["Flutter: 20°, was 0°"]
    own.flutter = 0.0
    s.key(bpy.context.scene.snowbough, "rate", (1, 0.0), (4, 1.0))
    assert changes(bpy.context.scene) == ["Rate: its animation changed"]
    s.bake()
    assert changes(bpy.context.scene) == []


def test_the_check_names_what_moved_since_the_bake(addon, tmp_path):
    ground, roof = s.square("Ground"), s.square("Roof", 1.0, z=1.0)
    s.receive(ground)
    s.settings(tmp_path)
    s.bake()
    bpy.context.scene.frame_set(3)
    assert texts(addon, "WARNING") == []
    roof.location.x = 0.5
    ground.data.vertices[0].co.z = -0.1
    found = "\n".join(texts(addon, "WARNING"))
    assert "Roof: transform changed at frame 3" in found and "Ground: shape changed at frame 3" in found
    bpy.data.objects.remove(roof)
    assert "Roof: removed" in "\n".join(texts(addon, "WARNING"))


def test_adding_snow_sets_the_object_up_and_a_bake_shows_its_files(addon, tmp_path):
    ground = s.square("Ground")
    own = s.settings(tmp_path)
    select(ground)
    bpy.ops.snowbough.add_receivers()
    own.receivers[0].resolution = 64
    displacement = addon("result.displacement")
    assert displacement.mode_of(own.receivers[0]) == "SHELL"
    assert "Ground Snow" not in bpy.data.objects
    for version in ("v001", "v002"):
        s.bake()
        surface = bpy.data.objects["Ground Snow"]
        assert version in surface.modifiers[0].filepath
        nodes = surface.material_slots[0].material.node_tree.nodes
        shown = [node.image for node in nodes if node.type == "TEX_IMAGE"]
        assert shown and all(version in image.filepath for image in shown)
    bpy.context.scene.frame_set(4)
    depsgraph = bpy.context.evaluated_depsgraph_get()
    highest = max(v.co.z for v in surface.evaluated_get(depsgraph).data.vertices)
    assert highest == pytest.approx(0.1, abs=0.02)
    bpy.ops.snowbough.remove()
    assert "Ground Snow" not in bpy.data.objects
    assert len(ground.modifiers) == 0 and not ground.material_slots


def test_adding_snow_can_leave_the_object_as_it_is(addon, tmp_path):
    ground = s.square("Ground")
    select(ground)
    bpy.ops.snowbough.add_receivers(setup_result=False)
    assert addon("result.displacement").mode_of(bpy.context.scene.snowbough.receivers[0]) is None
    assert len(ground.modifiers) == 0


def test_overlapping_uvs_are_a_warning_and_can_be_mended(addon, tmp_path):
    stack = stacked()
    s.receive(stack)
    s.settings(tmp_path)
    assert "overlap" in texts(addon, "WARNING")[0]
    bpy.ops.snowbough.fix(kind="UNWRAP", object_name="Stack")
    assert texts(addon, "WARNING") == []


def test_what_a_bake_would_refuse_is_an_error(addon, tmp_path):
    hidden = s.square("Hidden")
    hidden.hide_render = True
    bare = s.mesh_object("Bare", [(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
    empty = s.mesh_object("Empty", [(0, 0, 0)], [])
    s.receive(hidden, bare, empty)
    s.settings(tmp_path, start_depth=0.5, end_depth=0.1, rate=0.0)
    found = "\n".join(texts(addon, "ERROR"))
    for part in (
        "'Hidden' is hidden in renders",
        "'Bare' has no UV map",
        "'Empty' has no faces",
        "The rate is 0 on every frame",
    ):
        assert part in found
    bpy.ops.snowbough.fix(kind="SHOW_IN_RENDER", object_name="Hidden")
    bpy.ops.snowbough.fix(kind="UNWRAP", object_name="Bare")
    found = "\n".join(texts(addon, "ERROR"))
    assert "Hidden" not in found and "Bare" not in found


def test_an_unsaved_file_and_an_unwritable_cache_are_errors(addon, tmp_path):
    s.receive(s.square("Ground"))
    s.settings("//snowbough_cache")
    assert "Save the .blend first" in texts(addon, "ERROR")[0]
    (tmp_path / "file").write_text("")
    s.settings(tmp_path / "file" / "cache")
    assert "cannot be written" in texts(addon, "ERROR")[0]


def test_uneven_scale_is_a_warning(addon, tmp_path):
    ground = s.square("Ground")
    ground.scale = (1, 2, 1)
    s.receive(ground)
    s.settings(tmp_path)
    bpy.context.view_layer.update()
    assert "scaled unevenly" in texts(addon, "WARNING")[0]


def test_adding_takes_a_clean_uv_map_as_it_is(addon):
    ground = s.square("Ground")
    select(ground)
    bpy.ops.snowbough.add_receivers()
    entry = bpy.context.scene.snowbough.receivers[0]
    assert entry.object == ground and entry.uv_map == "snow" and len(ground.data.uv_layers) == 1


def test_adding_makes_a_map_and_keeps_the_active_one(addon):
    stack = stacked()
    stack.data.uv_layers["snow"].name = "texture"
    before = [tuple(corner.uv) for corner in stack.data.uv_layers["texture"].data]
    other = s.square("Other")
    select(stack, other)
    bpy.ops.snowbough.add_receivers()
    entry = addon("scene.receivers").find(bpy.context.scene, stack)
    assert entry.uv_map == "snow" and addon("scene.uv_maps").is_clean(stack.data, "snow")
    assert stack.data.uv_layers.active.name == "texture"
    assert [tuple(corner.uv) for corner in stack.data.uv_layers["texture"].data] == before
    assert {obj.name for obj in bpy.context.selected_objects} == {"Stack", "Other"}


def test_adding_twice_makes_one_line(addon):
    select(s.square("Ground"))
    bpy.ops.snowbough.add_receivers()
    bpy.ops.snowbough.add_receivers()
    assert len(bpy.context.scene.snowbough.receivers) == 1


def test_what_cannot_gather_snow_is_refused_by_name():
    bpy.ops.object.light_add()
    with pytest.raises(RuntimeError, match="is not a mesh"):
        bpy.ops.snowbough.add_receivers()


def test_the_frame_range_follows_the_scene_until_it_is_set():
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 10, 20
    assert (scene.snowbough.frame_start, scene.snowbough.frame_end) == (10, 20)
    scene.snowbough.frame_end = 15
    assert (scene.snowbough.frame_start, scene.snowbough.frame_end) == (10, 15)
    scene.frame_end = 30
    assert scene.snowbough.frame_end == 15
    scene.snowbough.use_scene_range = True
    assert scene.snowbough.frame_end == 30


def test_a_ground_that_is_too_large_for_its_texel_size_is_a_warning(addon, tmp_path):
    ground = s.square("Ground", 40.0)
    s.receive(ground, resolution=0)
    s.settings(tmp_path)
    assert texts(addon, "WARNING") == []
    ground.scale = (5.0, 5.0, 5.0)
    bpy.context.view_layer.update()
    assert texts(addon, "WARNING") == [
        "'Ground' is too large for texels of 10 mm: its map of 4096 texels a side has texels of 48.8 mm. "
        "Set a higher resolution, split it, or raise Texel Size"
    ]


def test_a_disk_that_is_too_small_is_a_warning(addon, tmp_path):
    s.receive(s.square("Ground"), resolution=8192)
    s.settings(tmp_path, (1, shutil.disk_usage(tmp_path).free // (2 * 8192**2) + 2))  # 2 bytes a texel
    assert any("and the bake may need" in text for text in texts(addon, "WARNING"))


def test_the_findings_of_the_check_go_with_an_undo(addon, tmp_path):
    s.receive(s.square("Ground"))
    s.settings(tmp_path)
    bpy.ops.ed.undo_push(message="Scene")
    bpy.ops.ed.undo_push(message="Later")
    bpy.ops.snowbough.preflight()
    assert addon("base.session").issues
    bpy.ops.ed.undo()
    assert addon("base.session").issues == {}


@pytest.mark.parametrize("resolution", [256, 512, 1024])
@pytest.mark.parametrize("kind", ["square", "sphere"])
def test_the_panel_tells_the_memory_that_the_module_tells(addon, tmp_path, resolution, kind):
    if kind == "square":
        obj = s.square("Ground")
    else:
        bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32)
        obj = bpy.context.object
    s.receive(obj, resolution=resolution)
    s.settings(tmp_path).repose = math.radians(65.0)
    mesh, module = obj.data, addon("base.native").load()
    mesh.calc_loop_triangles()
    corners = [list(triangle.loops) for triangle in mesh.loop_triangles]
    uv = [[tuple(mesh.uv_layers[0].data[corner].uv) for corner in triangle] for triangle in corners]
    with module.SnowSimulation(engine="CPU", repose=math.radians(65.0)) as simulation:
        triangles = [list(triangle.vertices) for triangle in mesh.loop_triangles]
        simulation.add_object("a", triangles, uv, resolution=resolution)
        estimated = simulation.memory_estimate()["total"]
    memory = addon("bake.memory")
    sizes = [memory.MapSize(resolution, len(triangles))]
    assert memory.simulation(sizes, math.radians(65.0)) == pytest.approx(estimated, rel=0.1)
    shown = next(text for text in texts(addon, "INFO") if "of memory" in text)
    whole = memory.estimate(sizes, math.radians(65.0), bpy.context.scene.snowbough.write_normals)
    assert int(shown.split()[-4]) == pytest.approx(whole / 2**20, abs=1) and whole > estimated


def test_a_bake_that_does_not_fit_is_refused_before_anything_is_made(addon, tmp_path):
    memory = addon("bake.memory")
    if not memory.available():
        pytest.skip("the free memory is unknown")
    one = memory.estimate([memory.MapSize(8192, 2)], math.pi / 2, False)
    for number in range(2 + 2 * memory.available() // one):
        s.receive(s.square(f"Ground {number}"), resolution=8192)
    s.settings(tmp_path / "cache")
    assert any("are free: lower the resolution" in text for text in texts(addon, "ERROR"))
    with pytest.raises(RuntimeError, match="of memory, but only .* are free"):
        s.bake()
    assert not (tmp_path / "cache").exists()
