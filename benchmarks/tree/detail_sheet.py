# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of a tree's forks at each level of detail, beside the export's own polygons.

    blender -b --factory-startup --python-exit-code 1 -P benchmarks/tree/detail_sheet.py -- FILE.obj [FOLDER]

Writes FOLDER/<file>_detail.png (default build/detail). One row per fork: the thickest limb on the trunk, the thickest
twig on a limb, and the place where most limbs leave a parent close together. Four columns in the same light: the
export, DRAFT, DEFAULT and FILM, all rebuilt meshes shaded smooth.
"""

import sys
from pathlib import Path

import bpy
import numpy as np

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(Path(__file__).resolve().parent))
import junctions  # noqa: E402
import sheets  # noqa: E402

DETAILS = ("DRAFT", "DEFAULT", "FILM")
SIZE = 480


def import_columns(path, native):
    """[objects of a column, ...]: export, then each level of detail; and the skeleton's branches."""
    export, skeleton = sheets.import_export(path, native)
    columns = [export]
    for detail in DETAILS:
        mesh = native.build_tree_mesh(skeleton, detail=detail)
        columns.append([sheets.add_mesh(detail, mesh.vertices, mesh.quads)])
    return columns, skeleton.branches


def main(path, folder):
    sys.path.insert(0, str(ROOT / "build" / "python"))
    import snowbough_native as native

    bpy.ops.wm.read_homefile(use_empty=True)
    scene = bpy.context.scene
    junctions.SIZE = SIZE
    camera = junctions.set_up(scene)
    columns, branches = import_columns(path, native)
    bark = junctions.clay("bark", (0.42, 0.36, 0.3))
    for objects in columns:
        for obj in objects:
            obj.data.materials.clear()
            obj.data.materials.append(bark)
    folder.mkdir(parents=True, exist_ok=True)
    forks = junctions.choose(branches)
    sheet = np.ones((SIZE * len(forks), SIZE * len(columns), 4), np.float32)
    for row, (child, frame) in enumerate(forks):
        print(f"fork {row + 1}: {child.name} on {branches[child.parent].name}, radius {frame[2]:.4g}")
        junctions.look_at(camera, child, frame)
        for column, objects in enumerate(columns):
            sheets.show_only(objects)
            low = SIZE * (len(forks) - 1 - row)
            part = junctions.picture(scene, folder / "part.png")
            sheet[low : low + SIZE, SIZE * column : SIZE * (column + 1)] = part
    sheets.save_sheet(sheet, folder / f"{path.stem}_detail.png")


if __name__ == "__main__":
    given = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    if not given:
        sys.exit(__doc__)
    main(Path(given[0]).resolve(), Path(given[1] if len(given) > 1 else ROOT / "build" / "detail").resolve())
