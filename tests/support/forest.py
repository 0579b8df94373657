# SPDX-License-Identifier: GPL-3.0-or-later
"""A large tree as a file."""

import numpy as np


def write_forest(path, limbs, rings):
    """A thick trunk and `limbs` tubes of four-sided rings out of it, all round; relative indices."""
    ring = np.array([(1, 0), (0, 1), (-1, 0), (0, -1)])
    rows, corners = np.arange(rings - 1), np.arange(4)
    first = 4 * rows[:, None] - 4 * rings
    faces = np.stack([first + corners, first + (corners + 1) % 4, first + (corners + 1) % 4 + 4,
                      first + corners + 4], axis=-1)  # fmt: skip
    faces = "".join("f %d %d %d %d\n" % tuple(face) for face in faces.reshape(-1, 4).tolist())
    steps = np.arange(rings)[:, None, None]
    with path.open("w") as file:
        for limb in range(limbs + 1):
            out = np.array((np.cos(2.4 * limb), np.sin(2.4 * limb), 0.0))
            side = np.array((-out[1], out[0], 0.0))
            if limb == 0:
                rise = np.array((0.0, 0.0, 0.011 * limbs / rings))
                points = 0.5 * np.c_[ring, np.zeros(4)] + steps * rise
            else:
                around = 0.02 * (ring[:, :1] * side + ring[:, 1:] * np.array((0.0, 0.0, 1.0)))
                points = around + steps * 0.1 * out + (0.0, 0.0, 0.01 * limb)
            file.write("".join("v %.5f %.5f %.5f\n" % tuple(p) for p in points.reshape(-1, 3).tolist()))
            file.write(faces)
