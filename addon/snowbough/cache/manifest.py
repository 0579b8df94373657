# SPDX-License-Identifier: GPL-3.0-or-later
"""A receiver's manifest, object.json, and the fingerprints of what it was baked from. No ``bpy``."""

import math
from pathlib import Path

import numpy as np

from .files import INPUTS, MANIFEST, REMOVED_MANIFEST, bake_files, digest, is_bake_file
from .sealed import FORMAT, dict_of, either, flag, nothing, number, read_sealed, text, whole, write_sealed

# What every manifest holds, of whatever format.
_FRAME = {"frame": whole, "depth": number}
_SHAPE = {
    "object": text,
    "label": text,
    "library": text,
    "complete": flag,
    "hash": text,
    "settings": {
        "shot": text,
        "snowfall": {
            "frame_start": whole,
            "frame_end": whole,
            "flutter": number,
            "pixel_size": number,
            "totals": [number],
        },
        "receiver": {"resolution": whole, "uv_map": text},
    },
    "frames": [_FRAME],
}
_SHAPES = {1: _SHAPE, 2: _SHAPE, 3: {**_SHAPE, "cache": text, "files": [text]}}

# Fingerprints of poses as scene.inputs has them: [[pose, {label: prints or None}], ...].
POSES = [(text, dict_of(either([text], nothing)))]
FRAMES = [_FRAME]


def read_manifest(folder, name=MANIFEST):
    """object.json of a receiver's folder as a dict, or None where it is not there yet.

    Keys: ``format``, ``object``, ``library``, ``complete`` (all frames of the shot are there), ``hash``
    (of settings), ``settings`` (dict: lengths in metres, angles in radians), ``frames`` (list of dicts with
    ``frame`` and its statistics), ``cache`` (the identity of the .blend's cache, empty where it was not saved),
    ``files`` (names of all files that belong to the bake). Earlier formats come as this one, without the last two.
    Raises CacheError for a damaged one.
    """
    remedy = f"Remove the folder {folder} by hand, then bake again"
    manifest = read_sealed(Path(folder) / name, remedy, _SHAPES.get)
    if manifest is None:
        return None
    if manifest["format"] == 1:
        manifest = _from_format_1(manifest)
    return {**manifest, "format": FORMAT}


def _from_format_1(manifest):
    """The manifest as format 2 has it. Angles were written as degrees of what Blender stores in single
    precision, so rounding to that gives the very number that is compared with."""
    settings = dict(manifest["settings"])
    flutter = float(np.float32(math.radians(settings["snowfall"]["flutter"])))
    settings["snowfall"] = {**settings["snowfall"], "flutter": flutter}
    settings["shot"] = digest(settings["snowfall"])
    return {**manifest, "settings": settings, "hash": digest(settings)}


def read_any_manifest(folder):
    """read_manifest, or that of a removal which was interrupted."""
    manifest = read_manifest(folder)
    return read_manifest(folder, REMOVED_MANIFEST) if manifest is None else manifest


def listing(manifest):
    """Names of the files that a manifest lists, a set, without those that no bake gives."""
    listed = manifest.get("files")
    if listed is None:  # of an earlier format
        shot = manifest["settings"]["snowfall"]
        listed = bake_files(shot["frame_start"], shot["frame_end"])
    return {name for name in listed if is_bake_file(name)}


def write_manifest(folder, manifest):
    write_sealed(Path(folder) / MANIFEST, manifest)


def write_inputs(folder, poses):
    """Fingerprints of all poses of a finished bake (scene.inputs), to tell later what has changed."""
    write_sealed(Path(folder) / INPUTS, {"poses": poses})


def read_inputs(folder):
    """What write_inputs wrote, or None. Raises CacheError for a damaged file."""
    shapes = {0: POSES, FORMAT: {"poses": POSES}}
    inputs = read_sealed(Path(folder) / INPUTS, "Free the bake, then bake again", shapes.get)
    return inputs["poses"] if isinstance(inputs, dict) else inputs


def describe_changes(before, after, prefix=""):
    """Differences between two dicts of settings as texts: ``end_depth: 0.1 -> 0.2``. Nested dicts are
    walked; long values are not printed."""
    changes = []
    for name in sorted(set(before) | set(after)):
        old, new = before.get(name), after.get(name)
        if old == new:
            continue
        label = f"{prefix}{name}"
        if isinstance(old, dict) and isinstance(new, dict):
            changes += describe_changes(old, new, f"{label}: ")
        elif old is None:
            changes.append(f"{label}: added")
        elif new is None:
            changes.append(f"{label}: removed")
        elif isinstance(old, list) or len(str(old)) + len(str(new)) > 80:
            changes.append(f"{label}: changed")
        else:
            changes.append(f"{label}: {old} -> {new}")
    return changes
