# SPDX-License-Identifier: GPL-3.0-or-later
"""The baked snow beside an exported tree: heights, normals, atlases, and the snow surface in the file."""

import json

import bpy
import child
import numpy as np
import pytest
import snow_scene
from exported_tree import PLAIN, export, import_tree, y_up


@pytest.fixture
def snowy(tmp_path, addon):
    """(bark, its folder, the native module): a bake of three frames at 64 texels, with normals."""
    _rig, bark = import_tree(snow_resolution=256)
    snow_scene.receive(bark, resolution=256)
    bpy.context.scene.snowbough.receivers[0].uv_map = "snow"
    snow_scene.settings(tmp_path / "cache", (1, 3), write_normals=True)
    snow_scene.bake()
    return bark, snow_scene.folder_of(tmp_path / "cache", bark.name), addon("base.native").load()


def png_samples(path):
    """(H, W) or (H, W, 3) of a PNG's own numbers, row 0 at the bottom, as Blender reads it."""
    image = bpy.data.images.load(str(path))
    image.colorspace_settings.name = "Non-Color"
    width, height = image.size
    pixels = np.array(image.pixels[:]).reshape(height, width, image.channels)
    return pixels, image


def snow_of(read, part="small_maple_bark"):
    return read.json["scenes"][0]["extras"]["snowbough"]["snow"][part]


def test_heights_of_a_frame_come_back_in_metres(tmp_path, snowy):
    _bark, folder, native = snowy
    bpy.context.scene.frame_set(3)
    read = export(tmp_path / "tree.glb", snow="FRAME")
    said = snow_of(read)
    assert (said["texCoord"], said["frames"], said["columns"], said["rows"], said["tile"]) == (
        1,
        [3],
        1,
        1,
        256,
    )
    baked = native.read_exr(str(folder / "height_0003.exr"))[0]
    assert baked.max() > 0.01
    pixels, image = png_samples(tmp_path / said["height"]["uri"])
    assert image.depth == 16 or image.is_float or len(np.unique(pixels[..., 0])) > 256
    metres = said["height"]["offset"] + said["height"]["scale"] * pixels[..., 0]
    assert np.abs(metres - baked).max() < 1e-5


def test_a_file_with_a_map_has_the_width_of_its_limbs(tmp_path, snowy):
    bark, _folder, _native = snowy
    read = export(tmp_path / "tree.glb", levels=1, snow="FRAME")
    given = read.attributes(read.primitives(read.node("small_maple_bark_LOD0"))[0])
    widest = 2 * max(bone.head_radius for bone in bark.find_armature().data.bones)
    assert given["_LIMB_WIDTH"].max() == pytest.approx(widest, rel=0.3)


def test_normals_of_a_frame_come_back(tmp_path, snowy):
    _bark, folder, native = snowy
    bpy.context.scene.frame_set(2)
    said = snow_of(export(tmp_path / "tree.glb", snow="FRAME"))
    baked = native.read_exr(str(folder / "normal_0002.exr"))[0]
    pixels, _image = png_samples(tmp_path / said["normal"]["uri"])
    assert np.abs(pixels[..., :3] - baked).max() < 0.01
    assert np.ptp(baked[..., 0]) > 0.1


def test_heights_can_go_out_as_exr(tmp_path, snowy):
    _bark, folder, native = snowy
    bpy.context.scene.frame_set(3)
    said = snow_of(export(tmp_path / "tree.glb", snow="FRAME", snow_format="EXR"))
    assert (said["height"]["scale"], said["height"]["offset"]) == (1.0, 0.0)
    written = native.read_exr(str(tmp_path / said["height"]["uri"]))[0]
    assert np.array_equal(written, native.read_exr(str(folder / "height_0003.exr"))[0])


def test_an_atlas_holds_frames_from_the_top_left_on(tmp_path, snowy):
    _bark, folder, native = snowy
    bpy.context.scene.snowbough.surface_relief = 0.25
    said = snow_of(export(tmp_path / "tree.gltf", snow="ATLAS", atlas_frames=3, atlas_tile=128))
    assert (said["frames"], said["columns"], said["rows"], said["tile"]) == ([1, 2, 3], 2, 2, 128)
    pixels, _image = png_samples(tmp_path / said["height"]["uri"])
    metres = said["height"]["offset"] + said["height"]["scale"] * pixels[..., 0]
    for number, (top, left) in enumerate([(128, 0), (128, 128), (0, 0)]):
        baked = native.read_exr(str(folder / f"height_{number + 1:04d}.exr"))[0]
        tile = baked.reshape(128, 2, 128, 2).mean(axis=(1, 3))
        assert np.abs(metres[top : top + 128, left : left + 128] - tile).max() < 1e-5
    assert said["openDepths"] == pytest.approx([0.1 / 3, 0.2 / 3, 0.1], rel=0.01)
    assert said["lastDepth"] == pytest.approx(0.1)
    assert said["style"] == {"overhang": 1.0, "hem_variation": 1.0, "bridging": 1.0, "relief": 0.25}


def test_the_surface_of_a_frame_goes_out_as_a_mesh_of_snow(tmp_path, snowy):
    import snow_scene

    bark, _folder, _native = snowy
    bpy.ops.snowbough.setup_displacement(mode="SHELL")
    snow_scene.settings(tmp_path / "with_surface", (1, 3), surface_detail="DRAFT")
    snow_scene.bake()
    bark.find_armature().location = (3.0, -2.0, 1.0)
    bark.find_armature().rotation_euler.z = 0.5
    for frame in (1, 3):
        bpy.context.scene.frame_set(frame)
        shown = bpy.data.objects["small_maple_bark Snow"].evaluated_get(bpy.context.evaluated_depsgraph_get())
        # The file has the armature's rotation but not its location.
        to_file = bark.find_armature().matrix_world.copy()
        to_file.translation = (0.0, 0.0, 0.0)
        to_file = to_file @ bark.find_armature().matrix_world.inverted() @ shown.matrix_world
        expected = np.array([to_file @ vertex.co for vertex in shown.data.vertices])
        read = export(tmp_path / f"tree{frame}.glb", snow="SURFACE")
        node = read.node("small_maple_bark_snow")
        assert node["name"] in [read.json["nodes"][n]["name"] for n in read.json["scenes"][0]["nodes"]]
        (primitive,) = read.json["meshes"][node["mesh"]]["primitives"]
        assert read.json["materials"][primitive["material"]]["name"] == "Snow"
        found = read.array(primitive["attributes"]["POSITION"])
        assert found == pytest.approx(y_up(expected), abs=1e-5)
        assert len(read.array(primitive["indices"])) > 3000


def test_a_tree_whose_bake_has_no_surface_says_what_to_do(tmp_path, snowy, addon):
    bark, _folder, _native = snowy
    options = addon("gltf.export_options").ExportOptions(**PLAIN, snow="SURFACE")
    with pytest.raises(ValueError, match="no snow to export, so nothing was written.*Update Surface"):
        addon("gltf.export_tree").export(bpy.context, bark, tmp_path / "tree.glb", options)
    assert not (tmp_path / "tree.glb").exists()


def test_a_tree_without_a_bake_says_so(tmp_path, addon):
    _rig, bark = import_tree()
    options = addon("gltf.export_options").ExportOptions(**PLAIN, snow="FRAME")
    with pytest.raises(ValueError, match="no snow to export, so nothing was written.*has no baked snow"):
        addon("gltf.export_tree").export(bpy.context, bark, tmp_path / "tree.glb", options)
    assert not list(tmp_path.glob("tree*"))


def test_bake_then_export_on_the_command_line_finds_the_snow_by_its_cache(tmp_path):
    """The bake does not save the .blend."""
    _rig, bark = import_tree(snow_resolution=256)
    snow_scene.receive(bark, resolution=256)
    bpy.context.scene.snowbough.receivers[0].uv_map = "snow"
    snow_scene.settings(tmp_path / "unused", (1, 2), surface_detail="DRAFT")
    bpy.ops.snowbough.setup_displacement(mode="SHELL")
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "tree.blend"))
    export = ["export", str(tmp_path / "tree.glb"), "--snow", "SURFACE", "--frame", "2", "--levels", "1"]
    export += ["--cards", "--texture-size", "0", "--json", str(tmp_path / "report.json")]
    refused = child.cli(tmp_path / "tree.blend", *export)
    assert refused.returncode == 1 and "There is no snow to export" in refused.stderr
    assert not (tmp_path / "tree.glb").exists()
    assert child.bake(tmp_path / "tree.blend", "--cache", str(tmp_path / "cache")).returncode == 0
    found = child.cli(tmp_path / "tree.blend", *export, "--cache", str(tmp_path / "cache"))
    assert found.returncode == 0, found.stderr
    assert json.loads((tmp_path / "report.json").read_text())["heaps"]["small_maple_bark_snow"] > 100
