# SPDX-License-Identifier: GPL-3.0-or-later
"""Converts a receiver's folder of an earlier format, once, to the current one, whose files are all sealed. No ``bpy``.

Formats 1 to 3 kept the frames in the manifest, the fingerprints in ``inputs.json``, and both again in each checkpoint;
formats 1 and 2 had no checksums. The manifest is written last, so that an interrupted conversion starts again.
"""

import contextlib
import math
from pathlib import Path

from ..base.map_kinds import MAP_KINDS
from .errors import CacheError
from .files import EVER_COVERED, FRAMES, INPUTS, POSITIONS, RECEIVER, bake_files, frame_file
from .folder import checkpoints, read_sidecar, remove_checkpoint, write_sidecar
from .integrity import checksums_of
from .journal import Journal, packed, read_lines
from .manifest import LAST_WITH_FRAMES, read_head, read_old_inputs, write_manifest
from .shapes import DESCRIPTION


def is_of_before(folder):
    """Whether a folder has a bake of an earlier format; a damaged manifest does not tell."""
    try:
        head = read_head(folder)
    except CacheError:
        return False
    return head is not None and head["format"] <= LAST_WITH_FRAMES


def migrate(folder):
    """Converts a folder for which is_of_before() holds, and which is locked. Raises CacheError."""
    folder = Path(folder)
    head = read_head(folder)
    sidecars = _sidecars(folder)
    old = {frame: sidecar for frame, sidecar in sidecars.items() if "frames" in sidecar}
    if sidecars and not old:  # all but the manifest was converted
        end = read_lines(folder).ends[-1:]
    else:
        end = _convert(folder, head, old)
    shot = head["settings"]["snowfall"]
    manifest = _description(head)
    manifest["files"] = sorted({*bake_files(shot["frame_start"], shot["frame_end"]), *head.get("files", ())})
    manifest["complete"] = head["complete"] and bool(end)
    if manifest["complete"]:
        manifest["end"] = end[0].as_dict()
        manifest["checksums"] = head.get("checksums") or checksums_of(
            folder, (EVER_COVERED, RECEIVER, POSITIONS)
        )
    write_manifest(folder, manifest)
    with contextlib.suppress(OSError):
        (folder / INPUTS).unlink(missing_ok=True)


def _sidecars(folder):
    """{frame: sidecar} of the intact ones, ascending."""
    found = {}
    for frame in checkpoints(folder):
        with contextlib.suppress(CacheError):
            found[frame] = read_sidecar(folder, frame)
    return found


def _convert(folder, head, old):
    """Writes the journal and the checkpoints; returns the end of the journal, [Place] or []."""
    newest = old[max(old)] if old else None
    if head["complete"] or newest is None:
        frames, poses = head["frames"], read_old_inputs(folder) or []
    else:
        frames, poses = newest["frames"], newest["inputs"]
    first = head["settings"]["snowfall"]["frame_start"]
    of_frame = _by_frame(folder, poses, first)
    journal, places = Journal.start(folder, _description(head)), {}
    for entry in frames:
        number = entry["frame"]
        names = [frame_file(kind.name, number) for kind in MAP_KINDS]
        # Bakes of earlier versions have no checksums; a missing map stays missing.
        known = entry.get("checksums") or {names[0]: "", **checksums_of(folder, names)}
        journal.append({**entry, "checksums": known}, packed(of_frame.get(number, [])))
        places[number] = journal.end
    journal.flush()
    for frame in sorted(set(checkpoints(folder)) | set(old)):
        sidecar = old.get(frame)
        if sidecar is None or frame not in places or sidecar["frames"] != frames[: frame - first + 1]:
            remove_checkpoint(folder, frame)
            continue
        known = {
            "covered": sidecar["covered"],
            "driver": sidecar["driver"],
            "beside": sidecar.get("beside", []),
        }
        write_sidecar(folder, frame, {**known, "end": places[frame].as_dict()})
    return [journal.end] if frames else []


def _description(head):
    return {"cache": "", **{name: head[name] for name in DESCRIPTION if name in head}}


def _by_frame(folder, poses, first):
    """{frame: its poses}: those after the frame before. The first frame has all until then."""
    found = {}
    for pose in poses:
        try:
            number = max(first, math.ceil(float(pose[0])))
        except (ValueError, OverflowError) as error:
            raise CacheError(
                f"{folder / FRAMES}: '{pose[0]}' is not a frame. Free the bake, then bake again"
            ) from error
        found.setdefault(number, []).append(pose)
    return found
