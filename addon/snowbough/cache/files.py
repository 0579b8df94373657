# SPDX-License-Identifier: GPL-3.0-or-later
"""Names of a bake's files, and writing of small files as a whole or not at all. No ``bpy``."""

import contextlib
import errno
import hashlib
import io
import json
import os
import re
import stat
import tempfile
import uuid
from pathlib import Path

from ..base.map_kinds import BY_NAME, MAP_KINDS
from .errors import CacheError, failed

MANIFEST = "object.json"
LOCK = "lock"
EVER_COVERED = "ever_covered.exr"
FRAMES = "frames.tsv"
OWNER = "owner.json"
LEDGER = "ledger.json"
RECEIVER = "receiver.ply"
POSITIONS = "positions.pc2"
SURFACE_FACES = "surface.ply"
SURFACE_POINTS = "surface.pc2"
SURFACE = "surface.json"
LOGS = "logs"
TEMPORARY_SUFFIX = ".tmp"
PROBE = ".probe-"

# Files of a bake in a receiver's folder: those that exist once, and those of each frame, with the number of the frame.
# The manifest lists them (bake_files); files that it does not list are never removed.
ONCE = (
    MANIFEST, FRAMES, EVER_COVERED, RECEIVER, POSITIONS, SURFACE_FACES, SURFACE_POINTS, SURFACE,
)  # fmt: skip
EACH_FRAME = (
    *(f"{kind.name}_{{:04d}}.{kind.ending}" for kind in MAP_KINDS),
    "state_{:04d}",
    "state_{:04d}.json",
)

# Name of a manifest while its files are being removed; the folder is not a bake any more.
REMOVED_MANIFEST = f"{MANIFEST}.removed"

# Folder in which Cycles stores its copies of images, beside the images (Blender 5.2).
TEXTURE_CACHE = "blender_tx"

LOCK_PATTERN = re.compile(r"lock-[0-9a-f]{8}$")
VERSION_PATTERN = re.compile(r"v(\d{3,})$")
STATE_PATTERN = re.compile(r"state_(\d{4,7})$")
_KINDS = "|".join(BY_NAME)
FRAME_PATTERN = re.compile(rf"(?:{_KINDS})_(\d{{4,7}})\.(?:exr|ply)$")
LOG_PATTERN = re.compile(r"\d{8}T\d{6}-[A-Za-z0-9._-]+-\d+\.log$")
# Temporary names, as made by write_bytes and by the native module.
_TEMPORARY = re.compile(r"(.+?)(?:\.\d+\.\d+|\.[0-9a-f]{8})?\.tmp$")
_TEXTURE = re.compile(rf"((?:{_KINDS})_\d{{4,7}}|ever_covered)(?![A-Za-z0-9]).*\.tx$")


def frame_file(kind, frame):
    return f"{kind}_{frame:04d}.{BY_NAME[kind].ending}"


def state_file(frame):
    return f"state_{frame:04d}"


def bake_files(first, last):
    """Sorted names of all files that a bake of frames first to last may leave in a receiver's folder."""
    frames = range(first, last + 1)
    return sorted([*ONCE, *(name.format(frame) for name in EACH_FRAME for frame in frames)])


def is_bake_file(name):
    """Whether bake_files could give the name."""
    number = number_in(name, None)
    return (
        name in ONCE or number is not None and any(name == pattern.format(number) for pattern in EACH_FRAME)
    )


def number_in(name, otherwise):
    """The frame in the name of a file of each frame, else `otherwise`."""
    number = re.search(r"_(\d{4,7})(?!\d)", name)
    return int(number.group(1)) if number else otherwise


def finished_name(name):
    """The final name of a temporary file; any other name is returned as it is."""
    match = _TEMPORARY.fullmatch(name)
    return match.group(1) if match else name


def texture_source(name):
    """The image from which Cycles made a file in its folder, or None."""
    match = _TEXTURE.fullmatch(name)
    return f"{match.group(1)}.exr" if match else None


def is_regular(path):
    """Whether the path is a file and not a link to one."""
    try:
        return stat.S_ISREG(os.lstat(path).st_mode)
    except OSError:
        return False


def open_regular(path):
    """Opens a file for reading, as bytes. A pipe or a device with its name is an OSError and does not wait."""
    descriptor = os.open(path, os.O_RDONLY | getattr(os, "O_BINARY", 0) | getattr(os, "O_NONBLOCK", 0))
    if not stat.S_ISREG(os.fstat(descriptor).st_mode):
        os.close(descriptor)
        raise OSError(errno.EINVAL, "it is not a file", str(path))
    return os.fdopen(descriptor, "rb")


def folders_in(path):
    """Sorted names of the folders in a folder, without links; empty if the folder does not exist."""
    try:
        with os.scandir(path) as entries:
            return sorted(entry.name for entry in entries if entry.is_dir(follow_symlinks=False))
    except OSError:
        return []


def replace(temporary, path):
    """Renames a finished temporary file. A device or a pipe, also behind a link, is an OSError and stays."""
    with contextlib.suppress(FileNotFoundError):
        mode = os.stat(path).st_mode
        if not stat.S_ISREG(mode) and not stat.S_ISDIR(mode):  # the system refuses folders itself
            raise OSError(errno.EINVAL, "a device or a pipe has this name", str(path))
    os.replace(temporary, path)


def remove_half_written(path):
    """Removes what killed writes of a file have left. Another bake that is writing it now writes it once more."""
    path = Path(path)
    half_written = re.compile(re.escape(path.name) + r"\.[0-9a-f]{8}" + re.escape(TEMPORARY_SUFFIX))
    with contextlib.suppress(OSError):
        for beside in path.parent.iterdir():
            if half_written.fullmatch(beside.name) and is_regular(beside):
                beside.unlink()


def write_bytes(path, data):
    """Writes data completely or not at all. Raises CacheError with path and reason."""
    temporary = Path(f"{path}.{uuid.uuid4().hex[:8]}{TEMPORARY_SUFFIX}")

    def write():
        with open(temporary, "wb") as stream:
            stream.write(data)
            stream.flush()
            os.fsync(stream.fileno())
        replace(temporary, path)

    try:
        try:
            write()
        except FileNotFoundError:  # see remove_half_written
            write()
    except OSError as error:
        with contextlib.suppress(OSError):
            temporary.unlink()
        raise failed(path, "written", error) from error


def to_json(value):
    """Canonical JSON: equal values give equal bytes."""
    data = io.BytesIO()
    # Piece by piece: json.dumps keeps a list of all pieces, many times the size of the text.
    with io.TextIOWrapper(data, encoding="utf-8", newline="\n") as stream:
        json.dump(value, stream, sort_keys=True, indent=1, ensure_ascii=False)
        stream.write("\n")
        stream.flush()
        return data.getvalue()


def write_report(path, report):
    """Writes the report of a command line as JSON, with write_bytes."""
    write_bytes(path, json.dumps(report, indent=2).encode() + b"\n")


def digest(value):
    """A digest of plain data (dicts, lists, numbers, texts): 16 bytes in hex."""
    return hashlib.blake2b(to_json(value), digest_size=16).hexdigest()


def file_digest(path):
    """A digest of a file's content: 16 bytes in hex."""
    hasher = hashlib.blake2b(digest_size=16)
    with open(path, "rb") as stream:
        while block := stream.read(1 << 16):
            hasher.update(block)
    return hasher.hexdigest()


def make_folder(path):
    """Makes a folder and checks that it can be written. Raises CacheError with what to do."""
    try:
        Path(path).mkdir(parents=True, exist_ok=True)
        # On Linux it has no name, so a kill leaves nothing.
        with tempfile.TemporaryFile(prefix=PROBE, dir=path):
            pass
    except OSError as error:
        raise CacheError(
            f"The cache folder {path} cannot be written: {error.strerror or error}. "
            "Choose another one in the Snowbough panel, or with --cache"
        ) from error
