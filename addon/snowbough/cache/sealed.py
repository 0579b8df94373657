# SPDX-License-Identifier: GPL-3.0-or-later
"""JSON files of the cache with a checksum: a file that has changed on disk is refused. No ``bpy``.

The last entry, ``checksum``, covers all bytes before it. The content is also compared with a shape.
"""

import hashlib
import json
import os
import re
from pathlib import Path

from .errors import CacheError
from .files import open_regular, to_json, write_bytes
from .shapes import fits, whole

# Formats 1 to 3 are of development versions, which no release could write.
FORMAT = 4

# Larger than the poses of a long shot with thousands of objects.
MAX_BYTES = 1 << 29

_SEAL = re.compile(rb',\n "checksum": "([0-9a-f]{32})"\n\}\n\Z')
_END = b"\n}\n"


def _checksum(body):
    return hashlib.blake2b(body, digest_size=16).hexdigest().encode()


def write_sealed(path, value):
    """Writes a dict with its format and its checksum. Raises CacheError."""
    body = to_json({**value, "format": FORMAT})
    write_bytes(path, body[: -len(_END)] + b',\n "checksum": "' + _checksum(body) + b'"\n}\n')


def read_sealed(path, remedy, shape):
    """Reads a file of write_sealed with a shape; None if it does not exist. remedy: what to do with a damaged file.
    Raises CacheError for damaged files and other formats."""
    path = Path(path)
    try:
        with open_regular(path) as stream:
            if os.fstat(stream.fileno()).st_size > MAX_BYTES:
                raise ValueError(f"it is larger than {MAX_BYTES >> 20} MiB")
            raw = stream.read()
        seal = _SEAL.search(raw[-80:])
        if seal and seal.group(1) != _checksum(raw[: -len(seal.group(0))] + _END):
            raise ValueError("its checksum does not match its content")
        value = json.loads(raw, parse_constant=_refuse)
        if not isinstance(value, dict) or not whole(value.get("format")):
            raise ValueError("it has no format")
        is_known = value["format"] == FORMAT
        if is_known and not seal:
            raise ValueError("its checksum is missing")
        if is_known and not fits(value, shape):
            raise ValueError("an entry is missing or has the wrong type")
    except (FileNotFoundError, NotADirectoryError):
        return None
    except (OSError, ValueError, RecursionError) as error:
        raise CacheError(f"{path} is damaged ({_reason(error)}). {remedy}") from error
    if not is_known:
        raise CacheError(
            f"{path} was written by another version of Snowbough (format {value['format']}, this one writes "
            f"{FORMAT}). {remedy}"
        )
    value.pop("checksum")
    return value


def _refuse(constant):
    raise ValueError(f"{constant} is not a number")


def _reason(error):
    if isinstance(error, OSError):
        return error.strerror or str(error)
    if isinstance(error, (json.JSONDecodeError, UnicodeDecodeError, RecursionError)):
        return "it is not JSON"
    return str(error)
