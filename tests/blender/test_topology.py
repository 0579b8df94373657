# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects whose faces change in the middle of a shot: their snow continues if their UV map does."""

import bpy
import numpy as np
import pytest
import snow_scene as s


def keyed(modifier, name, *values):
    """Keyframes (frame, value) of a modifier's setting, in steps."""
    for frame, value in values:
        setattr(modifier, name, value)
        modifier.keyframe_insert(name, frame=frame)
    return modifier


def subdivided(obj, *levels):
    modifier = obj.modifiers.new("Subdivision", "SUBSURF")
    modifier.subdivision_type = "SIMPLE"
    return keyed(modifier, "render_levels", *levels)


def grid(name, cells=8, size=2.0, z=0.0):
    """A level square of cells x cells quads whose UV map fills the map."""
    steps = np.linspace(0.0, 1.0, cells + 1)
    points = [((u - 0.5) * size, (v - 0.5) * size, z) for v in steps for u in steps]
    faces = [(a, a + 1, a + cells + 2, a + cells + 1)
             for a in (row * (cells + 1) + column for row in range(cells) for column in range(cells))]  # fmt: skip
    uv = [(points[i][0] / size + 0.5, points[i][1] / size + 0.5) for face in faces for i in face]
    return s.mesh_object(name, points, faces, uv)


def test_a_receiver_keeps_its_snow_when_it_gets_finer(native, tmp_path):
    ground = s.square("Ground")
    s.receive(ground)
    subdivided(ground, (2, 0), (3, 3))
    s.settings(tmp_path)
    s.bake()
    depths = [s.open_ground(s.height(native, tmp_path, "Ground", frame)) for frame in (1, 2, 3, 4)]
    assert depths == pytest.approx([0.025, 0.05, 0.075, 0.1], rel=2e-3)


def test_faces_that_are_built_later_gather_from_then_on(native, tmp_path):
    ground = grid("Ground")
    s.receive(ground)
    build = ground.modifiers.new("Build", "BUILD")
    build.frame_start, build.frame_duration = -7.0, 16.0  # half of it is there at frame 1
    s.settings(tmp_path, (1, 9), end_depth=0.09)
    s.bake()
    map_ = s.height(native, tmp_path, "Ground", 9)
    # 64 faces in 16 frames: the last half row of eight is there at the last frame only.
    assert float(map_[1:7, 4:60].mean()) == pytest.approx(0.09, rel=0.03)
    assert float(map_[57:63, 36:60].mean()) == pytest.approx(0.01, rel=0.1)
    assert float(map_[57:63, 4:28].mean()) == pytest.approx(0.02, rel=0.1)


def test_snow_goes_with_the_faces_that_it_lay_on(native, tmp_path):
    ground = grid("Ground")
    below = s.square("Below", 2.0, z=-1.0)
    s.receive(ground, below)
    mask = ground.modifiers.new("Mask", "MASK")
    half = ground.vertex_groups.new(name="Half")
    half.add([i for i, vertex in enumerate(ground.data.vertices) if vertex.co.x > 1e-3], 1.0, "REPLACE")
    mask.vertex_group, mask.invert_vertex_group = "Half", True
    keyed(mask, "show_render", (1, False), (3, True))
    s.settings(tmp_path)
    s.bake()
    map_ = s.height(native, tmp_path, "Ground", 4)
    assert s.texel(map_, 0.25, 0.5) == pytest.approx(0.1, rel=0.02)
    assert map_[8:-8, 40:-8].max() == 0
    fallen = s.height(native, tmp_path, "Below", 4)
    assert s.texel(fallen, 0.85, 0.5) == pytest.approx(0.05, rel=0.1) and s.texel(fallen, 0.25, 0.5) == 0


def test_an_array_that_grows_shelters_more(native, tmp_path):
    s.receive(s.square("Ground", 4.0))
    roof = s.square("Roof", 1.0, z=1.0)
    array = roof.modifiers.new("Array", "ARRAY")
    array.relative_offset_displace = (1.0, 0.0, 0.0)
    keyed(array, "count", (2, 1), (3, 2))
    s.settings(tmp_path)
    s.bake()
    map_ = s.height(native, tmp_path, "Ground", 4)
    assert s.texel(map_, 0.5, 0.5) == 0
    assert s.texel(map_, 0.75, 0.5) == pytest.approx(0.05, rel=0.05)


def changing_scene(folder, **values):
    """A ground that gets finer, a waving plate that is decimated, a roof that grows: two receive."""
    ground, plate = s.square("Ground", 4.0), grid("Plate", 6, 1.5, z=0.5)
    subdivided(ground, (1, 0), (4, 1), (7, 3))
    decimate = plate.modifiers.new("Decimate", "DECIMATE")
    keyed(decimate, "ratio", (1, 1.0), (12, 0.4))
    wave = plate.modifiers.new("Wave", "WAVE")
    wave.height, wave.speed = 0.1, 0.05
    roof = s.square("Roof", 1.0, z=2.0, x=1.0)
    array = roof.modifiers.new("Array", "ARRAY")
    keyed(array, "count", (1, 1), (6, 3))
    s.receive(ground, plate)
    s.settings(folder, (1, 12), checkpoint_interval=4, **values)
    return ground, plate


@pytest.fixture
def undisturbed(tmp_path):
    """The bytes of a whole bake of the changing scene; from then on the cache is tmp/cache."""
    changing_scene(tmp_path / "whole", noise_density=0.5, substeps=2, blur_radius=2.0, write_normals=True)
    s.bake()
    bpy.context.scene.snowbough.cache_directory = str(tmp_path / "cache")
    return s.files_of(tmp_path / "whole")


def test_the_scene_of_these_tests_changes_as_it_says(addon, tmp_path):
    changing_scene(tmp_path)
    counts = {}
    reader_class = addon("scene.reader").SceneReader
    read = reader_class.read

    def counting(self, depsgraph, frame):
        pose = read(self, depsgraph, frame)
        for obj in pose.objects.values():
            counts.setdefault(obj.name, set()).add(len(obj.topology.triangles))
        return pose

    reader_class.read = counting
    try:
        s.bake()
    finally:
        reader_class.read = read
    assert counts["Ground"] == {2, 8, 32, 128} and len(counts["Plate"]) > 4 and counts["Roof"] == {2, 4, 6}


@pytest.mark.parametrize("last", [3, 4, 6, 8, 11])
def test_a_bake_that_stopped_around_a_change_resumes_to_the_same_bytes(addon, undisturbed, tmp_path, last):
    assert s.bake_part(addon, 1, last).error is None
    s.bake(resume=True)
    assert s.files_of(tmp_path / "cache") == undisturbed


def test_a_bake_that_is_split_by_receivers_makes_the_same_bytes(addon, undisturbed, tmp_path):
    assert s.bake_part(addon, 1, 12, ["Plate"]).error is None
    assert s.bake_part(addon, 1, 5, ["Ground"]).error is None
    assert s.bake_part(addon, 6, 12, ["Ground"]).error is None
    assert s.files_of(tmp_path / "cache") == undisturbed


# -- errors -------------------------------------------------------------------------------------------


def refused(match):
    with pytest.raises(RuntimeError, match=match):
        s.bake()


def remeshed(obj, frame):
    modifier = obj.modifiers.new("Remesh", "REMESH")
    modifier.mode, modifier.voxel_size = "VOXEL", 0.2
    keyed(modifier, "show_render", (1, False), (frame, True))


def test_a_receiver_whose_uv_map_vanishes_is_named_with_the_frame(tmp_path):
    bpy.ops.mesh.primitive_cube_add(size=1.0)
    cube = bpy.context.object
    cube.name = "Block"
    s.receive(cube)
    remeshed(cube, 3)
    s.settings(tmp_path)
    refused(
        r"The faces of 'Block' change at frame 3, and its UV map 'UVMap' is gone.*remove 'Block' from the list"
    )


def test_what_was_baked_before_the_refusal_is_kept(addon, tmp_path):
    bpy.ops.mesh.primitive_cube_add(size=1.0)
    cube = bpy.context.object
    s.receive(cube)
    remeshed(cube, 3)
    s.settings(tmp_path)
    refused("at frame 3")
    assert [name[-8:] for name in s.files_of(tmp_path) if name.endswith(".exr")] == ["0001.exr", "0002.exr"]
    cube.modifiers.clear()
    s.bake(resume=True)


def test_an_occluder_may_lose_its_uv_map(native, tmp_path):
    s.receive(s.square("Ground", 4.0))
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=(0, 0, 2))
    remeshed(bpy.context.object, 3)
    s.settings(tmp_path)
    s.bake()
    assert s.texel(s.height(native, tmp_path, "Ground", 4), 0.5, 0.5) == 0


def test_uvs_that_leave_the_map_are_named_with_the_frame(tmp_path):
    ground = s.square("Ground")
    s.receive(ground)
    array = ground.modifiers.new("Array", "ARRAY")
    array.offset_u = 0.5
    keyed(array, "count", (2, 1), (3, 2))
    s.settings(tmp_path)
    refused(r"The faces of 'Ground' change at frame 3, and do not lie on its UV map 'snow' from 0 to 1")


def test_faces_without_any_place_on_the_map_are_named_with_the_frame(tmp_path):
    ground = grid("Ground", 2)
    for corner in ground.data.uv_layers[0].data[:4]:
        corner.uv = (0.5, 0.5)
    s.receive(ground)
    mask = ground.modifiers.new("Mask", "MASK")
    ground.vertex_groups.new(name="First").add([0, 1, 3, 4], 1.0, "REPLACE")
    mask.vertex_group = "First"
    keyed(mask, "show_render", (1, False), (3, True))
    s.settings(tmp_path)
    refused("The faces of 'Ground' change at frame 3, and do not lie on its UV map")
