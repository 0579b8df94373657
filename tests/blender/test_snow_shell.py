# SPDX-License-Identifier: GPL-3.0-or-later
"""The shape of snow: no terraces, no gaps, a border on the surface, relief that stays where it is."""

import math

import bpy
import numpy as np
import pytest
import shell_scene
import snow_scene as s
from shell_scene import Geometry, set_relief, shell_of

SIZE = 256
# What a border may be off the surface (metres).
BORDER = 0.001


@pytest.fixture
def snow(addon, tmp_path):
    """snow(obj, *maps): a shell of maps written by hand, without relief unless relief=1."""

    def make(obj, *maps, relief=0.0, **options):
        folder = shell_scene.write_maps(addon("native").load(), tmp_path / obj.name, maps, **options)
        shell = shell_of(obj, folder)
        set_relief(addon, shell, relief)
        bpy.context.scene.frame_set(len(maps))
        return shell

    return make


def unwrapped(obj, name="snow"):
    """The object with each face in a cell of its own, all alike, in the order of the faces."""
    mesh = obj.data
    for layer in list(mesh.uv_layers):
        mesh.uv_layers.remove(layer)
    layer = mesh.uv_layers.new(name=name)
    side = math.ceil(math.sqrt(len(mesh.polygons)))
    for index, polygon in enumerate(mesh.polygons):
        row, column = divmod(index, side)
        for corner, (u, v) in zip(polygon.loop_indices, [(0, 0), (1, 0), (1, 1), (0, 1)]):
            layer.data[corner].uv = ((column + 0.1 + 0.8 * u) / side, (row + 0.1 + 0.8 * v) / side)
    return obj, side


def box(size=1.0):
    bpy.ops.mesh.primitive_cube_add(size=size, location=(0, 0, size / 2))
    return unwrapped(bpy.context.object)


def map_of_faces(obj, side, height_of):
    """A map whose cells hold what height_of says of each face."""
    height = np.zeros((SIZE, SIZE), dtype=np.float32)
    for polygon in obj.data.polygons:
        row, column = divmod(polygon.index, side)
        cell = SIZE / side
        height[int(row * cell) : int((row + 1) * cell), int(column * cell) : int((column + 1) * cell)] = (
            height_of(polygon)
        )
    return height


def top_only(depth):
    return lambda polygon: depth if polygon.normal.z > 0.9 else 0.0


def ball(radius=0.5):
    """A smooth ball of 32 x 16 with longitude and latitude as its map."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=32, ring_count=16, radius=radius)
    obj = bpy.context.object
    bpy.ops.object.shade_smooth()
    obj.data.uv_layers[0].name = "snow"
    return obj


def distance_to_box(points, size=1.0):
    """Distance of points from the surface of a box on the ground, signed."""
    q = np.abs(points - np.array([0, 0, size / 2])) - size / 2
    outside = np.linalg.norm(np.maximum(q, 0), axis=1)
    return outside + np.minimum(q.max(axis=1), 0)


def test_a_smooth_ball_has_no_terraces(snow):
    """Under even snow every point is as far out; the facets of the bare ball are 2.4 mm deep."""
    shell = snow(ball(), np.full((SIZE, SIZE), 0.1))
    points = Geometry(shell).points
    radius = np.linalg.norm(points, axis=1)
    open_sky = np.abs(points[:, 2]) > 0.45  # where snow does not lean
    assert radius[open_sky].mean() == pytest.approx(0.6, abs=0.002)
    assert radius[open_sky].std() < 0.001


def test_a_smooth_ball_has_the_thickness_of_its_map(snow):
    rows = (np.arange(SIZE) + 0.5) / SIZE
    latitude = np.pi * (rows - 0.5)
    profile = 0.1 * np.clip(np.sin(latitude), 0, None)
    shell = snow(ball(), np.repeat(profile[:, None], SIZE, axis=1))
    points = Geometry(shell).points
    points = points[points[:, 2] > 0.1]
    assert Geometry(shell).height.max() == pytest.approx(0.1, rel=0.02)
    direction = points[:, 2] / np.linalg.norm(points, axis=1)
    # How far out a ring of points lies is the same all around it: nothing follows the 32 facets.
    for low in (0.5, 0.7, 0.9):
        ring = np.abs(direction - low) < 0.02
        radius = np.linalg.norm(points[ring], axis=1)
        trend = np.polyval(np.polyfit(direction[ring], radius, 2), direction[ring])
        assert (radius - trend).std() < 0.0015


def test_flat_faces_keep_their_own_normals(snow):
    obj, side = box()
    shell = snow(obj, map_of_faces(obj, side, top_only(0.1)))
    points = Geometry(shell).points
    assert points[:, 2].max() == pytest.approx(1.1, abs=1e-3)
    assert np.abs(points[:, :2]).max() < 0.5 + BORDER  # no lampshade


def test_auto_smooth_edges_are_edges(snow):
    obj, side = box()
    bpy.ops.object.shade_smooth()
    if not hasattr(obj.data, "use_auto_smooth"):
        pytest.skip("smoothing by angle is a modifier here")
    obj.data.use_auto_smooth = True
    shell = snow(obj, map_of_faces(obj, side, top_only(0.1)))
    assert np.abs(Geometry(shell).points[:, :2]).max() < 0.5 + BORDER


def test_the_border_lies_on_the_surface_and_nothing_gapes(snow):
    obj, side = box()
    shell = snow(obj, map_of_faces(obj, side, top_only(0.1)))
    border = Geometry(shell).border()
    assert len(border) > 100
    assert np.abs(distance_to_box(border)).max() < BORDER
    assert (distance_to_box(border) < 0).all()  # below it, or it would flicker


def test_snow_on_two_sides_of_an_edge_is_one_piece(snow):
    obj, side = box()
    shell = snow(obj, map_of_faces(obj, side, lambda p: 0.1 if p.normal.z > 0.9 or p.normal.x > 0.9 else 0.0))
    geometry = Geometry(shell)
    assert np.abs(distance_to_box(geometry.border())).max() < BORDER
    along = np.abs(geometry.points[:, 1]) < 0.3
    corner = geometry.points[along & (geometry.points[:, 0] > 0.4) & (geometry.points[:, 2] > 0.9)]
    # Around the edge the snow goes on without a notch down to the box.
    assert distance_to_box(corner).min() > 0.05


def test_the_rim_of_a_sheet_is_closed(snow):
    shell = snow(s.square("Sheet", 2.0, z=1.0), np.full((SIZE, SIZE), 0.08))
    geometry = Geometry(shell)
    assert geometry.border()[:, 2] == pytest.approx(1.0, abs=BORDER)
    assert geometry.points[:, 2].max() == pytest.approx(1.08, abs=1e-3)


def test_snow_on_the_back_hangs_where_its_height_is_negative(snow):
    shell = snow(s.square("Sheet", 2.0, z=1.0), np.full((SIZE, SIZE), -0.08))
    geometry = Geometry(shell)
    assert geometry.points[:, 2].min() == pytest.approx(0.92, abs=1e-3)
    assert geometry.height.max() == pytest.approx(0.08, rel=1e-3)


def test_faces_with_points_of_their_own_do_not_tear(snow):
    points = [(x, y, 0.0) for x0 in (-1.0, 0.0) for x, y in ((x0, -1), (x0 + 1, -1), (x0 + 1, 1), (x0, 1))]
    uv = [(u0 + u, v) for u0 in (0.0, 0.5) for u, v in ((0, 0), (0.5, 0), (0.5, 1), (0, 1))]
    shell = snow(s.mesh_object("Split", points, [(0, 1, 2, 3), (4, 5, 6, 7)], uv), np.full((SIZE, SIZE), 0.1))
    points = Geometry(shell).points
    middle = points[(np.abs(points[:, 0]) < 0.05) & (np.abs(points[:, 1]) < 0.9)]
    assert middle[:, 2].min() > 0.099


def test_relief_is_bounded_and_ends_with_the_snow(snow, addon):
    ramp = np.clip(np.linspace(-0.02, 0.12, SIZE), 0, None)
    obj = s.square("Ground")
    shell = snow(obj, np.repeat(ramp[None, :], SIZE, axis=0), relief=0.0)
    smooth = Geometry(shell)
    set_relief(addon, shell, 1.0)
    rough = Geometry(shell)
    height = smooth.height
    relief = np.abs(rough.points - smooth.points).max(axis=1)
    assert relief[height < 1e-4].max() < 1e-4
    bound = [addon("result.relief_nodes").highest(depth) for depth in height]
    assert (relief <= np.array(bound) + 1e-5).all()
    assert 0.001 < relief[height > 0.08].std() + relief[height > 0.08].mean() < 0.015


def test_relief_is_one_across_charts(snow, addon):
    """Two halves of a ground whose maps lie anywhere carry the relief of the whole."""
    whole = s.square("Whole")
    snow(whole, np.full((SIZE, SIZE), 0.1), relief=1.0)
    points = [(-1, -1, 0), (0, -1, 0), (0, 1, 0), (-1, 1, 0), (1, -1, 0), (1, 1, 0)]
    uv = [(0, 0), (0.4, 0), (0.4, 1), (0, 1), (1, 1), (0.6, 1), (0.6, 0), (1, 0)]
    halves = s.mesh_object("Halves", points, [(0, 1, 2, 3), (1, 4, 5, 2)], uv)
    snow(halves, np.full((SIZE, SIZE), 0.1), relief=1.0)
    positions = [Geometry(bpy.data.objects[f"{name} snow"]).points for name in ("Whole", "Halves")]
    middle = [p[np.abs(p[:, 0]) < 1e-4] for p in positions]
    inner = [p[np.abs(p[:, 1]) < 0.9] for p in middle]
    order = [p[np.argsort(p[:, 1])] for p in inner]
    at = np.interp(order[1][:, 1], order[0][:, 1], order[0][:, 2])
    assert np.abs(at - order[1][:, 2]).max() < 0.002
    assert order[0][:, 2].std() > 0.001


def test_relief_goes_with_a_mesh_that_deforms(snow, addon):
    obj = s.square("Flag")
    bone = bpy.data.objects.new("Bone", bpy.data.armatures.new("Bone"))
    bpy.context.scene.collection.objects.link(bone)
    bpy.context.view_layer.objects.active = bone
    bpy.ops.object.mode_set(mode="EDIT")
    edit = bone.data.edit_bones.new("Bone")
    edit.head, edit.tail = (0, 0, 0), (0, 1, 0)
    bpy.ops.object.mode_set(mode="OBJECT")
    obj.vertex_groups.new(name="Bone").add([0, 1, 2, 3], 1.0, "REPLACE")
    obj.modifiers.new("Armature", "ARMATURE").object = bone
    for frame, x in ((1, 0.0), (2, 5.0)):
        bone.pose.bones["Bone"].location = (x, 0, 0)
        bone.pose.bones["Bone"].keyframe_insert("location", frame=frame)
    shell = snow(obj, *[np.full((SIZE, SIZE), 0.1)] * 2, relief=1.0)
    bpy.context.scene.frame_set(1)
    before = Geometry(shell)
    place = before.place
    bpy.context.scene.frame_set(2)
    after = Geometry(shell)
    assert np.abs(after.place - place).max() < 1e-6
    assert after.points[:, 0].mean() - before.points[:, 0].mean() == pytest.approx(5.0, abs=1e-3)
    assert np.abs(after.points[:, 2] - before.points[:, 2]).max() < 1e-5
    assert before.points[:, 2].std() > 0.001


def test_relief_and_grains_do_not_boil_while_snow_grows(snow):
    shell = snow(s.square("Ground"), *[np.full((SIZE, SIZE), depth) for depth in (0.05, 0.1)])
    bpy.context.scene.frame_set(1)
    before = Geometry(shell).place
    bpy.context.scene.frame_set(2)
    assert np.array_equal(before, Geometry(shell).place)
