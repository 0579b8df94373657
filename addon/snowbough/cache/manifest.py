# SPDX-License-Identifier: GPL-3.0-or-later
"""A receiver's manifest, object.json, and the fingerprints of its baked scene. No ``bpy``."""

from pathlib import Path

from ..base.map_kinds import ON_REQUEST
from ..base.names import with_unit
from .errors import CacheError
from .files import FRAMES, MANIFEST, REMOVED_MANIFEST, is_bake_file
from .journal import read_lines
from .sealed import read_sealed, write_sealed
from .shapes import MANIFEST as SHAPE


def read_head(folder, name=MANIFEST):
    """read_manifest without the frames, which takes the same time for any number of frames."""
    remedy = (
        "Resume the bake to restore it from a checkpoint. If there is none, bake again, which makes a new version, and "
        f"delete the folder {folder}"
    )
    manifest = read_sealed(Path(folder) / name, remedy, SHAPE)
    if manifest is None:
        return None
    return {**manifest, "settings": _with_later(manifest["settings"])}


def read_manifest(folder, name=MANIFEST):
    """object.json of a receiver's folder as a dict with the frames of the journal, or None if it does not exist.

    Keys: ``object``, ``library``, ``complete`` (all frames of the shot exist), ``hash`` (of settings), ``settings``
    (dict: lengths in metres, angles in radians), ``frames`` (list of dicts with ``frame`` and its statistics, and
    ``checksums`` of its maps), ``cache`` (identity of the .blend's cache, empty if the file was never saved), ``files``
    (names of all files of the bake), ``checksums`` (of files that exist once, in finished bakes), ``format``.
    Raises CacheError if it is damaged.
    """
    manifest = read_head(folder, name)
    if manifest is None:
        return None
    lines = read_lines(folder)
    if not is_whole(manifest, lines):
        raise _damaged(folder, lines)
    return {**manifest, "frames": lines.entries}


def _damaged(folder, lines):
    place = "" if lines.next_frame is None else f" from frame {lines.next_frame} on"
    return CacheError(
        f"{Path(folder) / FRAMES} is missing or damaged{place}. Resume the bake, which repairs it from a checkpoint"
    )


def is_whole(manifest, lines):
    """Whether the journal's Lines are all that a manifest needs: a finished one has their end. In an unfinished bake,
    lines may be missing at the end."""
    return not manifest["complete"] or (
        bool(lines.ends) and not lines.rest and lines.ends[-1].as_dict() == manifest.get("end")
    )


# Later settings of the simulation, with the values that bakes from before them have.
LATER = {
    **{"adhesion": 0.0, "rising": 0.0, "granular": False},
    **{"density": 100.0, "sun_share": 0.7, "unevenness": 0.25},
    **{"rain": 0.0, "soak": 0.002, "wet_spread": 0.05, "drying": 4.0, "drift": 0.0},
}


def _with_later(settings):
    """The settings with all later ones, and with the switches of all maps: a bake from before a kind of map did not
    write it."""
    switches = {kind.setting: False for kind in ON_REQUEST}
    return {**settings, "snowfall": {**switches, **LATER, **settings["snowfall"]}}


def read_any_head(folder):
    """read_head, or that of an interrupted removal."""
    manifest = read_head(folder)
    return read_head(folder, REMOVED_MANIFEST) if manifest is None else manifest


def listing(manifest):
    """A test whether a manifest lists a file's name. It never lists names that no bake writes."""
    listed = set(manifest["files"])
    return lambda name: name in listed and is_bake_file(name)


def write_manifest(folder, manifest):
    write_sealed(Path(folder) / MANIFEST, {name: manifest[name] for name in manifest if name != "frames"})


def read_inputs(folder):
    """The fingerprints of all poses of a finished bake (scene.inputs); None if it has none. Raises CacheError if they
    are damaged."""
    manifest = read_head(folder)
    if manifest is None:
        return None
    lines = read_lines(folder, with_poses=True)
    if not is_whole(manifest, lines):
        raise _damaged(folder, lines)
    return lines.poses


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
