# SPDX-License-Identifier: GPL-3.0-or-later
"""Small trees of tubes as OBJ text, with texture coordinates and normals. Z up."""

import numpy as np

SIDES, RINGS = 8, 9
# Root, direction, length, radius at the root, of the trunk, two limbs and a twig.
LIMBS = (
    ((0, 0, 0), (0, 0, 1), 6.0, 0.3),
    ((0, 0, 3), (1, 0, 0.6), 2.4, 0.12),
    ((0, 0, 4), (-1, 0.3, 0.6), 2.0, 0.1),
    ((1.2, 0, 3.72), (0, 1, 0.4), 1.0, 0.04),
)


def _across(direction):
    side = np.cross(direction, (0.0, 1.0, 0.0) if abs(direction[1]) < 0.9 else (1.0, 0.0, 0.0))
    side /= np.linalg.norm(side)
    return side, np.cross(direction, side)


def tube(root, direction, length, radius, seam=True):
    """(points, uvs, normals, quads) of a tube that tapers to a fifth. seam: the first and the last corner of a ring
    are two vertices."""
    direction = np.asarray(direction, float) / np.linalg.norm(direction)
    one, other = _across(direction)
    columns = SIDES + 1 if seam else SIDES
    points, uvs, normals, quads = [], [], [], []
    for ring in range(RINGS):
        share = ring / (RINGS - 1)
        for column in range(columns):
            angle = 2 * np.pi * (column % SIDES) / SIDES
            out = np.cos(angle) * one + np.sin(angle) * other
            points.append(root + share * length * direction + radius * (1 - 0.8 * share) * out)
            uvs.append((column / SIDES, share * length))
            normals.append(out)
    for ring in range(RINGS - 1):
        for side in range(SIDES):
            a, b = ring * columns + side, ring * columns + (side + 1) % columns
            quads.append((a, b, b + columns, a + columns))
    return np.array(points), np.array(uvs), np.array(normals), np.array(quads)


def obj_text(limbs=LIMBS, seam=True, groups=("trunk", "branch1", "branch2", "twig1")):
    """The OBJ of a tree, one group for each limb."""
    lines, first = ["mtllib tree.mtl"], 1
    for limb, group in zip(limbs, groups):
        points, uvs, normals, quads = tube(*limb, seam=seam)
        lines += ["v %.6f %.6f %.6f" % tuple(p) for p in points]
        lines += ["vt %.6f %.6f" % tuple(uv) for uv in uvs]
        lines += ["vn %.6f %.6f %.6f" % tuple(n) for n in normals]
        lines += [f"g {group}", "usemtl bark"]
        lines += ["f " + " ".join("/".join([str(first + v)] * 3) for v in quad) for quad in quads]
        first += len(points)
    return "\n".join([*lines, ""])


def short_tubes_text(pieces=6, limbs=LIMBS):
    """The same in one group without names, each limb cut into short tubes of triangles whose end rings coincide, as
    Unity's Tree Creator does."""
    lines, first = [], 1
    for limb in limbs:
        points, _uvs, _normals, quads = tube(*limb)
        columns = SIDES + 1
        cuts = np.linspace(0, RINGS - 1, pieces + 1).astype(int)
        for low, high in zip(cuts, cuts[1:]):
            own = points[low * columns : (high + 1) * columns]
            lines += ["v %.6f %.6f %.6f" % tuple(p) for p in own]
            for a, b, c, d in quads[: (high - low) * SIDES] + first:
                lines += [f"f {a} {b} {c}", f"f {a} {c} {d}"]
            first += len(own)
    return "\n".join([*lines, ""])
