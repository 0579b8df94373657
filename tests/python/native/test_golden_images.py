"""The native renderer's pictures equal the stored ones (tests/support/golden.py)."""

import sys
from pathlib import Path

import numpy as np
import pytest
import snowbough_native as native
from snow_fall import fallen
from snow_meshes import box, smooth, sphere

TESTS = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(TESTS / "support"))
import golden  # noqa: E402

DEPTH = 0.12
LIGHT = {
    "sun_direction": (-0.6, -0.6, 0.5),
    "sun_color": (2.0, 1.9, 1.8),
    "sky_color": (0.3, 0.4, 0.6),
    "ground_color": (0.1, 0.1, 0.1),
}


def add_snowy_mesh(renderer, mesh, shading, **style):
    positions, triangles, uv = mesh
    height = fallen(mesh, DEPTH)
    surface = native.SnowSurface(triangles, uv, positions, height, height, DEPTH, shading=shading)
    if style:
        surface.set_style(**style)
    begin, corners, _ = surface.faces()
    sides = np.diff(begin)
    fans = [corners[begin[:-1][:, None] + (0, 1, 2)], corners[begin[:-1][sides == 4][:, None] + (0, 2, 3)]]
    renderer.add_mesh("it", positions, triangles, color=(0.4, 0.1, 0.05))
    renderer.add_snow_mesh("snow", surface.points(height, DEPTH), np.concatenate(fans).astype(np.int32))


def picture(renderer, eye, target, light=LIGHT):
    camera = native.Camera(eye=eye, target=target, width=128, height=128, field_of_view=0.7, near=0.1, far=60)
    return renderer.render(camera, native.RenderSettings(**light))[::-1]


def box_picture(**style):
    with native.Renderer() as renderer:
        add_snowy_mesh(renderer, box(), None, **style)
        return picture(renderer, (1.1, -1.8, 1.7), (0, 0, 0.5))


def test_a_snowy_box():
    golden.assert_looks_like("box", box_picture())


def test_a_snowy_ball():
    with native.Renderer() as renderer:
        mesh = sphere(0.5)
        add_snowy_mesh(renderer, mesh, smooth(*mesh[:2]))
        golden.assert_looks_like("ball", picture(renderer, (1.0, -1.7, 1.2), (0, 0, 0)))


def test_a_snowy_tree():
    tree = native.read_tree(TESTS / "data" / "small_maple.obj")
    mesh = native.build_tree_mesh(tree, snow_resolution=512)
    quads, uv = np.asarray(mesh.quads), np.asarray(mesh.uv_snow)
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]).astype(np.int32)
    places = np.concatenate([uv[:, [0, 1, 2]], uv[:, [0, 2, 3]]]).astype(np.float32)
    with native.Renderer() as renderer:
        renderer.add_tree("maple", mesh)
        height = fallen((mesh.vertices.astype(np.float32), triangles, places), DEPTH, "maple", 512)
        renderer.set_snow("maple", height, DEPTH)
        golden.assert_looks_like("maple", picture(renderer, (0.6, -1.5, 2.0), (0, 0, 1.5)))


def test_snow_without_its_overhang_is_noticed():
    with pytest.raises(AssertionError, match="does not look like"):
        golden.assert_looks_like("box", box_picture(overhang=0.0))


def test_darker_snow_is_noticed():
    with native.Renderer() as renderer:
        add_snowy_mesh(renderer, box(), None)
        darker = {**LIGHT, "sky_color": (0.25, 0.35, 0.55)}
        with pytest.raises(AssertionError, match="does not look like"):
            golden.assert_looks_like("box", picture(renderer, (1.1, -1.8, 1.7), (0, 0, 0.5), darker))
