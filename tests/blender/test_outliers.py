# SPDX-License-Identifier: GPL-3.0-or-later
"""A single NaN or a distant vertex is reported and affects nothing else."""

import bpy
import numpy as np
import pytest
import snow_scene as s
from realtime_shot import camera_at, rendered, set_up

NOWHERE = [1e30, 3e6, float("nan"), float("inf")]


def add_stray(obj, x):
    """Adds a triangle whose first vertex is at a place that far away."""
    mesh = obj.data
    vertices = [tuple(vertex.co) for vertex in mesh.vertices]
    stray = s.mesh_object(
        "Changed",
        [*vertices, (x, 0, 0)],
        [tuple(polygon.vertices) for polygon in mesh.polygons] + [(len(vertices), 0, 1)],
        [*(tuple(corner.uv) for corner in mesh.uv_layers[0].data), (0.0, 0.0), (0.01, 0.0), (0.0, 0.01)],
    )
    obj.data = stray.data
    bpy.data.objects.remove(stray)


def warned(addon, depsgraph=None):
    return s.warnings(addon, depsgraph)


def automatic_shot(folder):
    s.settings(folder).pixel_size = 0.0


@pytest.mark.parametrize("x", NOWHERE)
def test_a_stray_vertex_of_an_occluder_is_named_and_left_out(addon, native, tmp_path, x):
    ground, roof = s.square("Ground"), s.square("Roof", 1.0, z=1.0)
    s.receive(ground)
    automatic_shot(tmp_path)
    s.bake()
    expected = s.height(native, tmp_path, "Ground", 4)
    add_stray(roof, x)
    (warning,) = warned(addon)
    assert "1 of 5 vertices of 'Roof'" in warning and "number 4" in warning
    s.bake()
    assert np.array_equal(s.height(native, tmp_path, "Ground", 4, version=2), expected)
    assert expected.max() == pytest.approx(0.1, rel=1e-3) and expected.min() == 0.0


@pytest.mark.parametrize("x", NOWHERE)
def test_a_stray_vertex_of_a_receiver_is_named_and_left_out(addon, native, tmp_path, x):
    ground = s.square("Ground")
    s.receive(ground)
    automatic_shot(tmp_path)
    s.bake()
    expected = s.height(native, tmp_path, "Ground", 4)
    add_stray(ground, x)
    (warning,) = [text for text in warned(addon) if "vertices" in text]
    assert "1 of 5 vertices of 'Ground'" in warning
    s.bake()
    assert np.array_equal(s.height(native, tmp_path, "Ground", 4, version=2), expected)


def test_a_receiver_that_flies_away_is_named(tmp_path):
    ground, ball = s.square("Ground"), s.square("Ball")
    s.receive(ground, ball)
    s.settings(tmp_path)
    s.key(ball, "location", (1, (0, 0, 1)), (4, (0, 0, 1e8)))
    with pytest.raises(RuntimeError, match="'Ball' is beyond 1e\\+06 m at frame 2"):
        s.bake()


@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_a_uv_that_is_no_number_names_its_object(addon, native, tmp_path, value):
    ground, other = s.square("Ground"), s.square("Other", x=3.0)
    s.receive(ground, other)
    automatic_shot(tmp_path)
    other.data.uv_layers[0].data[2].uv = (value, 0.5)
    texts = [
        issue.text
        for issue in addon("bake.preflight").check(bpy.context.scene, bpy.context.evaluated_depsgraph_get())
    ]
    assert any("of 'Other's UV map 'snow' is outside 0 to 1" in text for text in texts)
    s.bake()  # the others are baked
    assert s.height(native, tmp_path, "Ground", 4).max() == pytest.approx(0.1, rel=1e-3)
    bpy.context.scene.snowbough.receivers[0].enabled = False
    with pytest.raises(RuntimeError, match="'Other': 33% of its UV map 'snow' is outside 0 to 1"):
        s.bake()


# -- Snowbough Realtime --------------------------------------------------------------------------------

scene = pytest.fixture(set_up)


@pytest.mark.parametrize("x", NOWHERE)
def test_a_stray_vertex_leaves_the_picture_as_it_was(scene, capfd, x):
    square = s.square("Square", 2.0)
    s.square("Ground", 8.0, z=-1.0)
    camera_at((2, -4, 5))
    expected = rendered(scene)
    add_stray(square, x)
    assert np.array_equal(rendered(scene), expected)
    assert "not rendered: Square" in capfd.readouterr().out


def test_an_object_that_is_nowhere_leaves_the_picture_as_it_was(scene, capfd):
    s.square("Ground", 8.0)
    camera_at((2, -4, 5))
    expected = rendered(scene)
    s.square("Square").location.x = 1e30
    assert np.array_equal(rendered(scene), expected)
    assert "not rendered: Square" in capfd.readouterr().out
