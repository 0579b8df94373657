# SPDX-License-Identifier: GPL-3.0-or-later
"""An exported tree as an engine shows it, drawn from the file alone with the shaders of docs/engines.

    /usr/bin/python3 benchmarks/tree/engine_sheet.py TREE.glb [--out PICTURE.png] [--frame N]

The picture, docs/images/engines.png, shows the levels of detail from the same place, their bark from near, the finest
and the coarsest level under the same snow, and that frame's part of the height map. blend_samples/engine_files.py makes
TREE.glb. Needs moderngl (package python3-moderngl).
"""

import argparse
import sys
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "support"))
import glb  # noqa: E402
from engine_view import EngineView  # noqa: E402

# Side of a picture in pixels; it is drawn at twice that.
SIZE = 380
PAPER = (0.3, 0.36, 0.42, 0.0)
# From the target to the camera, in heights of the tree; the target's own height.
WHOLE, NEAR = ((0.72, 0.5, 2.1), 0.5), ((0.16, 0.12, 0.42), 0.42)


class Sheet:
    """The pictures of one file."""

    def __init__(self, path):
        self.read = glb.Gltf(path)
        self.said = self.read.json["scenes"][0]["extras"]["snowbough"]
        self.snow = self.said.get("snow", {})
        self.parts = {
            # Without the cards, which have no skin.
            node["name"].removesuffix("_LOD0"): [level for level in self.read.lods(node) if "skin" in level]
            for node in self.read.json["nodes"]
            if node.get("name", "").endswith("_LOD0")
        }
        self.bark = next(stem for stem in self.parts if stem.endswith("_bark"))
        self.height = max(places[:, 1].max() for places in self.read.skinned(self.parts[self.bark][0]))
        self.view = EngineView(2 * SIZE)
        # Sunlit snow stays below white.
        self.view.light(sun=0.75, sky=(0.24, 0.28, 0.34), ground=(0.06, 0.06, 0.06))

    def triangles(self, level):
        nodes = [levels[level] for levels in self.parts.values()]
        return sum(
            len(self.read.array(p["indices"])) // 3 for node in nodes for p in self.read.primitives(node)
        )

    def picture(self, level, place, frame=None, stems=None, **how):
        """(image, triangles that were drawn). frame: number in the atlas, None: no snow."""
        side, middle = place
        target = np.array((0.0, middle * self.height, 0.0))
        self.view.clear(PAPER)
        self.view.look(
            target + np.array(side) * self.height, target, levels=self.said["branch_levels"], **how
        )
        for stem, levels in self.parts.items():
            if stems is None or stem in stems:
                self.view.snow(
                    self.snow.get(stem) if frame is not None else None, self.read.folder, frame or 0
                )
                self.view.draw(self.read, levels[level])
        rgba = Image.fromarray(self.view.picture()[..., :3])
        return rgba.resize((SIZE, SIZE), Image.BOX), self.view.primitives

    def wire(self, level, place):
        """The bark's triangles as they are in the file."""
        side, middle = place
        target = np.array((0.0, middle * self.height, 0.0))
        self.view.clear()
        self.view.look(target + np.array(side) * self.height, target, highest=1.0)
        self.view.snow()
        self.view.draw(self.read, self.parts[self.bark][level], unseen=True)
        self.view.draw_edges(self.read, self.parts[self.bark][level])
        drawn = self.view.picture()[..., 3] > 0
        return Image.fromarray(np.where(drawn, 30, 255).astype(np.uint8)).resize((SIZE, SIZE), Image.BOX)

    def heights(self, frame):
        """That frame's part of the bark's height map, brightened."""
        said = self.snow[self.bark]
        row, column = divmod(frame, said["columns"])
        side = said["tile"]
        atlas = np.asarray(Image.open(self.read.folder / said["height"]["uri"])).astype(float)
        part = atlas[row * side : (row + 1) * side, column * side : (column + 1) * side]
        metres = said["height"]["offset"] + said["height"]["scale"] * part / 65535
        shade = np.clip(metres / metres.max(), 0, 1) ** 0.45 * 255
        return Image.fromarray(shade.astype(np.uint8)).resize((SIZE, SIZE), Image.LANCZOS)


def cells(sheet, frame):
    """[(image, caption), ...], four per row."""
    count = len(sheet.parts[sheet.bark])
    for level in range(count):
        image, _ = sheet.picture(level, WHOLE, highest=1.0)
        yield image, f"LOD{level}: {sheet.triangles(level):,} triangles"
    for level in range(count):
        yield sheet.wire(level, NEAR), f"LOD{level}, bark alone, from near"
    if not sheet.snow:
        return
    for level in (0, count - 1):
        image, drawn = sheet.picture(level, WHOLE, frame, snow_share=1.0, target_pixels=8.0)
        yield image, f"LOD{level} under the map, cut to {drawn:,}"
    image, drawn = sheet.picture(count - 1, NEAR, frame, {sheet.bark}, snow_share=1.0)
    yield image, f"LOD{count - 1} from near, cut to {drawn:,}"
    said = sheet.snow[sheet.bark]["frames"]
    yield sheet.heights(frame), f"heights of frame {said[frame]}, from the atlas"


def composed(pictures, columns):
    rows = (len(pictures) + columns - 1) // columns
    whole = Image.new("RGB", (columns * SIZE, rows * SIZE), (255, 255, 255))
    draw, font = ImageDraw.Draw(whole), ImageFont.load_default()
    for number, (image, text) in enumerate(pictures):
        x, y = number % columns * SIZE, number // columns * SIZE
        whole.paste(image.convert("RGB"), (x, y))
        draw.rectangle((x, y, x + 8 + 6 * len(text), y + 16), fill=(255, 255, 255))
        draw.text((x + 4, y + 3), text, fill=(20, 24, 30), font=font)
    return whole


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("tree", type=Path)
    parser.add_argument("--out", type=Path, default=ROOT / "docs" / "images" / "engines.png")
    parser.add_argument("--frame", type=int, default=-1, help="number in the atlas, -1: its last")
    arguments = parser.parse_args()
    sheet = Sheet(arguments.tree)
    frames = min((len(one["frames"]) for one in sheet.snow.values()), default=1)
    pictures = list(cells(sheet, arguments.frame % frames))
    whole = composed(pictures, len(sheet.parts[sheet.bark]))
    whole.quantize(64).save(arguments.out, optimize=True)


if __name__ == "__main__":
    main()
