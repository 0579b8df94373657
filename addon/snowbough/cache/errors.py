# SPDX-License-Identifier: GPL-3.0-or-later
"""Errors of the cache. No ``bpy``."""

import errno
import os

# Error codes of the system -> what to do. Messages of the native module contain the system's text, too.
_REMEDIES = (
    ((errno.ENOSPC, errno.EDQUOT), "Finished frames are kept: free disk space, then resume"),
    (
        (errno.ENOENT, errno.ENOTDIR, errno.ESTALE),
        "The folder is gone: restore it and resume, or bake again",
    ),
    ((errno.EACCES, errno.EPERM, errno.EROFS), "Finished frames are kept: allow writing there, then resume"),
)


def remedy_for(error):
    """What to do about a file that could not be written, as a sentence."""
    for codes, remedy in _REMEDIES:
        if any(os.strerror(code) in str(error) for code in codes):
            return remedy
    return "Finished frames are kept: check the disk, then resume"


class CacheError(RuntimeError):
    """The cache cannot be read or written; the message says where, why and what to do."""


def failed(path, action, error):
    """The CacheError for an OSError. action: ``written``."""
    return CacheError(f"{path} could not be {action}: {error.strerror or error}. {remedy_for(error)}")


def with_remedy(error):
    """The message of an error while a file was written, with what to do."""
    return str(error) if isinstance(error, CacheError) else f"{error}. {remedy_for(error)}"


class CacheBusy(CacheError):
    """Another bake holds the lock."""


class LockLost(CacheError):
    """The lock of a running bake was removed or replaced; the bake stops writing."""


class CacheFinished(CacheError):
    """The receiver is finished in this version, which must not be written again."""


class NoCheckpoint(CacheError):
    """A bake should start in the middle of the shot, but the checkpoint before is missing."""


class InputsChanged(CacheError):
    """Settings or scene differ from those of the cached bake; the message says what changed."""
