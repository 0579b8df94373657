# SPDX-License-Identifier: GPL-3.0-or-later
"""The balance of a bake: where all the snow is that ever fell, frame by frame. No ``bpy``.

``<scene>/v001/ledger.json`` is computed from the manifests of a version's receivers when the last of them is finished,
so machines that share a bake need no common file. In every frame::

    fallen + stretched = held + floor + left + air + masked + pressed + cleared + melted + drifted

The last five, what masks, objects, thaw and wind take away, are there only if there is any; ``drifted`` is below 0
where the wind has brought more than it took.
"""

import math
from pathlib import Path

from .errors import CacheError
from .files import LEDGER, remove_half_written
from .manifest import read_manifest
from .sealed import read_sealed, write_sealed
from .shapes import frame, number

# Of each receiver, in each frame's entry of its manifest: m3 of snow that fell on it, that lies on it, and that it
# gained by stretching. Without landing, what slid off it leaves the scene.
OWN = {"fallen": "fallen", "held": "volume", "stretched": "stretched"}
# Of the whole scene, in the entries of each receiver: m3 on objects that are no receivers, outside the scene, and in
# the air.
COMMON = ("floor", "left", "air")
# Of each receiver, in the entries of those from which masks, objects, thaw or wind have taken snow.
REMOVED = ("masked", "pressed", "cleared", "melted", "drifted")

# Smaller shares are not worth a word.
LEAST = 0.02
LOST = (
    ("floor", "fell on objects that are no receivers"),
    ("left", "fell out of the scene"),
    ("air", "is still falling on the last frame: a longer shot, or Fall Time off, lets it land"),
)

_ROW = {"frame": frame, "depth": number, **dict.fromkeys((*OWN, *COMMON), number)}


def write_ledger(version, keys):
    """Writes the ledger of the folder `version` if the receivers `keys`, all of the shot, are finished there."""
    version = Path(version)
    remove_half_written(version / LEDGER)
    try:
        manifests = [read_manifest(version / key) for key in sorted(keys)]
        if all(manifest is not None and manifest["complete"] for manifest in manifests):
            rows = [_row(entries) for entries in zip(*(manifest["frames"] for manifest in manifests))]
            write_sealed(version / LEDGER, {"frames": rows})
    except KeyError:
        pass


def _row(entries):
    """The balance of a frame, from the entries of all receivers."""
    row = {"frame": entries[0]["frame"], "depth": entries[0]["depth"]}
    for name, stored in OWN.items():
        row[name] = math.fsum(entry[stored] for entry in entries)
    if "air" in entries[0]:
        row.update({name: entries[0][name] for name in COMMON})
    else:
        row.update({"floor": 0.0, "left": math.fsum(entry["slid"] for entry in entries), "air": 0.0})
    for name in REMOVED:
        if any(name in entry for entry in entries):
            row[name] = math.fsum(entry.get(name, 0.0) for entry in entries)
    return row


def read_ledger(version):
    """The rows of the ledger in the folder `version`, one per frame; empty if there is none, or if it is damaged."""
    try:
        ledger = read_sealed(Path(version) / LEDGER, "Bake again", {"frames": [_ROW]})
    except CacheError:
        return []
    return [] if ledger is None else ledger["frames"]


def lost_text(rows):
    """Where the snow of a ledger is that no receiver shows, as a sentence; empty if there is none."""
    last = rows[-1] if rows else {"fallen": 0.0}
    if last["fallen"] <= 0.0:
        return ""
    parts = [
        f"{last[name] / last['fallen']:.0%} {text}"
        for name, text in LOST
        if last[name] >= LEAST * last["fallen"]
    ]
    return f"Of all snow, {' and '.join(parts)}" if parts else ""
