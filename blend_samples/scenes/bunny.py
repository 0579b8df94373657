# SPDX-License-Identifier: GPL-3.0-or-later
"""The Stanford bunny, an animal of 70,000 scanned triangles without UVs.

    ./tools/sample.sh bunny BUNNY.obj      default: ../shared/data/snow/stanford-bunny.obj

The model is not part of this repository.
"""

from pathlib import Path

import bpy
import sample
from mathutils import Matrix, Vector

HEIGHT = 1.2


def build():
    default = sample.SAMPLES.parent.parent / "shared" / "data" / "snow" / "stanford-bunny.obj"
    path = Path(sample.ARGUMENTS[0]) if sample.ARGUMENTS else default
    bpy.ops.wm.obj_import(filepath=str(path))
    bunny = sample.finish(sample.painted("clay", (0.22, 0.12, 0.07)))
    bunny.data.transform(bunny.matrix_world)
    corners = [Vector(vertex.co) for vertex in bunny.data.vertices]
    low, high = (Vector(map(pick, zip(*corners))) for pick in (min, max))
    middle = Vector(((low.x + high.x) / 2, (low.y + high.y) / 2, low.z))
    bunny.data.transform(Matrix.Scale(HEIGHT / (high.z - low.z), 4) @ Matrix.Translation(-middle))
    bunny.matrix_world = Matrix.Rotation(0.3, 4, "Z")
    return [bunny]


sample.run(build, eye=(0.8, -3.6, 1.5), target=(0.0, 0.0, 0.55), depth=0.08, resolution=1024)
