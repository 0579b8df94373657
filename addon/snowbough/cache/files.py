# SPDX-License-Identifier: GPL-3.0-or-later
"""The names of a bake's files, and small files written whole or not at all. No ``bpy``."""

import contextlib
import hashlib
import json
import os
import re
from pathlib import Path

from .errors import CacheError

MANIFEST = "object.json"
LOCK = "lock"
EVER_COVERED = "ever_covered.exr"
INPUTS = "inputs.json"
TEMPORARY_SUFFIX = ".tmp"

VERSION_PATTERN = re.compile(r"v(\d{3,})$")
STATE_PATTERN = re.compile(r"state_(\d{4,})$")
FRAME_PATTERN = re.compile(r"(?:height|normal)_(\d{4,})\.exr$")


def frame_file(kind, frame):
    return f"{kind}_{frame:04d}.exr"


def state_file(frame):
    return f"state_{frame:04d}"


def write_bytes(path, data):
    """Writes all of data or nothing. Raises CacheError with path and reason."""
    temporary = Path(f"{path}{TEMPORARY_SUFFIX}")
    try:
        with open(temporary, "wb") as stream:
            stream.write(data)
            stream.flush()
            os.fsync(stream.fileno())
        os.replace(temporary, path)
    except OSError as error:
        with contextlib.suppress(OSError):
            temporary.unlink()
        raise CacheError(f"{path} could not be written: {error.strerror or error}") from error


def to_json(value):
    """The one spelling of value: equal values are equal bytes."""
    return json.dumps(value, sort_keys=True, indent=1, ensure_ascii=False).encode() + b"\n"


def write_report(path, report):
    """Writes what a command line reports as JSON, as write_bytes does."""
    write_bytes(path, json.dumps(report, indent=2).encode() + b"\n")


def digest(value):
    """16 bytes in hex of plain data (dicts, lists, numbers, texts)."""
    return hashlib.blake2b(to_json(value), digest_size=16).hexdigest()


def make_folder(path):
    """Makes a folder that can be written to. Raises CacheError with what to do."""
    try:
        Path(path).mkdir(parents=True, exist_ok=True)
        probe = Path(path) / f".probe-{os.getpid()}"
        probe.touch()
        probe.unlink()
    except OSError as error:
        raise CacheError(
            f"The cache folder {path} cannot be written: {error.strerror or error}. "
            "Choose another one in the Snowbough panel, or with --cache"
        ) from error


def read_json(path):
    """What a JSON file holds, or None where it is not there. Raises CacheError for one that cannot be read."""
    try:
        return json.loads(Path(path).read_bytes())
    except FileNotFoundError:
        return None
    except (OSError, ValueError) as error:
        raise CacheError(f"{path} cannot be read ({error}). Free the bake, then bake again") from error
