"""Snow in the real-time renderer: no cracks at seams and rims, levels against NumPy, one look that stays put."""

import math

import numpy as np
import pytest
import snowbough_native as native
from snow_meshes import box, cylinder, grid
from test_renderer import closed

#: Everything is in the picture, nothing is too small for it, and nothing shades.
CAMERA = {"eye": (2.2, -2.6, 1.8), "target": (0, 0, 0.3), "field_of_view": 0.7, "width": 300, "height": 300}
WHOLE = {"min_pixels": 0, "shadow_resolution": 0}


def torus(radius=0.6, tube=0.25, around=24, across=12):
    """A closed ring whose map is one chart with two seams; a vertex on a seam has up to four places on it."""
    places, triangles, uv = [], [], []
    for i in range(around):
        for j in range(across):
            t, s = 2 * np.pi * i / around, 2 * np.pi * j / across
            out = radius + tube * np.cos(s)
            places.append((out * np.cos(t), out * np.sin(t), tube * np.sin(s)))
            q = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
            v = [(a % around) * across + b % across for a, b in q]
            w = [(0.03 + 0.94 * a / around, 0.03 + 0.94 * b / across) for a, b in q]
            triangles += [(v[0], v[1], v[2]), (v[0], v[2], v[3])]
            uv += [(w[0], w[1], w[2]), (w[0], w[2], w[3])]
    return np.array(places, np.float32), np.array(triangles, np.int32), np.array(uv, np.float32)


def flat_normals(positions, triangles):
    corners = positions[triangles]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return np.repeat((across / np.linalg.norm(across, axis=1)[:, None])[:, None], 3, axis=1)


def lumps(size=128, depth=0.1, signed=False):
    """Heights that have nothing to do with the layout: what two sides of a seam show differs everywhere."""
    random = np.random.default_rng(7).random((size, size))
    wide = sum(np.roll(random, (i, j), (0, 1)) for i in range(5) for j in range(5)) / 25
    return ((wide - (0.5 if signed else 0.0)) * depth).astype(np.float32)


@pytest.fixture
def renderer():
    with native.Renderer() as made:
        yield made


def add(renderer, mesh, height=None, normals=None, **options):
    renderer.add_snow_mesh("it", *mesh, normals=normals, **options)
    if height is not None:
        renderer.set_snow("it", height)


CLOSED = {
    "ring": (torus(), False),
    "box": (box(), True),
    "smooth box": (box(), False),
    "cylinder": (cylinder(0.5, 1.2), True),
}


@pytest.mark.parametrize("name", CLOSED)
@pytest.mark.parametrize("metric", ["SCREEN", "THESIS"])
@pytest.mark.parametrize("signed", [False, True])
def test_a_closed_receiver_is_closed_to_the_bit(renderer, name, metric, signed):
    mesh, is_flat = CLOSED[name]
    add(renderer, mesh, lumps(signed=signed), flat_normals(*mesh[:2]) if is_flat else None)
    settings = native.RenderSettings(metric=metric, snow_factor=400, target_pixels=9, **WHOLE)
    camera = native.Camera(**{**CAMERA, "field_of_view": 1.2})
    found = renderer.triangles("it", camera, settings)
    assert len(found) > 2000
    assert closed(found)
    assert not closed(np.delete(found, 100, axis=0))


def test_plain_and_tessellated_patches_meet_without_a_crack(renderer):
    height = lumps()
    height[:, 40:] = 0
    add(renderer, torus(), height)
    found = renderer.triangles("it", native.Camera(**CAMERA), native.RenderSettings(**WHOLE))
    renderer.render(native.Camera(**CAMERA), native.RenderSettings(**WHOLE))
    counts = renderer.statistics()
    assert counts["plain"] > 50 and counts["tessellated"] > 50 and counts["dropped"] == 0
    assert closed(found)


@pytest.mark.parametrize("name", CLOSED)
@pytest.mark.parametrize("direction", [(1, 0, 0), (0, 1, 0), (-1, 0.2, 0.5), (0.01, 0, 1), (0.01, 0, -1)])
def test_no_background_shows_from_inside_of_a_closed_receiver(renderer, name, direction):
    mesh, is_flat = CLOSED[name]
    add(renderer, mesh, lumps(), flat_normals(*mesh[:2]) if is_flat else None)
    eye = np.array((0.6, 0.02, 0.01) if name == "ring" else (0.02, 0.01, 0.5 if "box" in name else 0.02))
    camera = native.Camera(
        eye=eye,
        target=eye + direction,
        up=(0, 0, 1) if abs(direction[2]) < 0.9 else (0, 1, 0),
        field_of_view=1.6,
        width=200,
        height=200,
        near=1e-4,
        far=100,
    )
    picture = renderer.render(camera, native.RenderSettings(**WHOLE))
    assert renderer.statistics()["tessellated"] > 5
    assert (picture[..., 3] == 255).all()
