# SPDX-License-Identifier: GPL-3.0-or-later
"""Marks a tree as an asset, with a picture that needs no renderer and no window.

Points spread over the faces are drawn into a small depth buffer, lit from above and the left. This is enough to
distinguish trees at the size of an icon.
"""

import numpy as np

SIZE = 256
# Points in the picture.
POINTS = 600_000
# Direction to the light, and to the viewer, who is slightly above.
LIGHT = np.array((-0.5, -0.55, 0.67))
VIEW = np.array((0.35, -0.92, 0.18))
MARGIN = 0.06


def spread(triangles, count):
    """(index of the triangle (N,), barycentric (N, 2)) of about `count` points, evenly spread over the area of
    triangles (T, 3, 3); deterministic."""
    across = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    ends = np.cumsum(np.linalg.norm(across, axis=1))
    if not len(ends) or ends[-1] <= 0.0:
        return np.zeros(0, np.int64), np.zeros((0, 2))
    index = np.searchsorted(ends, (np.arange(count) + 0.5) / count * ends[-1])
    # Roberts' sequence R2, folded into the triangle.
    place = np.outer(np.arange(count), (0.7548776662466927, 0.5698402909980532)) % 1.0
    outside = place.sum(axis=1) > 1.0
    place[outside] = 1.0 - place[outside]
    return np.minimum(index, len(ends) - 1), place


def picture(parts):
    """float32 (SIZE, SIZE, 4), row 0 at the bottom, of [(triangles (T, 3, 3), colours (T, 3)), ...]."""
    image = np.zeros((SIZE, SIZE, 4), dtype=np.float32)
    parts = [(triangles, colours) for triangles, colours in parts if len(triangles)]
    if not parts:
        return image
    view = VIEW / np.linalg.norm(VIEW)
    right = np.cross((0.0, 0.0, 1.0), view)
    right /= np.linalg.norm(right)
    up = np.cross(view, right)
    corners = np.concatenate([triangles.reshape(-1, 3) for triangles, _ in parts])
    flat = np.stack([corners @ right, corners @ up], axis=1)
    low, high = flat.min(axis=0), flat.max(axis=0)
    scale = (1.0 - 2.0 * MARGIN) * SIZE / max(float((high - low).max()), 1e-9)
    middle = (low + high) / 2.0
    pixels, depths, shades = [], [], []
    for triangles, colours in parts:
        index, place = spread(triangles, POINTS // len(parts))
        a, b, c = (triangles[index, k] for k in range(3))
        points = a + (b - a) * place[:, :1] + (c - a) * place[:, 1:]
        normals = np.cross(b - a, c - a)
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
        normals *= np.sign(normals @ view)[:, None]
        light = 0.25 + 0.75 * np.clip(normals @ (LIGHT / np.linalg.norm(LIGHT)), 0.0, None)
        pixels.append(np.stack([points @ right, points @ up], axis=1))
        depths.append(points @ view)
        shades.append(colours[index] * light[:, None])
    at = ((np.concatenate(pixels) - middle) * scale + SIZE / 2).astype(np.int64)
    at = np.clip(at, 0, SIZE - 1)
    # The nearest is written last and remains.
    order = np.argsort(np.concatenate(depths), kind="stable")
    rows = at[order]
    image[rows[:, 1], rows[:, 0], :3] = np.concatenate(shades)[order]
    image[rows[:, 1], rows[:, 0], 3] = 1.0
    # The picture is shown without conversion: from linear light to display values.
    image[..., :3] = np.clip(image[..., :3], 0.0, 1.0) ** (1.0 / 2.2)
    return image


def _colour_of(material):
    """The approximate colour of a material: the mean of its colour texture, or its base colour."""
    if material is None or material.node_tree is None:
        return (0.5, 0.5, 0.5)
    surface = next((node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED"), None)
    if surface is None:
        return (0.5, 0.5, 0.5)
    base = surface.inputs["Base Color"]
    node = base.links[0].from_node if base.is_linked else None
    if node is not None and node.type == "TEX_IMAGE" and node.image is not None and node.image.size[0]:
        pixels = np.empty(len(node.image.pixels), dtype=np.float32)
        node.image.pixels.foreach_get(pixels)
        pixels = pixels.reshape(-1, node.image.channels)
        seen = pixels[pixels[:, 3] > 0.5] if node.image.channels == 4 else pixels
        colour = (seen if len(seen) else pixels).mean(axis=0)
        # The bytes of an image are display values.
        return tuple((np.resize(colour[:3], 3) ** 2.2).tolist())
    if node is not None and node.type == "VALTORGB":
        colours = [element.color[:3] for element in node.color_ramp.elements]
        return tuple(np.mean(colours, axis=0).tolist())
    return tuple(base.default_value[:3])


def _triangles(obj):
    """(triangles (T, 3, 3), colours (T, 3)) of a mesh object at rest."""
    mesh = obj.data
    if hasattr(mesh, "calc_loop_triangles"):
        mesh.calc_loop_triangles()
    count = len(mesh.loop_triangles)
    corners = np.empty(count * 3, dtype=np.int32)
    mesh.loop_triangles.foreach_get("vertices", corners)
    slots = np.empty(count, dtype=np.int32)
    mesh.loop_triangles.foreach_get("material_index", slots)
    points = np.empty(len(mesh.vertices) * 3, dtype=np.float32)
    mesh.vertices.foreach_get("co", points)
    colours = np.array([_colour_of(material) for material in mesh.materials] or [(0.5, 0.5, 0.5)])
    return points.reshape(-1, 3)[corners].reshape(-1, 3, 3), colours[np.minimum(slots, len(colours) - 1)]


def mark_asset(collection, description):
    """Marks the collection as an asset, with a description and a picture of its visible meshes."""
    collection.asset_mark()
    collection.asset_data.description = description
    collection.asset_data.tags.new("tree")
    shown = [obj for obj in collection.objects if obj.type == "MESH" and not obj.hide_render]
    preview = collection.preview_ensure()
    preview.image_size = (SIZE, SIZE)
    preview.image_pixels_float.foreach_set(picture([_triangles(obj) for obj in shown]).reshape(-1))
