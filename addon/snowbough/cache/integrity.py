# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds files of a bake that are missing or have changed on disk. No ``bpy``.

JSON files, the journal and checkpoints have checksums of their own. Those of all other files are dicts
``{name: digest}``: of a frame's maps in the frame's line of the journal, of the files that exist once in the finished
manifest, and of a snow surface in ``surface.json``.
"""

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from .errors import CacheError
from .files import FRAMES, SURFACE, SURFACE_FACES, SURFACE_POINTS, file_digest, is_regular
from .folder import checkpoints
from .journal import read_lines
from .manifest import is_whole, read_any_head
from .sealed import read_sealed
from .shapes import Maybe, checksums


def checksums_of(folder, names):
    """{name: digest} of the files that exist."""
    return {name: file_digest(Path(folder) / name) for name in names if (Path(folder) / name).is_file()}


def damaged(folder, digests):
    """The first name whose file is missing or does not match its digest, or None. An empty digest is not compared."""
    for name, digest in sorted(digests.items()):
        try:
            if not (Path(folder) / name).is_file() or digest and file_digest(Path(folder) / name) != digest:
                return name
        except OSError:
            return name
    return None


def replaced(folder):
    """Names of the files in a receiver's folder that have a checksum, but are not what the bake wrote. Raises
    CacheError."""
    folder, manifest = Path(folder), read_any_head(folder) or {}
    try:
        shape = {"checksums": Maybe(checksums(SURFACE_FACES, SURFACE_POINTS))}
        surface = read_sealed(folder / SURFACE, "", shape) or {}
    except CacheError:
        surface = {}
    known = {}
    for entry in (*read_lines(folder).entries, manifest, surface):
        known |= {name: digest for name, digest in entry.get("checksums", {}).items() if digest}
    there = sorted(name for name in known if is_regular(folder / name))
    with ThreadPoolExecutor() as pool:
        same = pool.map(lambda name: damaged(folder, {name: known[name]}) is None, there)
        return [name for name, is_same in zip(there, same) if not is_same]


def first_damage(folder, manifest):
    """(frame, name of the file) of the first damage in a receiver's folder, or None. To repair it, bake again from that
    frame on. manifest: from read_head."""
    shot = manifest["settings"]["snowfall"]
    lines, lost = read_lines(folder), None
    if not is_whole(manifest, lines) or any(
        frame >= (lines.next_frame or 0) for frame in checkpoints(folder)
    ):
        # Without its first line, no frame is known.
        lost = shot["frame_start"] if lines.header is None else min(lines.next_frame, shot["frame_end"])
    for entry in lines.entries:
        name = damaged(folder, entry.get("checksums", {}))
        if name is not None:
            return entry["frame"], name
    if lost is not None:
        return lost, FRAMES
    name = damaged(folder, manifest.get("checksums", {}))
    return None if name is None else (shot["frame_end"], name)
