# SPDX-License-Identifier: GPL-3.0-or-later
"""A receiver's manifest, object.json, and the fingerprints of what it was baked from. No ``bpy``."""

import math
from pathlib import Path

import numpy as np

from .errors import CacheError
from .files import (
    INPUTS,
    MANIFEST,
    REMOVED_MANIFEST,
    bake_files,
    digest,
    is_bake_file,
    read_json,
    to_json,
    write_bytes,
)

# 1: flutter in degrees. 2: all angles in radians.
FORMAT = 2


def read_manifest(folder, name=MANIFEST):
    """object.json of a receiver's folder as a dict, or None where it is not there yet.

    Keys: ``format``, ``object``, ``library``, ``complete`` (all frames of the shot are there), ``hash``
    (of settings), ``settings`` (dict: lengths in metres, angles in radians), ``frames`` (list of dicts with
    ``frame`` and its statistics), ``cache`` (the identity of the .blend's cache, empty where it was not saved),
    ``files`` (names of all files that belong to the bake). Earlier formats come as this one, without the last two.
    """
    manifest = read_json(Path(folder) / name)
    if manifest is not None and manifest.get("format") == 1:
        manifest = _from_format_1(manifest)
    if manifest is not None and manifest.get("format") != FORMAT:
        raise CacheError(
            f"{folder} was written by another version of Snowbough (format {manifest.get('format')}, "
            f"this one writes {FORMAT}). Free the bake, then bake again"
        )
    return manifest


def _from_format_1(manifest):
    """The manifest as format 2 has it. Angles were written as degrees of what Blender stores in single
    precision, so rounding to that gives the very number that is compared with."""
    settings = dict(manifest["settings"])
    if "snowfall" in settings:
        flutter = float(np.float32(math.radians(settings["snowfall"]["flutter"])))
        settings["snowfall"] = {**settings["snowfall"], "flutter": flutter}
        settings["shot"] = digest(settings["snowfall"])
    return {**manifest, "format": FORMAT, "settings": settings, "hash": digest(settings)}


def read_any_manifest(folder):
    """read_manifest, or that of a removal which was interrupted."""
    manifest = read_manifest(folder)
    return read_manifest(folder, REMOVED_MANIFEST) if manifest is None else manifest


def listing(manifest):
    """Names of the files that a manifest lists, a set, without those that no bake gives."""
    shot = manifest["settings"].get("snowfall", {})
    listed = manifest.get("files")
    if listed is None and "frame_start" in shot:  # of an earlier format
        listed = bake_files(shot["frame_start"], shot["frame_end"])
    return {name for name in listed or (MANIFEST,) if is_bake_file(name)}


def write_manifest(folder, manifest):
    write_bytes(Path(folder) / MANIFEST, to_json({"format": FORMAT, **manifest}))


def write_inputs(folder, poses):
    """Fingerprints of all poses of a finished bake (scene.inputs), to tell later what has changed."""
    write_bytes(Path(folder) / INPUTS, to_json(poses))


def read_inputs(folder):
    """What write_inputs wrote, or None."""
    return read_json(Path(folder) / INPUTS)


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
