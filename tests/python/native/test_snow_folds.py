# SPDX-License-Identifier: GPL-3.0-or-later
"""The snow surface in narrow hollows, where snow along the normals would grow through that of the other side."""

import numpy as np
import pytest
from shown_snow import faces_of, highest, map_of, shown_over
from snow_meshes import grid, smooth

DEPTH = 0.1
SEED = 3


def rough_ground(cells, step, height):
    """A square of facets whose corners lie at random heights from 0 to `height` metres."""
    positions, triangles, uv = grid(cells * step, cells * step, cells)
    positions[:, 2] = np.random.default_rng(SEED).uniform(0.0, height, len(positions))
    return positions, triangles, uv


@pytest.mark.parametrize("shading", [None, smooth])
@pytest.mark.parametrize("cells, step, height", [(12, 0.06, 0.1), (12, 0.06, 0.16), (8, 0.1, 0.16)])
def test_no_underside_of_snow_is_seen_from_above_on_rough_ground(cells, step, height, shading):
    mesh = rough_ground(cells, step, height)
    snow = map_of(mesh, 256, lambda points, up: DEPTH * up)
    line = np.linspace(-0.35, 0.35, 80) * cells * step
    places = np.stack(np.meshgrid(line, line), axis=2).reshape(-1, 2)
    given = {"shading": shading(*mesh[:2])} if shading else {}
    top, surface = shown_over(mesh, snow, DEPTH, places, **given)
    corners = surface.points(snow, DEPTH)[faces_of(surface)]
    is_up = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2] > 0.0
    top_side = highest(np.concatenate([mesh[0][mesh[1]], corners[is_up]]), places)
    assert (top - top_side > 1e-4).mean() < 0.001, SEED
    bare = highest(mesh[0][mesh[1]], places)
    assert (top - bare).mean() > 0.55 * DEPTH
