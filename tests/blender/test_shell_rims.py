# SPDX-License-Identifier: GPL-3.0-or-later
"""What shells add to their maps: shoulders at rims, and cushions over needles."""

import bpy
import numpy as np
import pytest
import shell_scene
import snow_scene as s
from shell_scene import Geometry, set_slider, shell_of

SIZE = 256
DEPTH = 0.1
# Of the slopes at rims in these maps.
SLOPE = 2.0


@pytest.fixture
def snow(addon, tmp_path):
    """snow(obj, map, depth=None): a shell without relief; depth: metres on open ground, as the bake's manifest."""

    def make(obj, height, depth=None):
        folder = shell_scene.write_maps(addon("native").load(), tmp_path / obj.name, [height])
        if depth is not None:
            shell_scene.write_depth(addon, folder, depth)
        shell = shell_of(obj, folder)
        set_slider(addon, shell, "Relief", 0.0)
        bpy.context.scene.frame_set(1)
        return shell

    return make


def table(size=1.0):
    """A slab whose top fills the map and whose other faces lie in a corner of it, where there is no snow."""
    bpy.ops.mesh.primitive_cube_add(size=size, location=(0, 0, -size / 2))
    obj = bpy.context.object
    layer = obj.data.uv_layers[0]
    layer.name = "snow"
    for polygon in obj.data.polygons:
        for corner in polygon.loop_indices:
            point = obj.data.vertices[obj.data.loops[corner].vertex_index].co / size
            top = polygon.normal.z > 0.9
            layer.data[corner].uv = (point.x + 0.5, point.y + 0.5) if top else (0.0, 0.0)
    return obj


def heap():
    """Snow on the table that ends at its rims as slopes; nothing in the texel of the other faces."""
    at = (np.arange(SIZE) + 0.5) / SIZE
    rim = np.minimum(at, 1.0 - at)
    height = np.minimum(DEPTH, SLOPE * np.minimum(rim[:, None], rim[None, :]))
    height[:2, :2] = 0.0
    return height


def at_height(points, z, within=0.006):
    return points[np.abs(points[:, 2] - z) < within]


def with_slider(addon, shell, name, value):
    set_slider(addon, shell, name, value)
    return Geometry(shell)


def test_slopes_at_rims_are_drawn_out_to_them(snow, addon):
    shell = snow(table(), heap())
    for strength, least, most in ((0.0, 0.46, 0.49), (1.0, 0.5, 0.5 + DEPTH / 3.0)):
        half_way_up = at_height(with_slider(addon, shell, "Shoulders", strength).points, 0.5 * DEPTH)
        assert least < np.abs(half_way_up[:, :2]).max() < most


def test_fronts_have_round_brims(snow, addon):
    points = with_slider(addon, snow(table(), heap(), DEPTH), "Shoulders", 1.0).points
    reach = [np.abs(at_height(points, part * DEPTH)[:, :2]).max() for part in (0.5, 0.8, 0.95)]
    assert reach[0] > 0.5
    assert reach[0] > reach[1] + 0.05 * DEPTH > reach[2] + 0.2 * DEPTH


def test_fronts_lean_out_here_more_and_there_less(snow, addon):
    points = with_slider(addon, snow(table(), heap(), DEPTH), "Shoulders", 1.0).points
    front = at_height(points, 0.5 * DEPTH)
    front = front[(front[:, 0] > 0.45) & (np.abs(front[:, 1]) < 0.3)]
    parts = [front[np.abs(front[:, 1] - y) < 0.05, 0].max() for y in np.linspace(-0.25, 0.25, 6)]
    assert 0.03 * DEPTH < np.ptp(parts) < 0.3 * DEPTH


def test_the_crest_of_a_bank_stays_when_its_outer_side_is_drawn_out(snow, addon):
    at = (np.arange(SIZE) + 0.5) / SIZE
    rim = np.minimum(at, 1.0 - at)[None, :]
    ridge = np.maximum(np.minimum(SLOPE * rim, 2.0 * DEPTH - SLOPE * rim), 0.0)
    height = np.repeat(ridge, SIZE, axis=0)
    height[:2, :2] = 0.0
    shell = snow(table(), height, DEPTH)
    plain, drawn = (with_slider(addon, shell, "Shoulders", strength).points for strength in (0.0, 1.0))
    middle = np.abs(plain[:, 1]) < 0.3
    moved = np.abs(drawn - plain).max(axis=1)
    crest = middle & (plain[:, 2] > 0.98 * plain[middle, 2].max())
    assert moved[crest].max() < 0.05 * DEPTH
    assert moved[middle & (np.abs(plain[:, 2] - 0.5 * DEPTH) < 0.006)].max() > 0.1 * DEPTH


def test_shoulders_reach_out_no_farther_than_a_third_of_the_depth(snow, addon):
    shell = snow(table(), heap())
    points = with_slider(addon, shell, "Shoulders", 1.0).points
    assert 0.5 < np.abs(points[:, :2]).max() < 0.5 + DEPTH / 3.0


def test_shoulders_leave_level_snow_and_the_border_alone(snow, addon):
    shell = snow(table(), heap())
    plain, drawn = (with_slider(addon, shell, "Shoulders", strength) for strength in (0.0, 1.0))
    level = np.abs(plain.points[:, :2]).max(axis=1) < 0.3
    assert np.abs(plain.points[level] - drawn.points[level]).max() < 1e-5
    assert np.abs(plain.border() - drawn.border()).max() < 1e-3


def test_a_bank_far_from_any_rim_stays(snow, addon):
    at = (np.arange(SIZE) + 0.5) / SIZE
    ramp = np.clip(SLOPE * (at - 0.5), 0.0, DEPTH)
    height = np.repeat(ramp[None, :], SIZE, axis=0)
    shell = snow(s.square("Ground", 4.0), height)
    plain, drawn = (with_slider(addon, shell, "Shoulders", strength) for strength in (0.0, 1.0))
    bank = np.abs(plain.points[:, :2]).max(axis=1) < 1.0
    assert np.ptp(plain.points[bank, 2]) > 0.9 * DEPTH
    assert np.abs(plain.points[bank] - drawn.points[bank]).max() < 1e-5


def test_a_mesh_without_rims_stays(snow, addon):
    bpy.ops.mesh.primitive_uv_sphere_add(segments=32, ring_count=16, radius=0.5)
    bpy.context.object.data.uv_layers[0].name = "snow"
    slope = np.repeat(np.linspace(0.0, DEPTH, SIZE)[:, None], SIZE, axis=1)
    shell = snow(bpy.context.object, slope)
    plain, drawn = (with_slider(addon, shell, "Shoulders", strength).points for strength in (0.0, 1.0))
    assert np.array_equal(plain, drawn)


def test_snow_that_fills_a_hollow_stays(snow, addon):
    points = [(x, y, 0.3 * abs(x)) for x in (-0.5, 0.0, 0.5) for y in (-2.0, 2.0)]
    uv = [(u, v) for left in (0.0, 0.5) for u, v in ((left, 0), (left + 0.5, 0), (left + 0.5, 1), (left, 1))]
    trough = s.mesh_object("Trough", points, [(0, 2, 3, 1), (2, 4, 5, 3)], uv)
    x = np.abs((np.arange(SIZE) + 0.5) / SIZE - 0.5)
    level = 0.3 * (0.5 - x) * np.hypot(1.0, 0.3)
    shell = snow(trough, np.repeat(level[None, :], SIZE, axis=0))
    plain, drawn = (with_slider(addon, shell, "Shoulders", strength).points for strength in (0.0, 1.0))
    inside = (np.abs(plain[:, 1]) < 1.5) & (np.abs(plain[:, 0]) > 0.1)
    assert np.abs(plain[inside] - drawn[inside]).max() < 0.005


def test_the_edge_of_a_sheet_is_a_rim_where_it_is_shaded_flat(snow, addon):
    reach = {}
    for smooth in (False, True):
        sheet = s.square(f"Sheet {smooth}", 1.0)
        sheet.data.polygons.foreach_set("use_smooth", [smooth] * len(sheet.data.polygons))
        shell = snow(sheet, heap())
        plain, drawn = (with_slider(addon, shell, "Shoulders", strength).points for strength in (0.0, 1.0))
        reach[smooth] = np.abs(drawn - plain).max()
    # Fronts are smoothed all the same.
    assert reach[True] < 0.1 * DEPTH
    assert reach[False] > 0.2 * DEPTH


# -- cushions ----------------------------------------------------------------------------------------------

NEEDLE = 0.001
GAP = 0.002
SNOW = 0.0005


def needles(count=80, length=0.02, far_one=False):
    """Square prisms along y, side by side along x; snow on their tops only. far_one: and one that stands alone."""
    starts = [i * (NEEDLE + GAP) for i in range(count)] + ([1.0] if far_one else [])
    points, faces, uv = [], [], []
    box = [(0, 1, 2, 3), (7, 6, 5, 4), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)]
    for x in starts:
        first = len(points)
        for z in (0.0, -NEEDLE):
            points += [(x, 0, z), (x + NEEDLE, 0, z), (x + NEEDLE, length, z), (x, length, z)]
        for index, face in enumerate(box):
            faces.append(tuple(first + corner for corner in face))
            uv += (
                [(0, 0.75), (1, 0.75), (1, 1), (0, 1)]
                if index == 0
                else [(0, 0), (1, 0), (1, 0.25), (0, 0.25)]
            )
    return s.mesh_object("Needles", points, faces, uv)


def on_tops():
    height = np.zeros((SIZE, SIZE), dtype=np.float32)
    height[SIZE // 2 :] = SNOW
    return height


def between_needles(points):
    """The points over the middle of the gaps."""
    x = np.mod(points[:, 0], NEEDLE + GAP)
    inside = (points[:, 0] > 0.01) & (points[:, 0] < 0.2) & (points[:, 1] > 0.005) & (points[:, 1] < 0.015)
    return points[inside & (np.abs(x - NEEDLE - 0.5 * GAP) < 0.3 * GAP)]


def test_snow_bridges_needles_by_default(snow, addon):
    shell = snow(needles(), on_tops(), depth=0.012)
    bridged = between_needles(Geometry(shell).points)
    assert len(bridged) > 100
    assert bridged[:, 2].max() > SNOW
    assert len(between_needles(with_slider(addon, shell, "Cushions", 0.0).points)) == 0


def test_cushions_are_deep_snow_that_has_a_place(snow):
    shell = snow(needles(), on_tops(), depth=0.012)
    geometry = Geometry(shell)
    gaps = np.isin(geometry.points, between_needles(geometry.points)).all(axis=1)
    assert geometry.height[gaps].min() >= 0.02 - 1e-6
    assert np.abs(geometry.place[gaps] - geometry.points[gaps]).max() < 0.02


def test_a_lone_needle_gets_no_cushion(snow):
    points = Geometry(snow(needles(far_one=True), on_tops(), depth=0.012)).points
    lone = points[points[:, 0] > 0.9]
    assert len(lone) > 0
    assert lone[:, 2].max() < 2.0 * SNOW


def test_cushions_grow_with_the_snow_and_begin_with_it(snow, addon, tmp_path):
    shell = snow(needles(), on_tops(), depth=0.012)
    tree = shell.modifiers[0].node_group
    (curve,) = addon("compat").curves_of(tree)
    assert [tuple(key.co) for key in curve.keyframe_points] == [(1.0, pytest.approx(0.012))]
    # Wherever the grids of their volumes happen to lie: each amount has others.
    cushions = [
        between_needles(with_slider(addon, shell, "Cushions", amount).points)
        for amount in (0.5, 0.6, 0.7, 0.85, 1.0, 1.4)
    ]
    assert min(map(len, cushions)) > 100
    assert np.diff([points[:, 2].max() for points in cushions]).min() > 0.0


def test_cushions_are_off_where_nothing_is_like_needles(snow, addon):
    shell = snow(table(), heap(), depth=DEPTH)
    assert addon("compat_nodes").modifier_input(shell.modifiers[0], "Cushions") == 0.0


def test_cushions_are_off_where_they_would_be_too_heavy_and_it_is_said(snow, addon, monkeypatch):
    monkeypatch.setattr(addon("result.cushion_nodes"), "MOST_POINTS", 100)
    shell = snow(needles(), on_tops(), depth=0.012)
    assert addon("compat_nodes").modifier_input(shell.modifiers[0], "Cushions") == 0.0
    (receiver,) = bpy.context.scene.snowbough.receivers
    (note,) = addon("result.displacement").refresh(bpy.context.scene, receiver)
    assert note.startswith("Needles has needles, but snow does not bridge them")


def test_a_heavy_mesh_without_needles_gives_no_note(snow, addon, monkeypatch):
    monkeypatch.setattr(addon("result.cushion_nodes"), "MOST_POINTS", 100)
    snow(table(), heap(), depth=DEPTH)
    (receiver,) = bpy.context.scene.snowbough.receivers
    assert addon("result.displacement").refresh(bpy.context.scene, receiver) == []


# -- sliders -----------------------------------------------------------------------------------------------


def snow_inputs(addon, shell):
    (node,) = addon("result.look").group_nodes(shell.material_slots[0].material)
    return node.inputs


def rebuilt(addon):
    (receiver,) = bpy.context.scene.snowbough.receivers
    addon("result.displacement").refresh(bpy.context.scene, receiver)
    return addon("result.snow_shell").find(receiver)[0]


def test_sliders_outlive_the_shell(snow, addon):
    shell = snow(needles(), on_tops(), depth=0.012)
    values = {"Shoulders": 0.25, "Relief": 2.5, "Cushions": 0.75}
    for name, value in values.items():
        set_slider(addon, shell, name, value)
    snow_inputs(addon, shell)["Grain"].default_value = 2.0
    snow_inputs(addon, shell)["Color"].default_value = (0.5, 0.25, 0.125, 1.0)
    for _ in range(2):  # and the shell after that one, too
        shell = rebuilt(addon)
        read = {name: addon("compat_nodes").modifier_input(shell.modifiers[0], name) for name in values}
        assert read == values
        assert snow_inputs(addon, shell)["Grain"].default_value == 2.0
        assert tuple(snow_inputs(addon, shell)["Color"].default_value) == (0.5, 0.25, 0.125, 1.0)


def test_what_nobody_has_touched_is_chosen_anew(snow, addon, monkeypatch):
    monkeypatch.setattr(addon("result.cushion_nodes"), "MOST_POINTS", 100)
    shell = snow(needles(), on_tops(), depth=0.012)
    assert addon("compat_nodes").modifier_input(shell.modifiers[0], "Cushions") == 0.0
    monkeypatch.undo()
    shell = rebuilt(addon)
    assert addon("compat_nodes").modifier_input(shell.modifiers[0], "Cushions") == 1.0
    assert addon("compat_nodes").modifier_input(shell.modifiers[0], "Relief") == 0.0  # the fixture's own


@pytest.mark.parametrize(
    "count, width, length, depth, expected",
    [
        (60, 0.001, 0.012, 0.012, True),
        (40, 0.001, 0.012, 0.012, False),  # too few
        (60, 0.008, 0.012, 0.100, False),  # leaves
        (60, 0.010, 0.120, 0.012, False),  # twigs, thick beside the snow
    ],
)
def test_needles_are_many_long_and_thin_pieces(addon, count, width, length, depth, expected):
    corners = np.array([(x, y, z) for x in (0, width) for y in (0, length) for z in (0, width)])
    positions = np.concatenate([corners + (0.1 * i, 0, 0) for i in range(count)])
    along = np.array(
        [(0, 1), (2, 3), (4, 5), (6, 7), (0, 2), (1, 3), (4, 6), (5, 7), (0, 4), (1, 5), (2, 6), (3, 7)]
    )
    edges = np.concatenate([along + 8 * i for i in range(count)])
    assert addon("result.cushion_nodes").are_needles(positions, edges, depth) == expected
