# SPDX-License-Identifier: GPL-3.0-or-later
"""Composes the frames of windy_shot.py: windy_sheet.py FOLDER writes FOLDER/sheet.png."""

import json
import sys
from pathlib import Path

from contact_sheet import FAINT, INK, PAPER, font
from PIL import Image, ImageDraw

COLUMNS, MARGIN, GAP, CAPTION = 4, 20, 12, 34
FRAME = (440, 275)


def caption(entry):
    towards = "right" if entry["bearing"] < 180.0 else "left"
    wind = f"{entry['angle']:.0f}\N{DEGREE SIGN} to the {towards}" if entry["angle"] >= 1.0 else "calm"
    return f"{100.0 * entry['depth']:.1f} cm, {wind}"


def compose(folder):
    entries = json.loads((folder / "shot.json").read_text())
    rows = -(-len(entries) // COLUMNS)
    width = 2 * MARGIN + COLUMNS * FRAME[0] + (COLUMNS - 1) * GAP
    sheet = Image.new("RGB", (width, 2 * MARGIN + rows * (FRAME[1] + CAPTION + GAP) - GAP), PAPER)
    draw = ImageDraw.Draw(sheet)
    for index, entry in enumerate(entries):
        left = MARGIN + index % COLUMNS * (FRAME[0] + GAP)
        top = MARGIN + index // COLUMNS * (FRAME[1] + CAPTION + GAP)
        image = Image.open(folder / f"frame_{entry['frame']:04d}.png").convert("RGB")
        sheet.paste(image.resize(FRAME, Image.LANCZOS), (left, top))
        title = f"Frame {entry['frame']}"
        draw.text((left, top + FRAME[1] + 6), title, font=font(18, bold=True), fill=INK)
        offset = draw.textlength(title, font=font(18, bold=True)) + 12
        draw.text((left + offset, top + FRAME[1] + 7), caption(entry), font=font(16), fill=FAINT)
    target = folder / "sheet.png"
    sheet.save(target)
    return target


if __name__ == "__main__":
    print(f"shot: {compose(Path(sys.argv[1]))}")
