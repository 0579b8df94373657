# SPDX-License-Identifier: GPL-3.0-or-later
"""``frames.tsv``: the frames of a receiver's bake, one sealed line each. Lines are appended, never changed. No ``bpy``.

A line is ``checksum <tab> entry <tab> poses <newline>``, both as JSON without spaces; JSON contains no raw tab. The
first line's entry describes the bake, as the manifest does, and each other one a frame. ``poses`` are the fingerprints
(scene.inputs) of the poses since the frame before. A checksum covers its line and the checksum before it, so the one of
a line stands for the whole file up to there: checkpoints and the finished manifest hold only this and a length.

A bake that is killed may leave an incomplete last line. Readers stop at the first line that does not match.
"""

import contextlib
import errno
import hashlib
import json
import os
import stat
from dataclasses import dataclass, field
from pathlib import Path

from .errors import CacheError, failed
from .files import FRAMES, open_regular, write_bytes
from .shapes import DESCRIPTION, FRAME, POSES, fits

# Longer than the first poses of thousands of objects.
MAX_LINE_BYTES = 1 << 28

_FLAGS = (
    os.O_WRONLY | getattr(os, "O_BINARY", 0) | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0)
)


def packed(value):
    """Canonical JSON in one line."""
    return json.dumps(value, sort_keys=True, separators=(",", ":"), ensure_ascii=False).encode()


def _checksum(before, body):
    return hashlib.blake2b(before + body, digest_size=16).hexdigest().encode()


def _line(before, entry, poses):
    body = b"%s\t%s\n" % (packed(entry), poses)
    seal = _checksum(before, body)
    return seal, b"%s\t%s" % (seal, body)


@dataclass(frozen=True)
class LineEnd:
    """The end of a line: the number of bytes up to it, and its checksum."""

    bytes: int
    checksum: str

    def as_dict(self):
        return {"bytes": self.bytes, "checksum": self.checksum}


@dataclass
class Lines:
    """The intact lines of a file."""

    header: dict = None
    """None if not even the first line is intact."""
    entries: list = field(default_factory=list)
    poses: list = field(default_factory=list)
    """Empty unless they were asked for."""
    packed_poses: list = field(default_factory=list)
    """Those of each frame as bytes, as in its line; empty unless poses were asked for."""
    ends: list = field(default_factory=list)
    """The LineEnd after each frame's line."""
    rest: int = 0
    """Bytes after the last intact line."""

    @property
    def next_frame(self):
        """The frame whose line is missing or damaged, or that was not baked yet."""
        return self.header["settings"]["snowfall"]["frame_start"] + len(self.entries) if self.header else None


def read_lines(folder, with_poses=False, until=None):
    """The Lines of a receiver's folder, up to the LineEnd `until`; empty if there is no file. Raises CacheError if the
    file cannot be read."""
    lines, seal, end = Lines(), b"", 0
    path = Path(folder) / FRAMES
    try:
        with open_regular(path) as stream:
            size = os.fstat(stream.fileno()).st_size
            while until is None or end < until.bytes:
                raw = stream.readline(MAX_LINE_BYTES)
                columns = raw.split(b"\t")
                if len(columns) != 3 or not raw.endswith(b"\n"):
                    break
                if _checksum(seal, raw[len(columns[0]) + 1 :]) != columns[0]:
                    break
                try:
                    entry = json.loads(columns[1])
                    poses = json.loads(columns[2]) if with_poses else []
                except (ValueError, RecursionError):
                    break
                is_header = lines.header is None
                if not fits(entry, DESCRIPTION if is_header else FRAME) or not fits(poses, POSES):
                    break
                if not is_header and entry["frame"] != lines.next_frame:
                    break
                seal, end = columns[0], end + len(raw)
                if is_header:
                    lines.header = entry
                    continue
                lines.entries.append(entry)
                lines.poses += poses
                if with_poses:
                    lines.packed_poses.append(columns[2].rstrip(b"\n"))
                lines.ends.append(LineEnd(end, seal.decode()))
            lines.rest = size - end
    except FileNotFoundError:
        pass
    except OSError as error:
        raise CacheError(
            f"{path} cannot be read ({error.strerror or error}). Free the bake, then bake again"
        ) from error
    return lines


class Journal:
    """Appends lines. The file is open only while it is written, since a scene may have thousands of receivers."""

    def __init__(self, folder, end):
        """Goes on after the LineEnd `end`."""
        self._path = Path(folder) / FRAMES
        self.end = end

    @classmethod
    def start(cls, folder, header):
        """Begins the file with a line of the description `header`."""
        seal, line = _line(b"", header, b"[]")
        write_bytes(Path(folder) / FRAMES, line)
        return cls(folder, LineEnd(len(line), seal.decode()))

    def append(self, entry, poses):
        """Adds a frame. poses: packed()."""
        seal, line = _line(self.end.checksum.encode(), entry, poses)
        with self._opened() as descriptor:
            self._cut(descriptor)  # what a failed attempt left
            os.lseek(descriptor, 0, os.SEEK_END)
            view = memoryview(line)
            while view:
                view = view[os.write(descriptor, view) :]
        self.end = LineEnd(self.end.bytes + len(line), seal.decode())

    def flush(self):
        """Waits until all lines are on the disk."""
        with self._opened() as descriptor:
            os.fsync(descriptor)

    def cut(self):
        """Removes the lines after the end."""
        with self._opened() as descriptor:
            self._cut(descriptor)
            os.fsync(descriptor)

    def _cut(self, descriptor):
        found = os.fstat(descriptor)
        if not stat.S_ISREG(found.st_mode) or found.st_size < self.end.bytes:
            raise OSError(errno.EINVAL, "it was replaced or cut during this bake")
        if found.st_size > self.end.bytes:
            os.ftruncate(descriptor, self.end.bytes)

    @contextlib.contextmanager
    def _opened(self):
        try:
            descriptor = os.open(self._path, _FLAGS)
            try:
                yield descriptor
            finally:
                os.close(descriptor)
        except OSError as error:
            raise failed(self._path, "written", error) from error
