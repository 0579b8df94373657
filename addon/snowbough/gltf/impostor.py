# SPDX-License-Identifier: GPL-3.0-or-later
"""The last level of detail: pictures of the tree on crossed cards, drawn by the real-time renderer. No ``bpy``.

Each of four upright cards through the tree's foot has a picture on either side. The pictures contain the colours of
the materials without light, so that an engine lights them; the normals bulge as those of a round crown.
"""

import numpy as np

from ..base import native
from . import texels
from .tree_data import SNOW_COLOR, Cards
from .triangle_mesh import unit

VIEWS = 8
# Pictures per row of the texture, and side of a picture in texels.
COLUMNS, TILE = 4, 256
SAMPLES = 4
# Margin around the tree, as a share of a card; and part of the height that is the foot.
MARGIN, FOOT = 0.02, 0.03


def _frame(points):
    """(middle (3,), half width, half height) of the cards. They cross above the foot, where all pictures of the trunk
    meet."""
    low, high = points.min(axis=0), points.max(axis=0)
    middle = (low + high) / 2
    foot = points[points[:, 2] < low[2] + FOOT * (high[2] - low[2])]
    middle[:2] = foot[:, :2].mean(axis=0)
    across = np.linalg.norm((points - middle)[:, :2], axis=1).max()
    return middle, across * (1 + MARGIN), (high[2] - low[2]) / 2 * (1 + MARGIN)


def _camera(module, direction, middle, half_width, half_height):
    """An orthographic camera that looks at the tree against `direction` (3,), which is horizontal."""
    right = np.array((-direction[1], direction[0], 0.0))
    view = np.eye(4)
    view[:3, :3] = right, (0.0, 0.0, 1.0), direction
    view[:3, 3] = -view[:3, :3] @ (middle + direction * 2 * half_width)
    projection = np.diag((1 / half_width, 1 / half_height, -1 / (2 * half_width), 1.0))
    projection[2, 3] = -1.0
    return module.Camera(view=view, projection=projection, width=TILE, height=TILE)


def with_kept_area(alpha):
    """alpha (H, W) scaled so that a cutoff of one half keeps as much area as the alpha covers; thin twigs would vanish
    otherwise.

    Source: I. Castano, Computing Alpha Mipmaps, 2010.
    """
    covered = int(round(float(alpha.sum())))
    if not 0 < covered < alpha.size:
        return alpha
    least = np.partition(alpha.reshape(-1), alpha.size - covered)[alpha.size - covered]
    return np.clip(alpha * (0.5 / max(float(least), 1.0 / 255.0)), 0.0, 1.0)


def _uvs(surface, materials):
    """float32 (T, 3, 2): the coordinates at which each triangle's texture is sampled."""
    uvs = np.zeros((*surface.triangles.shape, 2), dtype=np.float32)
    for number, material in enumerate(materials):
        if material.base is not None:
            chosen = surface.material == number
            uv = surface.corner_uvs[material.base.texcoord][surface.triangles[chosen]]
            uvs[chosen] = uv * np.float32(material.base.scale) + np.float32(material.base.offset)
    return uvs


def _add_parts(renderer, parts, snow_meshes):
    """parts: [(TriangleMesh, [Material], [their textures' pixels or None])]; snow_meshes: [SnowMesh]."""
    for number, (surface, materials, images) in enumerate(parts):
        renderer.add_mesh(
            f"part{number}",
            surface.points,
            surface.corner_point[surface.triangles].astype(np.int32),
            uv=_uvs(surface, materials),
            materials=surface.material.astype(np.int32),
            colors=[tuple(map(float, material.color)) for material in materials],
            images=images,
        )
    for number, mesh in enumerate(snow_meshes):
        renderer.add_mesh(f"snow{number}", mesh.points, mesh.triangles.astype(np.int32), color=SNOW_COLOR)


def draw(name, parts, snow_meshes, encode_srgb):
    """The Cards of a tree, without the texture's file, and its pixels (H, W, 4), 0 to 1. Raises RuntimeError if there
    is no OpenGL 4.5. See _add_parts; encode_srgb: linear colours to sRGB."""
    module = native.load()
    points = np.concatenate([surface.points for surface, *_ in parts] + [mesh.points for mesh in snow_meshes])
    middle, half_width, half_height = _frame(points.astype(np.float64))
    light = module.RenderSettings(
        sun_color=(0, 0, 0), sky_color=(1, 1, 1), ground_color=(1, 1, 1), background=(0, 0, 0)
    )
    light.shadow_resolution = 0
    rows = -(-VIEWS // COLUMNS)
    atlas = np.zeros((rows * TILE, COLUMNS * TILE, 4), dtype=np.float32)
    corners, uvs, normals = [], [], []
    with module.Renderer() as renderer:
        _add_parts(renderer, parts, snow_meshes)
        for number in range(VIEWS):
            angle = 2 * np.pi * number / VIEWS
            direction = np.array((np.cos(angle), np.sin(angle), 0.0))
            camera = _camera(module, direction, middle, half_width, half_height)
            left, low = number % COLUMNS, number // COLUMNS
            place = slice(low * TILE, (low + 1) * TILE), slice(left * TILE, (left + 1) * TILE)
            atlas[place] = renderer.render_light(camera, light, SAMPLES)
            right, up = np.array((-direction[1], direction[0], 0.0)), np.array((0.0, 0.0, 1.0))
            for u, v in ((0, 0), (1, 0), (1, 1), (0, 1)):
                away = right * (2 * u - 1) * half_width + up * (2 * v - 1) * half_height
                corners.append(middle + away)
                normals.append(unit(away / half_height + direction + 0.5 * up))
                uvs.append(((left + u) / COLUMNS, (low + v) / rows))
    alpha = with_kept_area(atlas[..., 3])
    # The renderer's colours are multiplied with their share of the pixel.
    color = encode_srgb(atlas[..., :3] / np.maximum(atlas[..., 3:], 1e-6))
    pixels = texels.masked(color, alpha).astype(np.float32) / 255.0
    quads = np.arange(4 * VIEWS).reshape(-1, 4)
    triangles = quads[:, (0, 1, 2, 0, 2, 3)].reshape(-1, 3).astype(np.int32)
    arrays = [np.array(values, dtype=np.float32) for values in (corners, normals, uvs)]
    return Cards(name, *arrays, triangles), pixels
