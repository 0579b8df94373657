# SPDX-License-Identifier: GPL-3.0-or-later
"""Which sides of a receiver take snow, and where it is shaded smooth: from the scene to the baked map."""

import math
from types import SimpleNamespace

import bpy
import numpy as np
import pytest
import snow_scene as s


@pytest.fixture
def map_of(native, tmp_path):
    """Bakes the receivers and returns the last map of one of them."""

    def bake(name, **settings):
        s.settings(tmp_path, (1, 2), **settings)
        s.bake()
        return s.height(native, tmp_path, name, 2)

    return bake


def upside_down(name="Leaf", **arguments):
    obj = s.square(name, **arguments)
    obj.rotation_euler = (math.pi, 0.0, 0.0)
    return obj


def ball(smooth=True, segments=32, rings=16):
    """A unit ball, its UV map laid out by longitude and latitude."""
    points = [(0, 0, -1)]
    for ring in range(1, rings):
        low, out = -math.cos(math.pi * ring / rings), math.sin(math.pi * ring / rings)
        points += [
            (out * math.cos(2 * math.pi * i / segments), out * math.sin(2 * math.pi * i / segments), low)
            for i in range(segments)
        ]
    points.append((0, 0, 1))

    def at(ring, i):
        return (
            0 if ring == 0 else len(points) - 1 if ring == rings else 1 + (ring - 1) * segments + i % segments
        )

    faces, uv = [], []
    for ring in range(rings):
        for i in range(segments):
            corners = [(ring, i), (ring, i + 1), (ring + 1, i + 1), (ring + 1, i)]
            if ring == 0:
                corners.pop(1)
            elif ring == rings - 1:
                corners.pop(2)
            faces.append([at(*corner) for corner in corners])
            uv += [(0.02 + 0.96 * c / segments, 0.02 + 0.96 * r / rings) for r, c in corners]
    obj = s.mesh_object("Ball", points, faces, uv)
    obj.data.polygons.foreach_set("use_smooth", [smooth] * len(faces))
    return obj


def profile_error(map_, radius):
    """Largest difference of what a map's heights hold on a ball from the cosine over the upper half, as part of the
    depth of 0.1 m; `radius`: of curvature, infinite where faces are flat."""
    rows = (np.arange(len(map_)) + 0.5) / len(map_)
    rise = ((rows - 0.02) / 0.96 - 0.5) * math.pi
    upper = (rise > 0.05) & (rise < 0.5 * math.pi * 14 / 16)
    held = map_ + map_**2 / radius + map_**3 / (3.0 * radius**2)
    return abs(held[upper, 8:-8] / 0.1 - np.sin(rise[upper])[:, None]).max()


# Sides


def test_a_leaf_that_faces_down_carries_snow_on_its_back(map_of):
    s.receive(upside_down())
    map_ = map_of("Leaf")
    assert map_.max() < 0.0
    assert s.open_ground(map_) == pytest.approx(-0.1, rel=2e-3)


def test_positive_and_both_are_what_the_artist_says(native, tmp_path):
    s.receive(upside_down("A"), upside_down("B", x=4.0))
    for entry, sides in zip(bpy.context.scene.snowbough.receivers, ("POSITIVE", "BOTH")):
        assert entry.sides == "AUTO"
        entry.sides = sides
    s.settings(tmp_path, (1, 2))
    s.bake()
    assert abs(s.height(native, tmp_path, "A", 2)).max() == 0.0
    assert s.open_ground(s.height(native, tmp_path, "B", 2)) == pytest.approx(-0.1, rel=2e-3)


def test_what_is_negative_counts_as_covered_and_as_high(native, tmp_path):
    s.receive(upside_down())
    s.settings(tmp_path, (1, 2))
    s.bake()
    folder = s.folder_of(tmp_path, "Leaf")
    assert native.read_exr(str(folder / "ever_covered.exr"))[0].mean() > 0.95
    manifest = s.manifest_of(tmp_path, "Leaf")
    assert manifest["frames"][-1]["highest"] == pytest.approx(0.1, rel=1e-2)
    assert manifest["settings"]["receiver"]["sides"] == "AUTO"


def test_other_sides_are_told_as_a_change_and_refused_when_a_bake_goes_on(addon, native, tmp_path):
    s.receive(upside_down())
    s.settings(tmp_path, (1, 2))
    s.bake()
    scene = bpy.context.scene
    scene.snowbough.receivers[0].sides = "POSITIVE"
    changes = addon("bake.changes_since_bake").settings_changes(scene)
    assert changes == ["Leaf: sides Positive, was Automatic"]


def test_a_mirrored_leaf_has_its_positive_side_where_blender_shows_it(map_of):
    leaf = s.square("Leaf")
    leaf.scale = (1, 1, -1)  # turned over, its normals point down
    s.receive(leaf)
    assert s.open_ground(map_of("Leaf")) == pytest.approx(-0.1, rel=2e-3)


# Smooth shading


def test_a_smooth_ball_has_no_terraces_and_a_flat_one_keeps_its_faces(native, tmp_path):
    balls = ball(True), ball(False)
    balls[0].name, balls[1].name = "Smooth", "Flat"
    balls[1].location.x = 5.0
    s.receive(*balls, resolution=256)
    s.settings(tmp_path, (1, 2), pixel_size=0.016)
    s.bake()
    assert profile_error(s.height(native, tmp_path, "Smooth", 2), 1.0) < 0.02
    assert profile_error(s.height(native, tmp_path, "Flat", 2), math.inf) > 0.05


def shading_of(addon, obj):
    """((T, 3) numbers or None, polygon of each triangle) as a bake would read them."""
    mesh_record, compat = addon("scene.mesh_record"), addon("base.compat")
    mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    record = mesh_record.MeshRecord(mesh)
    numbers, count = record.shading(record.triangle_corners())
    polygons = np.empty(len(mesh.loop_triangles), np.int32)
    mesh.loop_triangles.foreach_get("polygon_index", polygons)
    assert compat and count == len(polygons)
    return numbers, polygons


@pytest.fixture
def roof():
    """Two slopes that meet in a ridge: vertices 1 and 2."""
    obj = s.mesh_object(
        "Roof",
        [(-1, -1, 0), (0, -1, 1), (0, 1, 1), (-1, 1, 0), (1, -1, 0), (1, 1, 0)],
        [(0, 1, 2, 3), (1, 4, 5, 2)],
    )
    obj.data.polygons.foreach_set("use_smooth", [True, True])
    return SimpleNamespace(
        obj=obj, ridge=obj.data.edges[[tuple(e.vertices) for e in obj.data.edges].index((1, 2))]
    )


def joins_the_slopes(numbers, polygons):
    return bool(set(numbers[polygons == 0].ravel()) & set(numbers[polygons == 1].ravel()))


def test_smooth_faces_share_numbers_across_their_edges(addon, roof):
    numbers, polygons = shading_of(addon, roof.obj)
    assert joins_the_slopes(numbers, polygons) and len(np.unique(numbers)) == 6


def test_flat_faces_have_none(addon, roof):
    roof.obj.data.polygons.foreach_set("use_smooth", [True, False])
    roof.obj.data.update()
    numbers, polygons = shading_of(addon, roof.obj)
    assert (numbers[polygons == 1] == -1).all() and (numbers[polygons == 0] >= 0).all()
    roof.obj.data.polygons.foreach_set("use_smooth", [False, False])
    roof.obj.data.update()
    assert shading_of(addon, roof.obj)[0] is None


def test_a_sharp_edge_divides(addon, roof):
    if bpy.app.version < (4, 1):
        roof.obj.data.use_auto_smooth = True
        roof.obj.data.auto_smooth_angle = math.pi
        roof.ridge.use_edge_sharp = True
    else:
        roof.ridge.use_edge_sharp = True
    roof.obj.data.update()
    assert not joins_the_slopes(*shading_of(addon, roof.obj))


@pytest.mark.skipif(bpy.app.version >= (4, 1), reason="Auto Smooth became a modifier in 4.1")
@pytest.mark.parametrize("angle, joined", [(80, False), (100, True)])
def test_auto_smooth_divides_at_its_angle(addon, roof, angle, joined):
    roof.obj.data.use_auto_smooth = True
    roof.obj.data.auto_smooth_angle = math.radians(angle)
    roof.obj.data.update()
    assert joins_the_slopes(*shading_of(addon, roof.obj)) == joined


def test_custom_normals_divide_where_they_differ(addon, roof):
    mesh = roof.obj.data
    if bpy.app.version < (4, 1):
        mesh.use_auto_smooth = True
        mesh.auto_smooth_angle = math.radians(80.0)
    else:
        roof.ridge.use_edge_sharp = True
    up, aside = (0.0, 0.0, 1.0), (0.6, 0.0, 0.8)
    mesh.normals_split_custom_set([up] * 4 + [aside] * 4)
    assert not joins_the_slopes(*shading_of(addon, roof.obj))
    mesh.normals_split_custom_set([up] * 8)
    assert joins_the_slopes(*shading_of(addon, roof.obj))
