# SPDX-License-Identifier: GPL-3.0-or-later
"""What an engine finds in an exported tree, drawn from the file alone: its levels of detail from the same place, the
finest with the snow of one frame, and that frame's part of the height map. docs/images/engines.png.

    PYTHONPATH=build/python /usr/bin/python3 benchmarks/tree/engine_sheet.py TREE.glb [--out PICTURE.png] [--tile N]

TREE.glb as blend_samples/engine_files.py makes it. Snow is done as the shaders of docs/engines do it: triangles are cut
finer, and what is new moves along the normal by the height at TEXCOORD_1.
"""

import argparse
import sys
from pathlib import Path

import numpy as np
import snowbough_native as native
from PIL import Image, ImageDraw, ImageFont

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "support"))
import glb  # noqa: E402

SIZE = 380
PAPER = (236, 240, 245)
BARK, LEAF, SNOW, GROUND = (0.17, 0.12, 0.09), (0.11, 0.2, 0.04), (0.86, 0.89, 0.93), (0.1, 0.105, 0.115)
# Heights from which on a triangle is drawn as snow, metres.
WHITE_FROM = 0.003
# Where the camera stands, seen from the tree; snow is looked at from above.
LEVEL_VIEW, FROM_ABOVE = (0.35, -0.93, 0.12), (0.35, -0.8, 0.5)


def heights_at(folder, said, tile, uv):
    """(metres at TEXCOORD_1 `uv`, the tile's metres): the atlas is read as a shader does it."""
    atlas = np.asarray(Image.open(folder / said["height"]["uri"])).astype(float) / 65535
    metres = said["height"]["offset"] + said["height"]["scale"] * atlas
    side = said["tile"]
    row, column = divmod(tile, said["columns"])
    part = metres[row * side : (row + 1) * side, column * side : (column + 1) * side]
    at = np.clip(uv * side - 0.5, 0, side - 1)
    low = np.minimum(at.astype(int), side - 2)
    share = at - low
    x, y = low[:, 0], low[:, 1]
    upper = part[y, x] * (1 - share[:, 0]) + part[y, x + 1] * share[:, 0]
    lower = part[y + 1, x] * (1 - share[:, 0]) + part[y + 1, x + 1] * share[:, 0]
    return upper * (1 - share[:, 1]) + lower * share[:, 1], part


def cut(values, triangles, parts):
    """(values, triangles) of triangles cut into parts * parts each; values: arrays of one row a vertex, each."""
    rows = [(i, j) for i in range(parts + 1) for j in range(parts + 1 - i)]
    number = {place: k for k, place in enumerate(rows)}
    weights = np.array([(parts - i - j, i, j) for i, j in rows]) / parts
    small = [(number[i, j], number[i + 1, j], number[i, j + 1]) for i, j in rows if i + j < parts]
    small += [
        (number[i + 1, j], number[i + 1, j + 1], number[i, j + 1]) for i, j in rows if i + j < parts - 1
    ]
    begin = np.arange(len(triangles))[:, None, None] * len(rows)
    finer = [
        np.einsum("rc,tcv->trv", weights, value[triangles]).reshape(-1, value.shape[1]) for value in values
    ]
    return finer, (begin + np.array(small)).reshape(-1, 3).astype(np.int32)


def z_up(points):
    return np.ascontiguousarray(points[:, (0, 2, 1)] * (1, -1, 1), dtype=np.float32)


def add_level(renderer, read, nodes, color, snow=None):
    """Adds a level's primitives; returns how many triangles. snow: (what the file says of it, number of the tile, into
    how many parts an edge is cut)."""
    count = 0
    for node in nodes:
        for number, primitive in enumerate(read.primitives(node)):
            given = read.attributes(primitive)
            place, triangles = (
                given["POSITION"],
                read.array(primitive["indices"]).reshape(-1, 3).astype(np.int32),
            )
            white = np.zeros(len(triangles), bool)
            if snow is not None:
                values = [given[name].astype(float) for name in ("POSITION", "NORMAL", "TEXCOORD_1")]
                (place, normal, uv), triangles = cut(values, triangles, snow[2])
                metres, _ = heights_at(read.folder, snow[0], snow[1], uv)
                place = place + normal * metres[:, None]
                white = np.abs(metres)[triangles].mean(axis=1) > WHITE_FROM
            for chosen, shade in ((~white, color), (white, SNOW)):
                if chosen.any():
                    renderer.add_mesh(f"{node['name']}{number}{shade}", z_up(place), triangles[chosen], shade)
            count += len(read.array(primitive["indices"])) // 3
    return count


def picture(read, parts, level, height, settings, snow=None, view=(2.6, 0.5), side=LEVEL_VIEW):
    """(image, triangles) of a level of all parts. snow: (of all parts what the file says, tile, parts of an edge)."""
    with native.Renderer() as renderer:
        count = 0
        for stem, nodes in parts.items():
            color = LEAF if stem.endswith("_leaves") else BARK
            told = (snow[0][stem], *snow[1:]) if snow is not None and stem in snow[0] else None
            count += add_level(renderer, read, nodes[level : level + 1], color, told)
        g = 30 * height
        ground = [(-g, -g, 0), (g, -g, 0), (g, g, 0), (-g, g, 0)]
        renderer.add_mesh("ground", ground, [(0, 1, 2), (0, 2, 3)], GROUND)
        away, middle = view
        target = np.array((0, 0, middle * height))
        camera = native.Camera(
            eye=target + np.array(side) * away * height,
            target=target,
            width=SIZE,
            height=SIZE,
            field_of_view=0.46,
        )
        rgba = renderer.render(camera, settings)[::-1]
    drawn = rgba[..., 3:] > 127
    return Image.fromarray(np.where(drawn, rgba[..., :3], np.array(PAPER, np.uint8)).astype(np.uint8)), count


def height_picture(read, said, tile):
    _, part = heights_at(read.folder, said, tile, np.zeros((1, 2)))
    shade = np.clip(np.abs(part) / max(np.abs(part).max(), 1e-9), 0, 1) ** 0.45
    return Image.fromarray((shade * 255).astype(np.uint8)).resize((SIZE, SIZE), Image.LANCZOS).convert("RGB")


def sheet(path, tile):
    read = glb.Gltf(path)
    parts = {
        node["name"].removesuffix("_LOD0"): read.lods(node)
        for node in read.json["nodes"]
        if node.get("name", "").endswith("_LOD0")
    }
    bark = next(nodes for stem, nodes in parts.items() if stem.endswith("_bark"))
    height = max(
        read.json["accessors"][p["attributes"]["POSITION"]]["max"][1] for p in read.primitives(bark[0])
    )
    shaded = native.RenderSettings(antialias=True, shadow_resolution=2048)
    wire = native.RenderSettings(wireframe=True)
    cells = []
    for level in range(len(bark)):
        image, count = picture(read, parts, level, height, shaded)
        cells.append((image, f"LOD{level}: {count:,} triangles"))
    close = {stem: nodes for stem, nodes in parts.items() if stem.endswith("_bark")}
    for level in range(len(bark)):
        image, _ = picture(read, close, level, height, wire, view=(0.45, 0.4))
        cells.append((image, f"LOD{level}, bark alone, from near"))
    said = read.json["scenes"][0]["extras"]["snowbough"].get("snow", {})
    if said:
        for level in (0, len(bark) - 1):
            image, _ = picture(read, parts, level, height, shaded, (said, tile, 2), side=FROM_ABOVE)
            cells.append((image, f"LOD{level} with the same map"))
        stem = next(iter(close))
        frame = said[stem]["frames"][tile]
        image, _ = picture(read, close, 0, height, shaded, (said, tile, 4), (0.45, 0.4), FROM_ABOVE)
        cells.append((image, "LOD0, bark alone"))
        cells.append((height_picture(read, said[stem], tile), f"heights of frame {frame}, from the atlas"))
    columns = len(bark)
    whole = Image.new("RGB", (columns * SIZE, (len(cells) + columns - 1) // columns * SIZE), PAPER)
    draw, font = ImageDraw.Draw(whole), ImageFont.load_default()
    for number, (image, text) in enumerate(cells):
        x, y = number % columns * SIZE, number // columns * SIZE
        whole.paste(image, (x, y))
        draw.rectangle((x, y, x + 8 + 6 * len(text), y + 16), fill=PAPER)
        draw.text((x + 4, y + 3), text, fill=(20, 24, 30), font=font)
    return whole


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("tree", type=Path)
    parser.add_argument("--out", type=Path, default=ROOT / "docs" / "images" / "engines.png")
    parser.add_argument("--tile", type=int, default=-1, help="which frame of the atlas, -1: its last")
    arguments = parser.parse_args()
    said = glb.Gltf(arguments.tree).json["scenes"][0]["extras"]["snowbough"].get("snow", {})
    frames = min((len(one["frames"]) for one in said.values()), default=1)
    sheet(arguments.tree, arguments.tile % frames).quantize(96).save(arguments.out, optimize=True)


if __name__ == "__main__":
    main()
