# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds files of a bake that are missing or have changed on disk. No ``bpy``.

JSON files and checkpoints have checksums of their own. Those of all other files are dicts ``{name: digest}``: of a
frame's maps in the frame's entry of the manifest, of the files that exist once in the finished manifest, and of a snow
surface in ``surface.json``.
"""

from pathlib import Path

from .files import file_digest, frame_file


def checksums_of(folder, names):
    """{name: digest} of the files that exist."""
    return {name: file_digest(Path(folder) / name) for name in names if (Path(folder) / name).is_file()}


def damaged(folder, checksums):
    """The first name whose file is missing or does not match its digest, or None. An empty digest is not compared."""
    for name, digest in sorted(checksums.items()):
        try:
            if not (Path(folder) / name).is_file() or digest and file_digest(Path(folder) / name) != digest:
                return name
        except OSError:
            return name
    return None


def first_damage(folder, manifest):
    """(frame, name of the file) of the first damage in a receiver's folder, or None. To repair it, bake again from that
    frame on."""
    for entry in manifest["frames"]:
        frame = entry["frame"]
        # Bakes of earlier versions have no checksums.
        name = damaged(folder, entry.get("checksums") or {frame_file("height", frame): ""})
        if name is not None:
            return frame, name
    name = damaged(folder, manifest.get("checksums", {}))
    return None if name is None else (manifest["settings"]["snowfall"]["frame_end"], name)
