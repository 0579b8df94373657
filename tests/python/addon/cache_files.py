# SPDX-License-Identifier: GPL-3.0-or-later
"""Caches for tests, without a bake."""

from snowbough.cache import files, journal, manifest, shapes


def written(shot="s", frames=(1, 2), complete=True, cache="", **snowfall):
    """The manifest of a bake of the frames first to last."""
    snowfall = {
        "frame_start": frames[0],
        "frame_end": frames[-1],
        "flutter": 0.0,
        "pixel_size": 0.01,
        **snowfall,
    }
    return {
        "object": "Rock",
        "label": "Rock",
        "library": "",
        "complete": complete,
        "hash": "h",
        "settings": {
            "shot": shot,
            "snowfall": {"totals": [0.1] * (frames[-1] - frames[0] + 1), **snowfall},
            "receiver": {"resolution": 64, "uv_map": "snow"},
        },
        "cache": cache,
        "files": files.bake_files(frames[0], frames[-1]),
    }


def write_bake(path, bake, entries, poses=()):
    """A finished bake: its manifest, as from written(), and the journal of its frames. poses: of the first frame."""
    shot = {name: bake[name] for name in shapes.DESCRIPTION if name in bake}
    own = journal.Journal.start(path, shot)
    for number, entry in enumerate(entries):
        own.append(entry, journal.packed([] if number else list(poses)))
    manifest.write_manifest(path, {**bake, "end": own.end.as_dict()})


def write_manifest(path, **given):
    path.mkdir(parents=True, exist_ok=True)
    manifest.write_manifest(path, written(**given))
