# SPDX-License-Identifier: GPL-3.0-or-later
"""A receiver's manifest, object.json, and the fingerprints of its baked scene. No ``bpy``."""

import math
from pathlib import Path

import numpy as np

from ..base.map_kinds import ON_REQUEST
from ..base.names import with_unit
from .files import INPUTS, MANIFEST, REMOVED_MANIFEST, bake_files, digest, is_bake_file
from .sealed import FORMAT, dict_of, either, flag, nothing, number, read_sealed, text, whole, write_sealed

# Required content of manifests of all formats.
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
    """object.json of a receiver's folder as a dict, or None if it does not exist.

    Keys: ``format``, ``object``, ``library``, ``complete`` (all frames of the shot exist), ``hash`` (of settings),
    ``settings`` (dict: lengths in metres, angles in radians), ``frames`` (list of dicts with ``frame`` and its
    statistics, and ``checksums`` of its maps), ``cache`` (identity of the .blend's cache, empty if the file was never
    saved), ``files`` (names of all files of the bake), ``checksums`` (of files that exist once, in finished bakes).
    Earlier formats are converted, but lack the last three. Raises CacheError if it is damaged.
    """
    remedy = (
        "Resume the bake to restore it from a checkpoint. If there is none, bake again, which makes a new version, and "
        f"delete the folder {folder}"
    )
    manifest = read_sealed(Path(folder) / name, remedy, _SHAPES.get)
    if manifest is None:
        return None
    if manifest["format"] == 1:
        manifest = _from_format_1(manifest)
    return {**manifest, "settings": _with_switches(manifest["settings"]), "format": FORMAT}


def _with_switches(settings):
    """The settings with the switches of all maps. A bake from before a kind of map did not write it."""
    switches = {kind.setting: False for kind in ON_REQUEST}
    return {**settings, "snowfall": {**switches, **settings["snowfall"]}}


def _from_format_1(manifest):
    """Converts a manifest to format 2. Format 1 had angles in degrees, computed from Blender's single precision, so
    rounding to single precision restores the exact number."""
    settings = dict(manifest["settings"])
    flutter = float(np.float32(math.radians(settings["snowfall"]["flutter"])))
    settings["snowfall"] = {**settings["snowfall"], "flutter": flutter}
    settings["shot"] = digest(settings["snowfall"])
    return {**manifest, "settings": settings, "hash": digest(settings)}


def read_any_manifest(folder):
    """read_manifest, or the manifest of an interrupted removal."""
    manifest = read_manifest(folder)
    return read_manifest(folder, REMOVED_MANIFEST) if manifest is None else manifest


def listing(manifest):
    """The set of file names that a manifest lists, without names that no bake writes."""
    listed = manifest.get("files")
    if listed is None:  # an earlier format
        shot = manifest["settings"]["snowfall"]
        listed = bake_files(shot["frame_start"], shot["frame_end"])
    return {name for name in listed if is_bake_file(name)}


def write_manifest(folder, manifest):
    write_sealed(Path(folder) / MANIFEST, manifest)


def write_inputs(folder, poses):
    """Writes the fingerprints of all poses of a finished bake (scene.inputs), to find changes later."""
    write_sealed(Path(folder) / INPUTS, {"poses": poses})


def read_inputs(folder):
    """Reads the file of write_inputs; None if it does not exist. Raises CacheError if it is damaged."""
    shapes = {0: POSES, FORMAT: {"poses": POSES}}
    inputs = read_sealed(Path(folder) / INPUTS, "Free the bake, then bake again", shapes.get)
    return inputs["poses"] if isinstance(inputs, dict) else inputs


def describe_changes(before, after, units):
    """Differences between two dicts of settings as texts: ``end depth: 0.1 m, now 0.2 m``. Nested dicts are compared
    entry by entry. units: {name: unit}."""
    changes = []
    for name in sorted((before.keys() | after.keys()) - {"shot", "totals"}):
        old, new = before.get(name), after.get(name)
        if isinstance(old, dict) and isinstance(new, dict):
            changes += describe_changes(old, new, units)
        elif old != new:
            unit = units.get(name, "")
            changes.append(f"{name.replace('_', ' ')}: {with_unit(old, unit)}, now {with_unit(new, unit)}")
    # The depth of each frame follows from other settings, unless the rate is animated.
    if not changes and before.get("totals") != after.get("totals"):
        changes.append("rate: its animation changed")
    return changes
