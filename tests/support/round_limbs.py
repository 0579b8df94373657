"""The four-sided base of a tree with round limbs, as the real-time renderer draws it: an independent subdivision."""

import numpy as np
import snowbough_native as native


def _on_limb(sections, points):
    """Points, projected onto the radius of a section each (D. T. Reynolds, PhD thesis, 2014, eq. 3.4.2)."""
    begin, axis, length, near, far, from_hole = np.split(sections, (3, 6, 7, 8, 9), axis=-1)
    along = ((points - begin) * axis).sum(axis=-1, keepdims=True)
    foot = begin + axis * along
    off = points - foot
    radius = near + (far - near) * np.clip(along / length, 0, 1)
    # A branch leaves its hole with the hole's own four corners.
    share = np.where(from_hole > 0, np.clip(along / np.minimum(2 * near, length), 0, 1), 1)
    return points + (foot + off * radius / np.linalg.norm(off, axis=-1, keepdims=True) - points) * share


def _rounded(vertices, quads, of_quad, sections):
    """Each vertex at the mean of its projections onto the sections of its quads; caps stay flat."""
    walls = of_quad >= 0
    points = np.zeros_like(vertices)
    count = np.zeros(len(vertices))
    for k in range(4):
        corner = quads[walls, k]
        np.add.at(points, corner, _on_limb(sections[of_quad[walls]], vertices[corner]))
        np.add.at(count, corner, 1)
    return np.where(count[:, None] > 0, points / np.maximum(count, 1)[:, None], vertices)


def round_limbs(base, levels):
    """(vertices (V, 3), quads (F, 4), uvs, radii (V,)) of a native TreeMesh of detail BASE after `levels` subdivisions.

    uvs: [bark, snow], (F, 4, 2) each; the 4^levels parts of a quad are consecutive. radii: of the limb at each vertex.
    """
    arrays = native.tree_arrays(base)
    sections, of_quad = arrays["sections"].astype(float), arrays["section"]
    vertices, quads = np.asarray(base.vertices, float), np.asarray(base.quads)
    uvs = [np.asarray(base.uv_bark), np.asarray(base.uv_snow)]
    vertices = _rounded(vertices, quads, of_quad, sections)
    for _ in range(levels):
        ends = np.sort(np.stack([quads, np.roll(quads, -1, axis=1)], axis=-1), axis=-1)
        edges, edge = np.unique(ends.reshape(-1, 2), axis=0, return_inverse=True)
        edge = edge.reshape(-1, 4) + len(vertices)
        centre = len(vertices) + len(edges) + np.arange(len(quads))
        vertices = np.concatenate([vertices, vertices[edges].mean(axis=1), vertices[quads].mean(axis=1)])
        parts = np.empty((len(quads), 4, 4), int)
        finer = [np.empty((len(quads), 4, 4, 2), np.float32) for _ in uvs]
        for k in range(4):
            at = [(k + i) % 4 for i in range(4)]
            parts[:, k, at] = np.stack([quads[:, k], edge[:, k], centre, edge[:, k - 1]], axis=1)
            for uv, part in zip(uvs, finer):
                sides = [uv[:, k], uv[:, [k, at[1]]].mean(1), uv.mean(1), uv[:, [k, k - 1]].mean(1)]
                part[:, k, at] = np.stack(sides, axis=1)
        quads, of_quad = parts.reshape(-1, 4), np.repeat(of_quad, 4)
        uvs = [part.reshape(-1, 4, 2) for part in finer]
        vertices = _rounded(vertices, quads, of_quad, sections)
    radii = np.ones(len(vertices))
    radii[quads] = sections[of_quad, 7][:, None]
    return vertices, quads, uvs, radii
