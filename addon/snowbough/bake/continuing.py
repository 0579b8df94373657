# SPDX-License-Identifier: GPL-3.0-or-later
"""Continue Bake: adds frames to a finished bake. No ``bpy``.

The longer shot gets a version of its own, so the finished one stays. It begins with copies of the finished maps up to
the last checkpoint; the frames after it are simulated again, and must get the bytes that they have. The settings of the
shot list the parts that it was baked in (plan), so resumed and split bakes plan the same steps.
"""

from dataclasses import dataclass, replace
from pathlib import Path

from ..cache import versions
from ..cache.errors import CacheError, InputsChanged, NoCheckpoint
from ..cache.files import file_digest, write_bytes
from ..cache.folder import checkpoints
from ..cache.journal import read_lines
from ..cache.manifest import describe_changes, read_inputs, read_manifest

# Settings that differ in the longer shot.
LONGER = {"frame_end", "end_depth", "parts"}


def parts_of(snowfall):
    """BakeRequest.parts of a manifest's settings ``snowfall``."""
    return tuple((last, depth) for last, depth in snowfall.get("parts", ()))


def is_longer(before, after):
    """Whether a bake with the settings `before` (dicts as BakeRequest.shot) can be continued to get `after`."""
    changed = {name for name in before.keys() | after.keys() if before.get(name) != after.get(name)}
    return (
        changed - {"shot", "totals"} <= LONGER
        and after["frame_end"] > before["frame_end"]
        and after["end_depth"] >= before["end_depth"]
    )


def parts_to_resume(root, keys):
    """BakeRequest.parts of the bake that a resumed one continues."""
    number, _ = versions.resumable_version(root, keys)
    if number is None:
        return ()
    for key in keys:
        manifest = _manifest(versions.version_folder(root, number) / key)
        if manifest is not None:
            return parts_of(manifest["settings"]["snowfall"])
    return ()


@dataclass
class Finished:
    """The finished bake that is continued."""

    version: Path
    manifests: dict
    """{key: manifest} of the receivers to bake."""
    _inputs: dict = None

    @property
    def snowfall(self):
        """Its settings of the shot."""
        return next(iter(self.manifests.values()))["settings"]["snowfall"]

    @property
    def last(self):
        return self.snowfall["frame_end"]

    @property
    def parts(self):
        """BakeRequest.parts of the longer shot."""
        return (*parts_of(self.snowfall), (self.last, self.snowfall["end_depth"]))

    def compare_settings(self, receivers, shot, units):
        """Raises InputsChanged, naming the differences, if other settings changed than those of a longer shot."""
        for receiver in receivers:
            before = self.manifests[receiver.key]["settings"]
            count = len(before["snowfall"]["totals"])
            longer = {name: shot[name] for name in LONGER & shot.keys()}
            started = {**before["snowfall"], **longer}
            started["totals"] = [*started["totals"], *shot["totals"][count:]]
            now = receiver.settings(shot)
            changes = describe_changes({**before, "snowfall": started}, now, units)
            if changes:
                raise InputsChanged(
                    f"{receiver.shown} in {self.version.name} was baked with other settings ({'; '.join(changes)}), so "
                    "its frames would change: bake again from the start, or set them back"
                )

    def checkpoint_frame(self, receivers, beside):
        """The frame of the last checkpoint of all receivers, None if there is none."""
        keys = [receiver.key for receiver in (*receivers, *beside)]
        common = set.intersection(*(set(checkpoints(self.version / key)) for key in keys))
        return max((frame for frame in common if frame <= self.last), default=None)

    def copies(self, receivers):
        """Copies of the BakedReceivers for reading in the finished bake."""
        return [replace(receiver, folder=self.version / receiver.key) for receiver in receivers]

    def inputs(self, receivers):
        """{label: recorded poses}, for resuming.compare_scenes."""
        if self._inputs is None:
            found = {receiver.shown: read_inputs(self.version / receiver.key) for receiver in receivers}
            self._inputs = {label: poses for label, poses in found.items() if poses is not None}
        return self._inputs

    def kept_frames(self, receiver, restore):
        """The KeptFrames of a BakedReceiver."""
        return KeptFrames(self.version / receiver.key, self.manifests[receiver.key]["frames"], restore)


def find_finished(root, receivers, frame_end):
    """The newest Finished bake of the BakedReceivers; None if the newest one has that last frame. Raises NoCheckpoint
    if there is none."""
    number, finished = versions.resumable_version(root, [receiver.key for receiver in receivers])
    if number is None:
        raise NoCheckpoint("There is no finished bake to continue: bake the shot first")
    folder = versions.version_folder(root, number)
    found = {receiver.key: _manifest(folder / receiver.key) for receiver in receivers}
    lasts = {own["settings"]["snowfall"]["frame_end"] for own in found.values() if own is not None}
    if frame_end in lasts:
        return None
    missing = [receiver.shown for receiver in receivers if receiver.key not in finished]
    if missing:
        raise NoCheckpoint(
            f"{', '.join(missing)} is not finished in {folder.name}: set the last frame back and resume that bake, "
            "then continue it, or bake again from the start"
        )
    return Finished(folder, found)


def find_parts(root, receivers, request):
    """(the BakeRequest with the parts of its shot, the Finished bake that it continues or None)."""
    parts, finished = (), None
    if request.extend:
        finished = find_finished(root, receivers, request.frame_end)
        if finished is None:  # a repeated command goes on with its own bake
            request = replace(request, extend=False, resume=True)
        else:
            parts = finished.parts
    if request.may_resume and not request.extend:
        parts = parts_to_resume(root, [receiver.key for receiver in receivers])
    return replace(request, parts=parts), finished


def _manifest(folder):
    """The manifest in a folder; if it is damaged, the first line of the journal; None if there is neither."""
    try:
        return read_manifest(folder)
    except CacheError:
        return read_lines(folder).header


def finished_before(version, receivers, parts):
    """The Finished bake that an unfinished one in the folder `version` continues; None if it was removed."""
    for number in reversed(versions.versions(version.parent)):
        folder = versions.version_folder(version.parent, number)
        if folder.name >= version.name:
            continue
        try:
            found = {receiver.key: read_manifest(folder / receiver.key) for receiver in receivers}
        except CacheError:
            continue
        earlier = Finished(folder, found)
        if all(found.values()) and earlier.parts == parts:
            return earlier
    return None


@dataclass
class KeptFrames:
    """The finished frames of a receiver whose maps must stay as they are."""

    folder: Path
    entries: list
    """Of its manifest."""
    restore: bool
    """Whether to copy finished maps over maps that came out otherwise, as after another driver."""

    def copy(self, last, target):
        """Copies the maps of the frames up to `last` into the folder `target`; returns [(entry, poses)] of their lines.
        Raises CacheError for a damaged map."""
        read = read_lines(self.folder, with_poses=True)
        lines = [line for line in zip(read.entries, read.packed_poses) if line[0]["frame"] <= last]
        for entry, _ in lines:
            for name, digest in entry.get("checksums", {}).items():
                self._copy(name, digest, target)
        return lines

    def keep(self, frame, target, checksums):
        """Compares maps that were written again in `target` with the finished ones. Returns the checksums of the files.
        Raises InputsChanged if they differ, unless they are to be restored."""
        entry = next((own for own in self.entries if own["frame"] == frame), None)
        if entry is None:
            return checksums
        finished = entry.get("checksums", {})
        if finished == checksums:
            return checksums
        if not self.restore:
            raise InputsChanged(
                f"Frame {frame} in {target.name} would change, so the bake was not continued: bake again from the start"
            )
        for name, digest in finished.items():
            self._copy(name, digest, target)
        return finished

    def _copy(self, name, digest, target):
        try:
            data = (self.folder / name).read_bytes()
        except OSError as error:
            raise CacheError(
                f"{self.folder / name} cannot be read ({error.strerror or error}): set the shot back and resume that "
                "bake, which repairs it"
            ) from error
        write_bytes(target / name, data)
        if file_digest(target / name) != digest:
            raise CacheError(
                f"{self.folder / name} is damaged: set the shot back and resume that bake, which repairs it"
            )
