# SPDX-License-Identifier: GPL-3.0-or-later
"""Where all the snow is, frame by frame: a gable roof that is too steep to hold snow sheds it into a yard.

    blender -b --factory-startup --python-exit-code 1 -P benchmarks/snow/ledger.py -- [--depth 0.3] [--frames 16]
        [--pitch 70] [--every 1]

A roof 6 m long with eaves at 2.5 m, 2 m beside its ridge, over a yard of 16 m; a doghouse in the yard is no receiver.
Prints the balance that the bake writes to ledger.json as a table in litres, and its greatest error: fallen + stretched
less all that lies, falls or has left, as a share of all snow.
"""

import argparse
import math
import sys
import tempfile
from pathlib import Path

import bpy

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "addon"), str(ROOT / "build" / "python")]

import snowbough  # noqa: E402
from snowbough.cache.files import LEDGER  # noqa: E402
from snowbough.cache.ledger import COMMON, REMOVED, read_ledger  # noqa: E402

HALF, LENGTH, EAVE, YARD = 2.0, 6.0, 2.5, 16.0


def arguments():
    parser = argparse.ArgumentParser(prog="ledger.py")
    parser.add_argument("--depth", type=float, default=0.3, help="metres of snow")
    parser.add_argument("--frames", type=int, default=16)
    parser.add_argument("--pitch", type=float, default=70.0, help="degrees")
    parser.add_argument("--every", type=int, default=1, help="frames from row to row")
    return parser.parse_args(sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else [])


def mesh(name, points, faces):
    data = bpy.data.meshes.new(name)
    data.from_pydata(points, [], faces)
    made = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(made)
    return made


def build(pitch):
    """(roof, yard)"""
    ridge, end, side = EAVE + HALF * math.tan(math.radians(pitch)), 0.5 * LENGTH, 0.5 * YARD
    corners = [(x, y, EAVE) for x in (-HALF, HALF) for y in (-end, end)] + [(0, -end, ridge), (0, end, ridge)]
    roof = mesh("Roof", corners, [(0, 4, 5, 1), (4, 2, 3, 5)])
    yard = mesh(
        "Yard", [(x * side, y * side, 0) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))], [(0, 1, 2, 3)]
    )
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=(5.0, 0.0, 0.5))
    return roof, yard


def bake(options):
    """The rows of the ledger."""
    bpy.ops.wm.read_homefile(use_empty=True)
    snowbough.register()
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, options.frames
    receivers = build(options.pitch)
    bpy.ops.object.select_all(action="DESELECT")
    for obj in receivers:
        obj.select_set(True)
    bpy.context.view_layer.objects.active = receivers[0]
    bpy.ops.snowbough.add_receivers()
    settings = scene.snowbough
    settings.end_depth, settings.cache_directory = options.depth, tempfile.mkdtemp()
    if bpy.ops.snowbough.bake() != {"FINISHED"}:
        raise SystemExit("ledger: the bake did not finish")
    (found,) = Path(settings.cache_directory).rglob(LEDGER)
    return read_ledger(found.parent)


def error(row):
    lies = row["held"] + sum(row.get(name, 0.0) for name in (*COMMON, *REMOVED))
    return abs(row["fallen"] + row["stretched"] - lies) / max(row["fallen"], 1e-9)


def main():
    options = arguments()
    rows = bake(options)
    names = ("fallen", "stretched", "held", *COMMON)
    print("| frame | depth (cm) | " + " | ".join(f"{name} (l)" for name in names) + " |")
    print("|---" * (len(names) + 2) + "|")
    for row in rows[:: options.every]:
        litres = " | ".join(f"{1000.0 * row[name]:,.1f}" for name in names)
        print(f"| {row['frame']} | {100.0 * row['depth']:.1f} | {litres} |")
    print(f"\ngreatest error on any frame: {max(map(error, rows)):.1e} of all snow", flush=True)


main()
