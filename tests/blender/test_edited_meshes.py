# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes that frame handlers edit or swap, as stop-motion add-ons do, are seen at every frame."""

import bpy
import numpy as np
import pytest
import snow_scene as s

FRAMES = (1, 6)


@pytest.fixture
def at_frames():
    """at_frames({3: function}) calls a function at each change to that frame, in a handler."""
    handlers = []

    def add(actions, where=bpy.app.handlers.frame_change_post):
        def handler(scene, _depsgraph=None):
            action = actions.get(scene.frame_current)
            if action is not None:
                action()

        where.append(handler)
        handlers.append((where, handler))

    yield add
    for where, handler in handlers:
        where.remove(handler)


@pytest.fixture
def scene(tmp_path):
    """A ground that receives, and a roof over all of it."""
    ground, roof = s.square("Ground"), s.square("Roof", 4.0, z=1.0)
    s.receive(ground)
    s.settings(tmp_path, FRAMES, end_depth=0.6)
    return ground, roof


def empty_mesh():
    return bpy.data.meshes.new("Nothing")


def moved_mesh(mesh, x):
    """A moved copy of a mesh with the same numbers of vertices and faces."""
    copy = mesh.copy()
    for vertex in copy.vertices:
        vertex.co.x += x
    return copy


def open_ground_at(native, root, *frames):
    return [round(s.open_ground(s.height(native, root, "Ground", frame)), 4) for frame in frames]


@pytest.mark.parametrize("where", ["frame_change_pre", "frame_change_post"])
@pytest.mark.parametrize("mesh", ["empty", "moved"])
def test_a_roof_whose_mesh_is_swapped_shelters_no_more(native, scene, at_frames, tmp_path, where, mesh):
    roof = scene[1]
    own, other = roof.data, empty_mesh() if mesh == "empty" else moved_mesh(roof.data, 50.0)
    at_frames({1: lambda: setattr(roof, "data", own), 4: lambda: setattr(roof, "data", other)},
              getattr(bpy.app.handlers, where))  # fmt: skip
    s.bake()
    assert open_ground_at(native, tmp_path, 3, 4, 6) == [0.0, 0.1, 0.3]


@pytest.mark.parametrize("tagged", [True, False])
def test_a_roof_that_is_edited_in_place_shelters_no_more(native, scene, at_frames, tmp_path, tagged):
    mesh = scene[1].data
    start = np.array([vertex.co for vertex in mesh.vertices], dtype=np.float32)

    def put(x):
        mesh.vertices.foreach_set("co", (start + [x, 0, 0]).astype(np.float32).ravel())
        if tagged:
            mesh.update()
        else:
            mesh.vertices[0].co.x = mesh.vertices[0].co.x  # an edit that Blender itself detects

    at_frames({1: lambda: put(0.0), 4: lambda: put(50.0)})
    s.bake()
    assert open_ground_at(native, tmp_path, 3, 4, 6) == [0.0, 0.1, 0.3]


def test_a_roof_that_comes_back_shelters_again(native, scene, at_frames, tmp_path):
    roof = scene[1]
    own, nothing = roof.data, empty_mesh()
    at_frames({1: lambda: setattr(roof, "data", nothing), 3: lambda: setattr(roof, "data", own)})
    s.bake()
    assert open_ground_at(native, tmp_path, 2, 3, 6) == [0.2, 0.2, 0.2]


def test_swapping_a_deformed_roof_for_one_with_as_many_faces_is_noticed(native, scene, at_frames, tmp_path):
    """Half a roof of two squares, and the other half: the same vertices, other faces."""
    vertices = [(x, y, 1.0) for x in (-2.0, 0.0, 2.0) for y in (-2.0, 2.0)]
    bpy.data.objects.remove(scene[1])
    roof = s.mesh_object("Roof", vertices, [(0, 2, 3, 1)])
    roof.modifiers.new("Cast", "CAST").factor = 0.0
    left, right = roof.data, bpy.data.meshes.new("Right")
    right.from_pydata(vertices, [], [(2, 4, 5, 3)])
    at_frames({1: lambda: setattr(roof, "data", left), 4: lambda: setattr(roof, "data", right)})
    s.bake()
    heights = s.height(native, tmp_path, "Ground", 6)
    assert [round(s.texel(heights, u, 0.5), 4) for u in (0.25, 0.75)] == [0.3, 0.3]


def test_a_roof_that_is_removed_and_made_again_under_its_name_is_read_again(
    native, scene, at_frames, tmp_path
):
    def again():
        bpy.data.objects.remove(bpy.data.objects["Roof"])
        s.square("Roof", 4.0, z=1.0, x=50.0)

    at_frames({4: again})
    s.bake()
    assert open_ground_at(native, tmp_path, 3, 4, 6) == [0.0, 0.1, 0.3]


def test_a_modifier_that_a_handler_adds_counts(native, scene, at_frames, tmp_path):
    roof = scene[1]

    def add():
        roof.modifiers.new("Mask", "MASK").vertex_group = roof.vertex_groups.new(name="None").name

    at_frames({4: add})
    s.bake()
    assert open_ground_at(native, tmp_path, 3, 4, 6) == [0.0, 0.1, 0.3]


def test_a_receiver_that_is_edited_in_place_moves_under_its_snow(addon, native, scene, at_frames, tmp_path):
    ground, roof = scene
    bpy.data.objects.remove(roof)
    roof = s.square("Roof", 4.0, z=1.0, x=10.0)

    def put(x):
        for vertex, corner in zip(ground.data.vertices, (-1, 1, 1, -1)):
            vertex.co.x = x + corner
        ground.data.update()

    at_frames({1: lambda: put(0.0), 4: lambda: put(10.0)})
    s.bake()
    assert open_ground_at(native, tmp_path, 3, 6) == [0.3, 0.3]
    inputs = addon("scene.inputs").SceneInputs(
        addon("cache.manifest").read_inputs(s.folder_of(tmp_path, "Ground"))
    )
    prints = [inputs.at(str(frame))["Ground"] for frame in range(1, 7)]
    assert [after[1] != before[1] for before, after in zip(prints, prints[1:])] == [
        False,
        False,
        True,
        False,
        False,
    ]
    assert len({own[2] for own in prints}) == 1


def test_uvs_that_are_edited_in_place_are_another_map(addon, scene, at_frames, tmp_path):
    ground, roof = scene
    bpy.data.objects.remove(roof)

    def turn():
        layer = ground.data.uv_layers["snow"].data
        for corner in layer:
            corner.uv = (1.0 - corner.uv.x, corner.uv.y)
        ground.data.update()

    at_frames({4: turn})
    s.bake()
    inputs = addon("scene.inputs").SceneInputs(
        addon("cache.manifest").read_inputs(s.folder_of(tmp_path, "Ground"))
    )
    assert inputs.at("3")["Ground"][2] != inputs.at("4")["Ground"][2]


def test_a_bake_that_stopped_around_an_edit_resumes_to_the_same_bytes(addon, scene, at_frames, tmp_path):
    roof = scene[1]
    own, nothing = roof.data, empty_mesh()
    at_frames(
        {
            frame: lambda frame=frame: setattr(roof, "data", own if frame < 4 else nothing)
            for frame in range(9)
        }
    )
    s.bake()
    whole = s.files_of(tmp_path)
    for last in (3, 4, 5):
        bpy.ops.snowbough.free_bake()
        s.bake_part(addon, last=last)
        s.bake(resume=True)
        assert s.files_of(tmp_path) == whole


def test_what_stands_still_is_read_once(addon, scene):
    ground, roof = scene
    roof.shape_key_add()
    meshes, read = addon("scene.local_meshes").LocalMeshes(), []
    for frame in (1, 2):
        bpy.context.scene.frame_set(frame)
        depsgraph = bpy.context.evaluated_depsgraph_get()
        meshes.begin(depsgraph)
        read.append([meshes.read(obj.evaluated_get(depsgraph), True)[0] for obj in (ground, roof)])
    (still, bending), (still_later, bending_later) = read
    assert still_later is still and bending_later is not bending
