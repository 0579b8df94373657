#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws docs/images/rooms.svg: the rooms through which a tree and a frame of snow pass, with their lines of code.

    python3 tools/draw_rooms.py                   # draws
    python3 tools/draw_rooms.py --table COMMIT    # prints the lines of all rooms at that commit and now

The rooms and their order are those of the code; tests/python/test_house.py fails if a room is missing here, or if its
lines have changed by a quarter.
"""

import argparse
import html
import io
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
DRAWING = ROOT / "docs" / "images" / "rooms.svg"
SOURCES = {".h", ".cpp", ".py"}
# Rooms in the order in which data passes them, and what they make of it.
PIPELINES = {
    "From an OBJ file to a rigged tree": {
        "native/tree/obj": "file to groups, polygons",
        "native/tree/rings": "polygons to limbs of rings",
        "native/tree/welded": "surfaces that fork to limbs",
        "native/tree/read": "limbs to a tree of branches",
        "native/tree/skeleton": "branches, joints, bones",
        "native/tree/coverage": "how much of the wood they show",
        "native/tree/surface": "bones to a cage of quads",
        "native/tree/crossings": "limbs that newly cross part",
        "native/tree/tubes": "quads onto round limbs",
        "native/tree/collars": "soft forks",
        "native/tree/detail": "levels of detail",
        "native/tree/mesh": "faces, weights",
        "native/tree/uv": "strips for snow",
        "native/tree/original": "UVs of the file's bark",
        "native/tree/leaves": "leaves to their limbs",
        "native/tree/kept": "or the file's own surface, kept",
        "addon/snowbough/tree": "armature, mesh, sway",
        "addon/snowbough/bending": "boughs under snow",
        "addon/snowbough/gltf": "glTF for engines",
        "addon/snowbough/usd": "USD",
    },
    "From a frame to a picture with snow": {
        "addon/snowbough/settings": "properties of the scene",
        "addon/snowbough/scene": "Blender's scene to poses",
        "addon/snowbough/bake": "frames to steps",
        "native/snow/scene": "objects, projection",
        "native/snow/texels": "which surface a texel has",
        "native/snow/seams": "neighbours across seams",
        "native/snow/step": "occlusion, deposit, stability",
        "native/snow/movement": "repose, landing, presses",
        "native/snow/state": "checkpoints",
        "native/snow/output": "smooth maps",
        "native/image": "EXR and PNG",
        "addon/snowbough/cache": "files of a bake",
        "native/snow/surface": "maps to the snow's mesh",
        "addon/snowbough/surface": "its file and style",
        "addon/snowbough/result": "material, modifiers",
        "native/render": "real-time pictures",
        "addon/snowbough/preview": "live preview",
        "addon/snowbough/realtime": "the render engine",
    },
}
# Pixels.
BOX, GAP, ROW, COLUMNS = (196, 52), 26, 86, 5


def lines_of(room, root=ROOT, sources=SOURCES):
    files = (path for path in (root / room).rglob("*") if path.suffix in sources)
    return sum(len(path.read_bytes().splitlines()) for path in files)


def table(commit):
    """The lines of the rooms with a budget (tests/python/test_rooms.py) at a commit and now, in Markdown."""
    sys.path.insert(0, str(ROOT / "tests" / "python"))
    from test_rooms import LINES
    from test_rooms import SOURCES as counted

    archive = subprocess.run(["git", "archive", commit], cwd=ROOT, capture_output=True, check=True).stdout
    rows = ["| room | before | now |", "|---|--:|--:|"]
    with tempfile.TemporaryDirectory() as folder:
        tarfile.open(fileobj=io.BytesIO(archive)).extractall(folder)
        both = {room: [lines_of(room, root, counted) for root in (Path(folder), ROOT)] for room in LINES}
    product = [room for room in LINES if room not in ("tests", "benchmarks")]
    both["product"] = [sum(both[room][k] for room in product) for k in (0, 1)]
    return "\n".join([*rows, *(f"| {room} | {a:,} | {b:,} |" for room, (a, b) in both.items())])


def box(x, y, room, purpose):
    kind = "python" if room.startswith("addon") else "native"
    label = f"{room.removeprefix('addon/snowbough/').removeprefix('native/')} · {lines_of(room):,}"
    return (
        f'<rect class="{kind}" x="{x}" y="{y}" width="{BOX[0]}" height="{BOX[1]}" rx="6"/>'
        f'<text class="name" x="{x + 10}" y="{y + 22}">{html.escape(label, quote=False)}</text>'
        f'<text x="{x + 10}" y="{y + 40}">{html.escape(purpose, quote=False)}</text>'
    )


def arrow(number, top):
    """From a box to the next: to the right, or down to the start of the next row."""
    x = GAP + number % COLUMNS * (BOX[0] + GAP)
    y = top + number // COLUMNS * ROW
    if number % COLUMNS < COLUMNS - 1:
        return f'<path d="M{x + BOX[0]} {y + BOX[1] / 2}h{GAP - 4}"/>'
    middle = y + (ROW + BOX[1]) / 2
    return f'<path d="M{x + BOX[0] / 2} {y + BOX[1]}V{middle}H{GAP + BOX[0] / 2}V{y + ROW - 4}"/>'


def drawing():
    parts, top = [], 20
    for title, rooms in PIPELINES.items():
        parts.append(f'<text class="title" x="{GAP}" y="{top + 16}">{title}</text>')
        top += 34
        for number, (room, purpose) in enumerate(rooms.items()):
            x = GAP + number % COLUMNS * (BOX[0] + GAP)
            parts.append(box(x, top + number // COLUMNS * ROW, room, purpose))
            if number + 1 < len(rooms):
                parts.append(arrow(number, top))
        top += -(-len(rooms) // COLUMNS) * ROW + 6
    note = "Green: C++ in native. Blue: Python in addon/snowbough. Numbers: lines of code."
    parts.append(f'<text x="{GAP}" y="{top + 10}">{note}</text>')
    width, height = GAP + COLUMNS * (BOX[0] + GAP), top + 26
    style = (
        "text{font:12px sans-serif;fill:#222}.name{font-weight:bold}.title{font-size:15px;font-weight:bold}"
        "rect{stroke:#555}.native{fill:#dfeedd}.python{fill:#dce6f5}"
        "path{fill:none;stroke:#555;marker-end:url(#tip)}"
    )
    tip = (
        '<marker id="tip" viewBox="0 0 8 8" refX="6" refY="4" markerWidth="7" markerHeight="7" orient="auto">'
        '<polygon points="0 0 8 4 0 8" fill="#555"/></marker>'
    )
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}">\n'
        f'<style>{style}</style><defs>{tip}</defs><rect width="100%" height="100%" fill="#fff" stroke="none"/>\n'
        + "\n".join(parts)
        + "\n</svg>\n"
    )


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--table", metavar="COMMIT")
    options = parser.parse_args()
    if options.table:
        print(table(options.table))
    else:
        DRAWING.write_text(drawing())
        print(DRAWING.relative_to(ROOT))
