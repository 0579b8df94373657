#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Composes the demo's contact sheet.

    contact_sheet.py FOLDER      (reads FOLDER/demo.json and frames, writes FOLDER/snowbough.png)

The top row shows the tree from the front in three panels: the raw polygons of the export, the rebuilt centrelines with
their radii, and the rig's bones, coloured by branch level. Below them are the rendered frames and the close-up. Needs
`snowbough_native` on PYTHONPATH to read the tree.
"""

import json
import sys
from pathlib import Path

import numpy as np
import snowbough_native
from PIL import Image, ImageDraw, ImageFont

WIDTH = 2000
MARGIN = 36
GAP = 20
PAPER = (246, 243, 236)
INK = (52, 48, 44)
FAINT = (134, 126, 116)
# Trunk, branches, limbs, twigs and deeper.
LEVEL_COLOURS = ((71, 52, 43), (148, 74, 44), (44, 100, 112), (160, 128, 38), (96, 112, 58), (120, 80, 120))
# Panels are drawn at this scale and then reduced, because PIL does not smooth edges.
OVERSAMPLING = 3
# The panels look down a little, so that horizontal squares show their faces.
PITCH = np.radians(16.0)


def font(size, bold=False):
    name = "DejaVuSans-Bold.ttf" if bold else "DejaVuSans.ttf"
    try:
        return ImageFont.truetype(f"/usr/share/fonts/truetype/dejavu/{name}", size)
    except OSError:
        return ImageFont.load_default()


def read_polygons(path):
    """The export's raw polygons as arrays (n, 3): no groups, no interpretation."""
    vertices, polygons = [], []
    for line in Path(path).read_text(errors="replace").replace("\\\n", " ").splitlines():
        words = line.split()
        if not words:
            continue
        if words[0] == "v":
            vertices.append([float(word) for word in words[1:4]])
        elif words[0] == "f":
            corners = [int(word.split("/")[0]) for word in words[1:]]
            polygons.append([corner - 1 if corner > 0 else len(vertices) + corner for corner in corners])
    vertices = np.array(vertices)
    return [vertices[polygon] for polygon in polygons]


def projected(points):
    """Positions (..., 3) seen from the front (from -Y) and a little above: to the right, and up."""
    points = np.asarray(points)
    return np.stack(
        [points[..., 0], points[..., 2] * np.cos(PITCH) + points[..., 1] * np.sin(PITCH)], axis=-1
    )


class Plate:
    """A white card that shows something seen from the front, fitted to all the points given."""

    def __init__(self, width, height, points):
        self.size = (width, height)
        self.image = Image.new("RGB", (width * OVERSAMPLING, height * OVERSAMPLING), (255, 255, 255))
        self.draw = ImageDraw.Draw(self.image)
        inner = np.array([width, height]) * OVERSAMPLING * 0.9
        seen = projected(points)
        low, high = seen.min(axis=0), seen.max(axis=0)
        self.scale = float((inner / np.maximum(high - low, 1e-9)).min())
        self.middle = (low + high) / 2.0
        self.centre = np.array([width, height]) * OVERSAMPLING / 2.0

    def place(self, point):
        right, up = (projected(point) - self.middle) * self.scale
        return float(self.centre[0] + right), float(self.centre[1] - up)

    def polygon(self, points, fill, outline):
        corners = [self.place(point) for point in points]
        self.draw.polygon(corners, fill=fill)
        self.draw.line([*corners, corners[0]], fill=outline, width=OVERSAMPLING)

    def limb(self, head, tail, head_radius, tail_radius, fill):
        """A tapered stroke with a round end."""
        a, b = np.array(self.place(head)), np.array(self.place(tail))
        first, second = (
            max(radius * self.scale, 0.5 * OVERSAMPLING) for radius in (head_radius, tail_radius)
        )
        way = b - a
        across = np.array([-way[1], way[0]]) / max(np.linalg.norm(way), 1e-9)
        self.draw.polygon(
            [
                tuple(corner)
                for corner in (
                    a + across * first,
                    b + across * second,
                    b - across * second,
                    a - across * first,
                )
            ],
            fill=fill,
        )
        self.draw.ellipse([*(b - second), *(b + second)], fill=fill)

    def bone(self, head, tail, fill):
        """The pointed shape in which Blender draws bones, and a joint at its head."""
        a, b = np.array(self.place(head)), np.array(self.place(tail))
        way = b - a
        length = np.linalg.norm(way)
        across = np.array([-way[1], way[0]]) / max(length, 1e-9)
        half = min(max(0.09 * length, 0.45 * OVERSAMPLING), 5.0 * OVERSAMPLING)
        belly = a + 0.15 * way
        self.draw.polygon(
            [tuple(corner) for corner in (a, belly + across * half, b, belly - across * half)], fill=fill
        )
        dot = min(0.5 * half + 0.3 * OVERSAMPLING, 2.6 * OVERSAMPLING)
        self.draw.ellipse([*(a - dot), *(a + dot)], fill=fill)

    def finished(self):
        return self.image.resize(self.size, Image.LANCZOS)


def raw_plate(polygons, size):
    """The export's polygons, far ones first and paler."""
    plate = Plate(*size, np.concatenate(polygons))
    depths = np.array([polygon[:, 1].mean() for polygon in polygons])
    span = max(np.ptp(depths), 1e-9)
    for index in np.argsort(-depths):
        near = 1.0 - (depths[index] - depths.min()) / span
        tone = tuple(int(190 - (190 - channel) * (0.4 + 0.6 * near)) for channel in INK)
        plate.polygon(polygons[index], fill=tuple(min(255, channel + 80) for channel in tone), outline=tone)
    return plate.finished()


def skeleton_plate(branches, size):
    plate = Plate(*size, np.concatenate([np.asarray(branch.points) for branch in branches]))
    for branch in sorted(branches, key=lambda branch: -branch.level):
        colour = LEVEL_COLOURS[min(branch.level, len(LEVEL_COLOURS) - 1)]
        points, radii = np.asarray(branch.points), np.asarray(branch.radii)
        for step in range(len(points) - 1):
            plate.limb(points[step], points[step + 1], radii[step], radii[step + 1], colour)
    return plate.finished()


def rig_plate(bones, levels, size):
    plate = Plate(*size, np.array([end for head, tail, _ in bones for end in (head, tail)]))
    for head, tail, name in sorted(bones, key=lambda bone: -levels.get(bone[2], 0)):
        plate.bone(head, tail, LEVEL_COLOURS[min(levels.get(name, 0), len(LEVEL_COLOURS) - 1)])
    return plate.finished()


def put(sheet, image, at, title, caption):
    """Pastes an image with a title and a caption under it; returns the height it took."""
    draw = ImageDraw.Draw(sheet)
    sheet.paste(image, at)
    below = at[1] + image.height + 8
    draw.text((at[0], below), title, font=font(21, bold=True), fill=INK)
    offset = draw.textlength(title, font=font(21, bold=True)) + 14
    draw.text((at[0] + offset, below + 2), caption, font=font(18), fill=FAINT)
    return image.height + 44


def compose(folder):
    """Writes FOLDER/snowbough.png and returns its path."""
    demo = json.loads((folder / "demo.json").read_text())
    skeleton = snowbough_native.read_tree(demo["tree"])
    branches = skeleton.branches
    polygons = read_polygons(demo["tree"])
    if skeleton.report["up_axis"] == "Y":
        polygons = [np.stack([polygon[:, 0], -polygon[:, 2], polygon[:, 1]], axis=1) for polygon in polygons]
    levels = {branch.name.rstrip("0123456789"): branch.level for branch in branches}

    inside = WIDTH - 2 * MARGIN
    column = (inside - 2 * GAP) // 3
    plate_size = (column, 620)
    frames = [Image.open(folder / f"frame_{frame:04d}.png").convert("RGB") for frame in demo["frames"]]
    captions = [
        (f"Frame {frame}", f"{100.0 * depth:.1f} cm on open ground")
        for frame, depth in zip(demo["frames"], demo["depths"])
    ]
    frames.append(Image.open(folder / "close_up.png").convert("RGB"))
    captions.append((f"Frame {demo['frames'][-1]}", "a fork from close by"))
    frame_size = (column, round(column * frames[0].height / frames[0].width))
    height = MARGIN + 74 + plate_size[1] + 44 + 2 * (frame_size[1] + 44) + MARGIN - 8
    sheet = Image.new("RGB", (WIDTH, height), PAPER)
    draw = ImageDraw.Draw(sheet)
    draw.text((MARGIN, MARGIN - 8), "Snowbough", font=font(40, bold=True), fill=INK)
    draw.text(
        (MARGIN + 280, MARGIN + 9),
        f"{Path(demo['tree']).name}: from the export to a snowy shot of {demo['last_frame']} frames, "
        f"{demo['receivers']} objects with snow maps of up to {demo['resolution']} x {demo['resolution']}",
        font=font(22),
        fill=FAINT,
    )

    top = MARGIN + 62
    count = len(branches)
    plates = (
        (
            raw_plate(polygons, plate_size),
            "As exported",
            f"{len(polygons)} polygons, {skeleton.report['form'].lower().replace('_', ' ')}",
        ),
        (
            skeleton_plate(branches, plate_size),
            "Found in it",
            f"{count} branches on {len(set(branch.level for branch in branches))} levels",
        ),
        (
            rig_plate(demo["bones"], levels, plate_size),
            "The rig",
            f"{len(demo['bones'])} bones under one skin of {demo['faces']} quads",
        ),
    )
    for index, (image, title, caption) in enumerate(plates):
        taken = put(sheet, image, (MARGIN + index * (column + GAP), top), title, caption)
    top += taken + 8
    for index, (image, (title, caption)) in enumerate(zip(frames, captions)):
        place = (MARGIN + index % 3 * (column + GAP), top + index // 3 * (frame_size[1] + 48))
        put(sheet, image.resize(frame_size, Image.LANCZOS), place, title, caption)
    target = folder / "snowbough.png"
    sheet.save(target)
    return target


if __name__ == "__main__":
    print(f"demo: {compose(Path(sys.argv[1]))}")
